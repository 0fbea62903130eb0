// Receivers of a chunk as they come, before they are sorted into blocks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>

#include "dfield/dfield.h"

namespace dfield::runtime {

inline constexpr std::size_t kMostLoaded = 2048;  // a chunk's worth
inline constexpr int kCellBits = 4;               // of each of the two axes across a normal
// For each axis that normals point along, either way; the last holds receivers that are unusable.
inline constexpr std::uint32_t kCells = 6u << 2 * kCellBits, kNoCell = kCells;

// Bits 0 to 3 to places 0, 2, 4, 6.
constexpr std::uint32_t spread(std::uint32_t v) {
    v = (v | v << 2) & 0x33;
    return (v | v << 1) & 0x55;
}

struct Loaded {
    std::size_t count = 0;
    // One array an axis; normals are unit, or zero where a receiver is unusable.
    alignas(64) std::array<float, kMostLoaded> x, y, z, nx, ny, nz;
    // Where a receiver goes: first by the axis that is nearest to its normal, then along a curve
    // across that axis. Surfaces that face alike and lie behind each other are rare among neighbours.
    alignas(64) std::array<std::uint32_t, kMostLoaded> cells;
    // Of usable receivers.
    glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};

    // Cells are squares, so that narrow sets of receivers use all bits on their long side.
    float cell_scale() const {
        const glm::vec3 size = high - low;
        const float side = size.x > size.y   ? (size.x > size.z ? size.x : size.z)
                           : size.y > size.z ? size.y
                                             : size.z;
        return side > 0 ? 0.9999f * (1 << kCellBits) / side : 0.0f;
    }
};

// Receivers of any layout, from `begin` on, into loaded.count places: all but the cells.
void load_receivers(const dfield_receivers& receivers, std::size_t begin, Loaded& loaded);

}  // namespace dfield::runtime
