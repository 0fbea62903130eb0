// Approximate rays where none of the first samples meets matter: factors vary slowly there, and rays are
// walked for every second row of every second slice alone; the others are interpolated.
#pragma once

#include "volume/buffer.hpp"
#include "volume/local.hpp"
#include "volume/stencil.hpp"

namespace dfield::runtime::volume {

// Groups of 1 x 2 x 2 blocks.
constexpr std::size_t kGroupY = 2 * kBlockY, kGroupZ = 2 * kBlockZ;
static_assert(kTileY == kGroupY && kTileZ % kGroupZ == 0, "groups lie in one tile");

// Calls use(blocks, x, y, z) for the groups of a tile that lie wholly in the grid, with a row and a slice
// after them: their blocks in the tile, and their lowest voxel.
template<class Use>
void for_groups(const Grid& grid, const Tile& tile, const Use& use) {
    if (tile.y + kGroupY >= grid.ny) return;
    for (std::size_t bz = 0; bz < kTileBlocksZ; bz += 2)
        for (std::size_t bx = 0; bx < kTileBlocksX; ++bx) {
            const std::size_t x = tile.x + bx * kBlockX, z = tile.z + bz * kBlockZ;
            if (x >= grid.nx || z + kGroupZ >= grid.nz) continue;
            std::uint32_t blocks = 0;
            for (const std::size_t y : {0, 1})
                for (const std::size_t above : {0, 1}) blocks |= 1u << block_bit(bx, y, bz + above);
            use(blocks, x, tile.y, z);
        }
}

class Air {
  public:
    Air(dfield_context* context, const LocalRays& rays, const OpacityVolume& volume);

    // The blocks of a tile's groups in the air.
    std::uint32_t blocks(std::size_t tile) const { return blocks_[tile]; }
    // All factors of all groups, from those of every second row and slice.
    void interpolate(dfield_context* context, float* visibility) const;

  private:
    template<class Use>
    void for_air(dfield_context* context, const Use& use) const;

    const Grid grid_;
    std::pmr::vector<std::uint32_t> blocks_;  // of each tile
};

}  // namespace dfield::runtime::volume
