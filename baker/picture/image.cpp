#include "baker/picture/image.hpp"

#include <stb_image.h>
#include <stb_image_write.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/picture/font.hpp"

namespace dfield {
namespace {

void copy_into(Image& target, const Image& source, std::uint32_t x, std::uint32_t y) {
    for (std::uint32_t row = 0; row < source.height; ++row)
        std::copy_n(source.at(0, row), std::size_t{3} * source.width, target.at(x, y + row));
}

}  // namespace

Image::Image(std::uint32_t w, std::uint32_t h, glm::u8vec3 fill)
    : width(w), height(h), rgb(std::size_t{3} * w * h) {
    for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = fill[static_cast<int>(i % 3)];
}

void write_png(const std::filesystem::path& path, const Image& image) {
    if (image.rgb.empty() || image.rgb.size() != std::size_t{3} * image.width * image.height ||
        image.rgb.size() > INT_MAX)
        throw OutputError(path.string() + ": a picture of " + std::to_string(image.width) + " x " +
                          std::to_string(image.height) +
                          " pixels cannot be written as PNG; choose another size");
    std::vector<std::byte> bytes;
    const auto append = [](void* context, void* data, int size) {
        const auto* begin = static_cast<const std::byte*>(data);
        static_cast<std::vector<std::byte>*>(context)->insert(
            static_cast<std::vector<std::byte>*>(context)->end(), begin, begin + size);
    };
    if (!stbi_write_png_to_func(append, &bytes, static_cast<int>(image.width), static_cast<int>(image.height),
                                3, image.rgb.data(), static_cast<int>(3 * image.width)))
        throw OutputError(path.string() + ": the picture cannot be packed as PNG: out of memory");
    write_file_atomic(path, bytes);
}

Image read_png(const std::filesystem::path& path) {
    constexpr unsigned char kSignature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    const std::vector<std::byte> bytes = read_file(path);
    if (bytes.size() < sizeof kSignature || std::memcmp(bytes.data(), kSignature, sizeof kSignature) != 0)
        throw InputError(path.string() + ": not a PNG file; convert it to PNG");
    if (bytes.size() > INT_MAX)
        throw InputError(path.string() + ": larger than 2 GiB; scale the picture down");
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
        stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()),
                              &width, &height, &channels, 3),
        stbi_image_free);
    if (!pixels)
        throw InputError(path.string() + ": not a readable PNG (" + stbi_failure_reason() +
                         "); write it again");
    Image image(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height));
    std::copy_n(pixels.get(), image.rgb.size(), image.rgb.begin());
    return image;
}

Image image_difference(const Image& a, const Image& b, float factor) {
    if (a.width != b.width || a.height != b.height)
        throw std::invalid_argument("image_difference: the pictures differ in size");
    Image result(a.width, a.height);
    for (std::size_t i = 0; i < result.rgb.size(); ++i) {
        const float scaled = std::round(factor * static_cast<float>(std::abs(int{a.rgb[i]} - int{b.rgb[i]})));
        result.rgb[i] = static_cast<std::uint8_t>(std::clamp(scaled, 0.0f, 255.0f));
    }
    return result;
}

Image image_row(std::span<const Image> images, std::span<const std::string> captions, std::uint32_t gap) {
    if (images.empty()) return {};
    if (!captions.empty() && captions.size() != images.size())
        throw std::invalid_argument("image_row: one caption for each picture, or none at all");
    std::uint32_t width = 0, image_height = 0, narrowest = UINT32_MAX;
    for (const Image& image : images) {
        width += image.width + (width ? gap : 0);
        image_height = std::max(image_height, image.height);
        narrowest = std::min(narrowest, image.width);
    }

    const std::uint32_t scale = std::clamp((narrowest + 107) / 213, 1u, 8u);
    std::vector<std::vector<std::string>> lines(images.size());
    std::size_t line_count = 0;
    for (std::size_t i = 0; i < captions.size(); ++i) {
        lines[i] = wrap_text(captions[i], std::max(1u, images[i].width / (kFontAdvance * scale)));
        line_count = std::max(line_count, lines[i].size());
    }
    const auto text_height =
        static_cast<std::uint32_t>(line_count ? (line_count * kFontLine + 3) * scale : 0);

    Image result(width, image_height + text_height);
    std::uint32_t x = 0;
    for (std::size_t i = 0; i < images.size(); ++i) {
        copy_into(result, images[i], x, 0);
        std::uint32_t y = images[i].height + 4 * scale;
        for (const std::string& line : lines[i]) {
            const auto line_width = static_cast<std::uint32_t>(line.size() * kFontAdvance * scale);
            const std::uint32_t indent =
                images[i].width > line_width ? (images[i].width - line_width) / 2 : 0;
            draw_text(result, x + indent, y, line, scale);
            y += kFontLine * scale;
        }
        x += images[i].width + gap;
    }
    return result;
}

Image image_column(std::span<const Image> images, std::uint32_t gap) {
    std::uint32_t width = 0, height = 0;
    for (const Image& image : images) {
        width = std::max(width, image.width);
        height += image.height + (height ? gap : 0);
    }
    Image result(width, height);
    std::uint32_t y = 0;
    for (const Image& image : images) {
        copy_into(result, image, 0, y);
        y += image.height + gap;
    }
    return result;
}

}  // namespace dfield
