// The opacities of a volume before it was clipped, where they may be others now.
#pragma once

#include <array>

#include "volume/opacity.hpp"

namespace dfield::runtime::volume {

// All that samples read whose window holds a brick that differs: a box, packed but for a cache line a row.
class OpacityBox {
  public:
    // Brings the box up to date with what differs: flags of bricks of `clipped` by `bit`. `same`: only clips
    // have changed since the last time. Without memory nothing is kept.
    void cover(dfield_context* context, const OpacityVolume& clipped, const BrickFlags& flags,
               std::uint8_t bit, const Samples& samples, const OpacityFunction& function, bool same);

    // Where voxel (x, y, z) is, or would be.
    const float* at(std::ptrdiff_t x, std::ptrdiff_t y, std::ptrdiff_t z) const {
        return values_ + ((x - low_[0]) + (y - low_[1]) * row_ + (z - low_[2]) * slice_);
    }
    std::ptrdiff_t row_stride() const { return row_; }
    std::ptrdiff_t slice_stride() const { return slice_; }

  private:
    void fill(dfield_context* context, const OpacityVolume& clipped, const BrickFlags& flags,
              std::uint8_t bit, const Samples& samples, const OpacityFunction& function) const;

    std::array<std::ptrdiff_t, 3> low_{}, high_{};
    std::ptrdiff_t row_ = 0, slice_ = 0;
    std::size_t size_ = 0;
    Buffer<float> values_;
};

}  // namespace dfield::runtime::volume
