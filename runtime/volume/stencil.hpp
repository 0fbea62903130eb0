// Which windows of bricks a block's samples look into; and the blocks that meet a flag by that.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "context.hpp"
#include "volume/opacity.hpp"

namespace dfield::runtime::volume {

class Stencil {
  public:
    // Of samples at these offsets from a voxel.
    Stencil(std::pmr::memory_resource* memory, const BrickFlags& flags, std::span<const Offset> offsets);

    // Adds those blocks of the grid to `blocks`, 32 bits a tile, of whose windows one has this bit. For all
    // blocks of a row at once, a bit each: a window and a block are a shift apart.
    void mark(dfield_context* context, const Grid& grid, const BrickFlags& flags, std::uint8_t bit,
              std::pmr::vector<std::uint32_t>& blocks) const;

  private:
    // From a block's own window: `along` blocks and `phase` bricks, rows, slices.
    struct Step {
        std::int32_t z, phase, along, y;
    };
    std::pmr::vector<Step> steps_;  // each once
    Offset low_{}, high_{};         // of steps' along, y, z
};

}  // namespace dfield::runtime::volume
