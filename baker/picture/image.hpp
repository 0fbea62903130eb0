// 8-bit pictures: PNG in and out, differences, and captioned rows and columns for reports.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/ext/vector_uint3_sized.hpp>
#include <span>
#include <string>
#include <vector>

namespace dfield {

// Values are written as they are (255 = visibility 1), without a transfer curve; rows from the top.
struct Image {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  // 3 * width * height

    Image() = default;
    Image(std::uint32_t w, std::uint32_t h, glm::u8vec3 fill = {255, 255, 255});
    std::uint8_t* at(std::uint32_t x, std::uint32_t y) { return &rgb[3 * (std::size_t{y} * width + x)]; }
    const std::uint8_t* at(std::uint32_t x, std::uint32_t y) const {
        return &rgb[3 * (std::size_t{y} * width + x)];
    }
};

void write_png(const std::filesystem::path& path, const Image& image);  // atomic; throws OutputError
Image read_png(const std::filesystem::path& path);  // any PNG, as 8-bit RGB, alpha dropped; throws InputError

// |a - b| * factor per channel, rounded and clamped. Throws std::invalid_argument when the sizes differ.
Image image_difference(const Image& a, const Image& b, float factor);

// Pictures side by side on white, aligned at the top, `gap` pixels apart. Either no captions or one for each
// picture: printable ASCII in a built-in bitmap font below the picture, centred, wrapped at its width ('\n'
// breaks a line). Letters are sized by the narrowest picture (21 pixels high at 640) so that they stay
// readable when the row is shown smaller. Throws std::invalid_argument when the counts differ.
Image image_row(std::span<const Image> images, std::span<const std::string> captions = {},
                std::uint32_t gap = 8);

// Rows under each other, aligned at the left, on white.
Image image_column(std::span<const Image> images, std::uint32_t gap = 8);

}  // namespace dfield
