// A frame taken apart: a picture of its own for every place in the interleaved square, whose pixels use the
// same samples. A sample that is as many pixels away from each of them lies side by side in one of these
// pictures.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "screen/frame.hpp"

namespace dfield::runtime::screen {

struct Lattice {
    static constexpr std::int32_t kBorder = 16;  // columns of sky on both sides: as many as the most lanes
    static constexpr std::int32_t kMostSide = 8;

    Lattice() = default;
    Lattice(const Layout& layout, std::uint32_t side)
        : side(static_cast<std::int32_t>(side)),
          width((layout.width + this->side - 1) / this->side),
          height((layout.height + this->side - 1) / this->side),
          stride((width + kBorder - 1) / kBorder * kBorder + 2 * kBorder),
          picture(stride * (height + 2)) {}

    // Of a plane that has all pictures, each with a row of sky above and below it.
    std::size_t size() const { return static_cast<std::size_t>(side * side * picture); }
    std::ptrdiff_t index(std::int32_t x, std::int32_t y, std::int32_t column, std::int32_t row) const {
        return (y * side + x) * picture + (row + 1) * stride + column + kBorder;
    }

    std::int32_t side = 1;
    std::int32_t width = 0, height = 0;  // of one picture
    std::ptrdiff_t stride = 0, picture = 0;

    float* depth = nullptr;    // a plane
    float* normals = nullptr;  // three, unit length and towards the viewer
    // Only for indirect light, NaN and less than 0 are 0: three planes, or for lookups here and there two of
    // four floats a pixel, normals and radiance, whose fourth is 1.
    float* radiance = nullptr;
    float* quads = nullptr;
};

// Writes the sky above and below the pictures.
void surround(const Frame& frame, const Lattice& lattice);

// Takes rows of the frame apart, the planes that are not null. Any threads.
using TakeApartFunction = void(const Frame& frame, const Lattice& lattice, std::int32_t begin,
                               std::int32_t end);
TakeApartFunction* take_apart_function(std::int64_t targets);

}  // namespace dfield::runtime::screen
