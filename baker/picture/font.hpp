// The built-in bitmap font of the captions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "baker/picture/image.hpp"

namespace dfield {

// A glyph's cell in font pixels, with the space to the next letter and the next line.
constexpr std::uint32_t kFontAdvance = 6;
constexpr std::uint32_t kFontLine = 11;

// Breaks at '\n', and at spaces (or within a word that alone is too long) so that no line has more than
// `columns` letters. columns >= 1.
std::vector<std::string> wrap_text(std::string_view text, std::size_t columns);

// Draws one line in dark grey, each font pixel as a square of `scale` pixels; clipped at the picture's edges.
// (x, y) is the upper left corner of the first letter. What is not printable ASCII shows as '?'.
void draw_text(Image& image, std::uint32_t x, std::uint32_t y, std::string_view line, std::uint32_t scale);

}  // namespace dfield
