// What local ambient occlusion samples: opacities on a padded grid, and which parts of it are empty.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "volume/buffer.hpp"
#include "volume/grid.hpp"

namespace dfield::runtime::volume {

// Opacity of a sample's value: piecewise linear, constant beyond the first and the last point; of two points
// at the same value the second holds from there on.
class OpacityFunction {
  public:
    struct Point {
        float value, opacity;
    };
    // Values ascend, opacities within 0..1. An opacity is that of `exponent` of the unit that it is given
    // for: 1 - (1 - a)^exponent.
    OpacityFunction(std::pmr::memory_resource* memory, std::span<const Point> points, float exponent,
                    SampleType type);

    // Opacities of a row's samples [begin, end), a float each from `out` on.
    // False where one is not finite.
    bool row(const std::byte* samples, std::size_t begin, std::size_t end, float* out) const;
    float operator()(float value) const;

  private:
    std::pmr::vector<Point> points_;
    float exponent_;
    SampleType type_;
    std::pmr::vector<float> table_;  // of all values of a type of one or two bytes
};

// Blocks are what voxels are computed in; bricks what is known to be empty or not.
constexpr std::size_t kBlockX = 16, kBlockY = 4, kBlockZ = 2, kBlock = kBlockX * kBlockY * kBlockZ;
constexpr std::size_t kBrickX = 4, kBrickY = 4, kBrickZ = 2;

using Offset = std::array<std::int32_t, 3>;

// Flags of bricks, eight bits for whoever owns them, and of windows of 5 x 2 x 2 bricks by their lowest one.
// A block's samples of one step, at any offset, lie within the window that begins at the brick of the lowest
// of the voxels that they touch.
class BrickFlags {
  public:
    // For samples at offsets from `low` to `high`, in voxels.
    BrickFlags(dfield_context* context, const Grid& grid, const Offset& low, const Offset& high);

    std::size_t nx() const { return n_[0]; }
    std::size_t ny() const { return n_[1]; }
    std::size_t nz() const { return n_[2]; }
    std::uint8_t* brick(std::size_t x, std::size_t y, std::size_t z) const {
        return bricks_ + static_cast<std::ptrdiff_t>(at(x, y, z));
    }
    // Brings the windows up to date that bricks [low, high) are part of.
    void update_windows(const std::size_t low[3], const std::size_t high[3]) const;
    void update_windows() const;
    // Takes these bits off all flags.
    void clear(std::uint8_t bits) const;
    // The box of bricks [low, high) that have one of these bits; false where none has.
    bool bounds(std::uint8_t bits, std::size_t low[3], std::size_t high[3]) const;

    // The window of a block that begins at this voxel, and how far from it that of its samples at an offset
    // is.
    const std::uint8_t* window(std::size_t x, std::size_t y, std::size_t z) const {
        return windows_ + static_cast<std::ptrdiff_t>(at(x / kBrickX, y / kBrickY, z / kBrickZ));
    }
    std::ptrdiff_t window_offset(const Offset& offset) const;
    // The same in bricks: along a row, rows, slices.
    Offset window_step(const Offset& offset) const;
    // The window that begins with this brick; also before the first one and beyond the last.
    const std::uint8_t* window_at(std::ptrdiff_t x, std::ptrdiff_t y, std::ptrdiff_t z) const {
        return window(0, 0, 0) + (x + y * row_ + z * slice_);
    }

  private:
    std::size_t at(std::size_t x, std::size_t y, std::size_t z) const {
        return x + before_[0] + (y + before_[1]) * static_cast<std::size_t>(row_) +
               (z + before_[2]) * static_cast<std::size_t>(slice_);
    }
    std::size_t n_[3], before_[3], size_;
    std::int32_t farthest_[3];  // no offset this large leads from one voxel of the grid to another
    std::ptrdiff_t row_, slice_;
    Buffer<std::uint8_t> bricks_, windows_;
};

// How far before the first voxel of a brick, and after the last, a block's samples can lie whose window holds
// that brick.
constexpr std::size_t kPadX = 4 * kBrickX, kPadY = kBrickY, kPadZ = kBrickZ;

constexpr std::size_t round_up(std::size_t n, std::size_t to) {
    return (n + to - 1) / to * to;
}
// Floats of rows, and of slices, that do not compete for the same sets of the cache as their neighbours: an
// odd number of cache lines.
constexpr std::size_t odd_lines(std::size_t floats) {
    return 16 * ((floats + 15) / 16 | 1);
}

// A float a voxel, 0 around the grid as far as a block's samples can lie whose window is not empty. A row's
// padding is that of the next one too.
class OpacityVolume {
  public:
    // together: how many blocks along y, and along z, are read where one of their windows is not empty.
    OpacityVolume(dfield_context* context, const Grid& grid, const Offset& low, const Offset& high,
                  std::size_t together = 1);

    float* row(std::size_t y, std::size_t z) const {
        return values_ + origin_ + static_cast<std::ptrdiff_t>(y) * row_ +
               static_cast<std::ptrdiff_t>(z) * slice_;
    }
    std::ptrdiff_t row_stride() const { return row_; }
    std::ptrdiff_t slice_stride() const { return slice_; }
    const BrickFlags& occupied() const { return occupied_; }
    // Sets the flags of the bricks that voxels [low, high) lie in, and their windows.
    void update_occupied(dfield_context* context, const std::size_t low[3], const std::size_t high[3]);
    const Grid& grid() const { return grid_; }

  private:
    Grid grid_;
    std::ptrdiff_t row_, slice_, origin_;
    Buffer<float> values_;
    BrickFlags occupied_;
};

// All of a volume through a transfer function, unclipped. False where a sample is not finite.
[[nodiscard]] bool fill_opacity(dfield_context* context, const Samples& samples,
                                const OpacityFunction& function, OpacityVolume& volume);

}  // namespace dfield::runtime::volume
