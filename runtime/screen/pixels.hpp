// Arrays of pixels: the caller's with their strides, and the library's own with a border.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "volume/buffer.hpp"

namespace dfield::runtime::screen {

using volume::Buffer;

// The caller's.
template<class Value>
class StridedPixels {
    using Byte = std::conditional_t<std::is_const_v<Value>, const char, char>;

  public:
    StridedPixels() = default;
    StridedPixels(Value* data, std::ptrdiff_t pixel_stride, std::ptrdiff_t row_stride, std::uint32_t width,
                  std::ptrdiff_t values)
        : data_(reinterpret_cast<Byte*>(data)),
          pixel_(pixel_stride ? pixel_stride : values * static_cast<std::ptrdiff_t>(sizeof(Value))),
          row_(row_stride ? row_stride : pixel_ * static_cast<std::ptrdiff_t>(width)) {}

    explicit operator bool() const { return data_ != nullptr; }
    Value* at(std::size_t column, std::size_t row) const {
        return reinterpret_cast<Value*>(data_ + static_cast<std::ptrdiff_t>(column) * pixel_ +
                                        static_cast<std::ptrdiff_t>(row) * row_);
    }
    // Whether a row's values lie side by side, `values` a pixel.
    bool packed(std::ptrdiff_t values) const {
        return pixel_ == values * static_cast<std::ptrdiff_t>(sizeof(Value));
    }

  private:
    Byte* data_ = nullptr;
    std::ptrdiff_t pixel_ = 0, row_ = 0;
};

// The size of a picture, and where its pixels lie in arrays that have kBorder more columns and rows on every
// side: as far as the widest filter reaches.
struct Layout {
    static constexpr std::int32_t kBorder = 8;

    Layout() = default;
    Layout(std::uint32_t width, std::uint32_t height)
        : width(static_cast<std::int32_t>(width)),
          height(static_cast<std::int32_t>(height)),
          stride((this->width + 2 * kBorder + 15) / 16 * 16) {}

    std::size_t size() const {
        return static_cast<std::size_t>(stride) * static_cast<std::size_t>(height + 2 * kBorder);
    }
    // Of columns and rows from -kBorder on.
    std::ptrdiff_t index(std::ptrdiff_t column, std::ptrdiff_t row) const {
        return (row + kBorder) * stride + column + kBorder;
    }

    std::int32_t width = 0, height = 0;
    std::ptrdiff_t stride = 0;
};

}  // namespace dfield::runtime::screen
