// Local ambient occlusion as a job: equations 2 and 3 of the paper for blocks of voxels.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "volume/local_rays.hpp"
#include "volume/opacity.hpp"
#include "volume/opacity_box.hpp"

namespace dfield::runtime::volume {

// Less light than this is none. Looked for after every kCheck samples of a ray, voxel by voxel, so that no
// result depends on which voxels are computed together; A lacks less than this for it.
constexpr float kOpaque = 1e-5f;
constexpr std::size_t kCheck = 8;
// The same for approximate rays, whose next sample takes what is left.
constexpr float kNearlyOpaque = 2e-2f;
constexpr std::size_t kNearlyCheck = 4;

// The rays with a volume's strides worked into them.
struct LocalPlan {
    struct Step {
        std::ptrdiff_t offset;  // floats, to the lowest of the eight voxels around the sample
        std::ptrdiff_t window;  // to the window of a block's samples
        float fraction[3];
        float weight, slope;  // in quanta
    };
    LocalPlan(std::pmr::memory_resource* memory, const LocalRays& rays, const OpacityVolume& volume);

    const LocalRays* rays;                  // the caller's
    std::pmr::vector<Step> steps;           // per_ray of each
    std::pmr::vector<std::uint8_t> inside;  // a ray: bit 0..2: some of its fractions along x, y, z are not 0
    // The windows that a ray's steps look into, each once, with the first step that does: those of ray k end
    // at run_ends[k].
    struct Run {
        std::ptrdiff_t window;
        std::uint32_t first;
    };
    std::pmr::vector<Run> runs;
    std::pmr::vector<std::size_t> run_ends;
    // With `whole`, what each ray lost is rounded to quanta, of which 2^23 to 2^24 are open: floats add them
    // up exactly, in any order, and take them away again. A is then wrong by half a quantum a ray at most.
    bool whole;
    float open = 0, quantum = 1;
};
// More rays are not rounded, which would cost too much of the accuracy, and so not exchanged.
constexpr std::size_t kMostExchanged = 256;

// 4 x 2 x 4 blocks, whose rays are walked together, direction by direction, while what they read is in the
// cache.
constexpr std::size_t kTileBlocksX = 4, kTileBlocksY = 2, kTileBlocksZ = 4;
constexpr std::size_t kTileX = kTileBlocksX * kBlockX, kTileY = kTileBlocksY * kBlockY,
                      kTileZ = kTileBlocksZ * kBlockZ;
struct Tile {
    std::uint32_t x, y, z;  // its lowest voxel
    std::uint32_t blocks;   // which are wanted: bit bx + 4 (by + 2 bz)
};
inline std::array<std::size_t, 3> tiles_of(const Grid& grid) {
    return {(grid.nx + kTileX - 1) / kTileX, (grid.ny + kTileY - 1) / kTileY,
            (grid.nz + kTileZ - 1) / kTileZ};
}
inline std::size_t tile_count(const Grid& grid) {
    const auto [nx, ny, nz] = tiles_of(grid);
    return nx * ny * nz;
}
// All of it.
inline Tile tile_at(const Grid& grid, std::size_t index) {
    const auto [nx, ny, nz] = tiles_of(grid);
    return {static_cast<std::uint32_t>(index % nx * kTileX),
            static_cast<std::uint32_t>(index / nx % ny * kTileY),
            static_cast<std::uint32_t>(index / (nx * ny) * kTileZ), ~0u};
}
constexpr std::size_t block_bit(std::size_t bx, std::size_t by, std::size_t bz) {
    return bx + kTileBlocksX * (by + kTileBlocksY * bz);
}

struct LocalJob {
    const OpacityVolume* opacity = nullptr;
    const LocalPlan* plan = nullptr;
    float* visibility = nullptr;  // out, packed on the volume's grid
};

// Calls use(bit, x, y, z) for a tile's wanted blocks that lie in the grid: their lowest voxels.
template<class Use>
void for_blocks(const Grid& grid, const Tile& tile, const Use& use) {
    for (std::size_t bz = 0; bz < kTileBlocksZ; ++bz)
        for (std::size_t by = 0; by < kTileBlocksY; ++by)
            for (std::size_t bx = 0; bx < kTileBlocksX; ++bx) {
                const std::size_t x = tile.x + bx * kBlockX, y = tile.y + by * kBlockY,
                                  z = tile.z + bz * kBlockZ, bit = block_bit(bx, by, bz);
                if ((tile.blocks >> bit & 1) && x < grid.nx && y < grid.ny && z < grid.nz) use(bit, x, y, z);
            }
}

// A at the voxels of a tile's blocks. Any threads.
using LocalFunction = void(const LocalJob& job, const Tile& tile);
// Levels with fused multiplication and addition agree to the last bit, SSE4 with them within kLocalError.
LocalFunction* local_function(std::int64_t targets);
LocalFunction* local_approximate_function(std::int64_t targets);
// The same for every second row of every second slice of groups (local_air.hpp): the tile's blocks are all of
// these groups.
LocalFunction* local_air_function(std::int64_t targets);
void local_air_reference(const LocalJob& job, const Tile& tile);
void local_reference(const LocalJob& job, const Tile& tile);
// With jitter, at every level.
void local_jittered(const LocalJob& job, const Tile& tile);
inline LocalFunction* local_function(const dfield_context& context, const LocalRays& rays) {
    if (rays.jitter.most > 0) return &local_jittered;
    return rays.approximate ? local_approximate_function(context.simd_targets)
                            : local_function(context.simd_targets);
}

// What a session knows of a brick: some of its matter is clipped; its opacities changed since the marks were
// made; some of its voxels became clipped, all of them, or stopped being so; there are such voxels in it.
enum : std::uint8_t { kDiffers = 1, kChanged = 2, kTurned = 4, kGone = 8 };

// The same for a clipped volume, from the factors of the unclipped one.
struct ExchangeJob {
    const OpacityVolume* now = nullptr;  // clipped
    const OpacityBox* before = nullptr;  // unclipped, where bricks differ
    const BrickFlags* flags = nullptr;
    const LocalPlan* plan = nullptr;
    const float* const* unclipped = nullptr;  // factors of each of the tile's blocks, kBlock of them
    float* visibility = nullptr;              // out
};
// Returns the blocks that it left undone, where computing all rays is less work.
using ExchangeFunction = std::uint32_t(const ExchangeJob& job, const Tile& tile);
// Null where there is none: for scalar code, with jitter, and for more rays than are rounded.
ExchangeFunction* exchange_function(const dfield_context& context, const LocalRays& rays);

constexpr float kLocalError = 2e-5f;

// Calls compute(x, y, z) for the voxels of a tile's wanted blocks.
template<class Compute>
void for_voxels(const Grid& grid, const Tile& tile, const Compute& compute) {
    for (std::size_t z = tile.z; z < std::min<std::size_t>(tile.z + kTileZ, grid.nz); ++z)
        for (std::size_t y = tile.y; y < std::min<std::size_t>(tile.y + kTileY, grid.ny); ++y)
            for (std::size_t x = tile.x; x < std::min<std::size_t>(tile.x + kTileX, grid.nx); ++x)
                if (tile.blocks >>
                        block_bit((x - tile.x) / kBlockX, (y - tile.y) / kBlockY, (z - tile.z) / kBlockZ) &
                    1)
                    compute(x, y, z);
}

// The opacity at voxel (x, y, z) + fraction: trilinear, 0 outside the grid.
inline float opacity_at(const OpacityVolume& volume, std::ptrdiff_t x, std::ptrdiff_t y, std::ptrdiff_t z,
                        const float* fraction) {
    const Grid& grid = volume.grid();
    const auto beyond = [](std::ptrdiff_t at, std::size_t n) {
        return at < -1 || at >= static_cast<std::ptrdiff_t>(n);
    };
    if (beyond(x, grid.nx) || beyond(y, grid.ny) || beyond(z, grid.nz)) return 0;
    const float* const at = volume.row(0, 0) + x + y * volume.row_stride() + z * volume.slice_stride();
    const auto lerp = [](float low, float high, float t) { return low + t * (high - low); };
    const auto along_x = [&](const float* p) { return lerp(p[0], p[1], fraction[0]); };
    const auto along_y = [&](const float* p) {
        return lerp(along_x(p), along_x(p + volume.row_stride()), fraction[1]);
    };
    return lerp(along_y(at), along_y(at + volume.slice_stride()), fraction[2]);
}

// As compute_local() needs it, unfilled.
inline OpacityVolume opacity_volume(dfield_context* context, const Grid& grid, const LocalRays& rays) {
    return OpacityVolume(context, grid, rays.low, rays.high, rays.approximate ? 2 : 1);
}
// All of the grid.
void compute_local(dfield_context* context, const LocalJob& job);

}  // namespace dfield::runtime::volume
