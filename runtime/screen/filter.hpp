// Section 5's filter: the mean over the pixels around that have one of each set of samples, but for those
// that lie elsewhere in depth.
#pragma once

#include <cstdint>

#include "screen/frame.hpp"

namespace dfield::runtime::screen {

struct FilterJob {
    const Frame* frame = nullptr;
    std::int32_t side = 1;      // of the interleaved square
    float limit = 0;            // world units, of depth
    std::int32_t channels = 1;  // 1: visibility, 5: indirect light too
    // Planes of frame->layout; those of light lie after each other, and so do the slopes.
    const float* visibility = nullptr;
    const float* light = nullptr;
    const float* slopes = nullptr;

    std::int32_t reach() const { return side / 2; }
    // Of a column or row at this distance. Even squares have no middle: both outermost have one half.
    float weight(std::int32_t distance) const {
        return side % 2 == 0 && 2 * std::abs(distance) == side ? 0.5f : 1;
    }
};

// The pixels of a row from column `first` on, kFilterColumns or fewer: kFilterColumns floats a channel.
constexpr std::int32_t kFilterColumns = 512;
using FilterFunction = void(const FilterJob& job, std::int32_t row, std::int32_t first, float* out);
void filter_reference(const FilterJob& job, std::int32_t row, std::int32_t first, float* out);

}  // namespace dfield::runtime::screen
