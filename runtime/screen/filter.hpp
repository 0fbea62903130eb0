// Section 5's filter: the mean over the pixels around that have one of each set of samples, but for those
// that lie elsewhere in depth. And what becomes of the means: O, and I = L~ (1 - O).
#pragma once

#include <cstdint>

#include "screen/frame.hpp"

namespace dfield::runtime::screen {

struct FilterJob {
    const Frame* frame = nullptr;
    std::int32_t side = 1;  // of the interleaved square; 1: no filter
    float limit = 0;        // world units, of depth from the tangent plane
    bool indirect = false;
    // Planes of frame->layout; the four of light lie after each other, and so do the two of slopes.
    const float* visibility = nullptr;
    const float* light = nullptr;
    const float* slopes = nullptr;

    std::int32_t reach() const { return side / 2; }
    // Of a column or row at this distance. Even squares have no middle: both outermost have one half.
    float weight(std::int32_t distance) const {
        return side % 2 == 0 && 2 * std::abs(distance) == side ? 0.5f : 1;
    }
};

// The pixels of a row from column `first` on, kFilterColumns or fewer: O, and the three of I.
constexpr std::int32_t kFilterColumns = 512;
using FilterFunction = void(const FilterJob& job, std::int32_t row, std::int32_t first,
                            float (*out)[kFilterColumns]);
FilterFunction* filter_function(std::int64_t targets);
void filter_reference(const FilterJob& job, std::int32_t row, std::int32_t first,
                      float (*out)[kFilterColumns]);

// Three rows of `count` floats as one of `count` triples.
using ZipFunction = void(const float* x, const float* y, const float* z, std::int32_t count, float* out);
ZipFunction* zip_function(std::int64_t targets);
void zip_reference(const float* x, const float* y, const float* z, std::int32_t count, float* out);

}  // namespace dfield::runtime::screen
