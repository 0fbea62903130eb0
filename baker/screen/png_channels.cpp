#include "baker/screen/png_channels.hpp"

#include <stb_image.h>
#include <zlib.h>

#include <algorithm>
#include <climits>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/screen/gbuffer_formats.hpp"

namespace dfield {
namespace {

constexpr unsigned char kSignature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

void append_word(std::string& bytes, std::uint32_t word) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>((word >> shift) & 0xff);
}

void append_chunk(std::string& bytes, const char* type, std::string_view data) {
    append_word(bytes, static_cast<std::uint32_t>(data.size()));
    const std::size_t checked = bytes.size();
    bytes.append(type, 4).append(data);
    append_word(bytes,
                static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data() + checked),
                                                   bytes.size() - checked)));
}

// Big-endian rows, each with the filter "up", which turns smooth buffers into small numbers.
std::string filtered_rows(const PngChannels& picture) {
    const std::size_t row = std::size_t{picture.width} * static_cast<std::size_t>(picture.channels);
    std::string rows;
    rows.reserve((2 * row + 1) * picture.height);
    for (std::size_t y = 0; y < picture.height; ++y) {
        rows += '\2';
        for (std::size_t i = 0; i < row; ++i) {
            const std::uint32_t value = picture.values[y * row + i];
            const std::uint32_t above = y > 0 ? picture.values[(y - 1) * row + i] : 0;
            rows += static_cast<char>((value >> 8) - (above >> 8));
            rows += static_cast<char>((value & 0xff) - (above & 0xff));
        }
    }
    return rows;
}

}  // namespace

PngChannels read_png_channels(const std::filesystem::path& path, int channels) {
    const std::vector<std::byte> bytes = read_file(path);
    if (bytes.size() < sizeof kSignature || bytes.size() > INT_MAX ||
        std::memcmp(bytes.data(), kSignature, sizeof kSignature) != 0)
        throw InputError(path.string() + ": not a PNG file");
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = static_cast<int>(bytes.size());
    int width = 0, height = 0, there = 0;
    if (!stbi_info_from_memory(data, size, &width, &height, &there))
        throw InputError(path.string() + ": not a readable PNG (" + stbi_failure_reason() + ")");
    check_picture_size(path.string(), static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height),
                       bytes.size());
    const bool grey = there <= 2;
    if (grey != (channels == 1))
        throw InputError(path.string() + (grey ? ": is grey; three channels are wanted"
                                               : ": has colours; a grey PNG is wanted"));
    const std::unique_ptr<stbi_us, void (*)(void*)> pixels(
        stbi_load_16_from_memory(data, size, &width, &height, &there, channels), stbi_image_free);
    if (!pixels) throw InputError(path.string() + ": not a readable PNG (" + stbi_failure_reason() + ")");
    PngChannels picture{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), channels, {}};
    const std::size_t count =
        std::size_t{picture.width} * picture.height * static_cast<std::size_t>(channels);
    picture.values.assign(pixels.get(), pixels.get() + count);
    return picture;
}

void write_png_channels(const std::filesystem::path& path, const PngChannels& picture) {
    const std::string rows = filtered_rows(picture);
    std::string packed(compressBound(static_cast<uLong>(rows.size())), '\0');
    auto packed_size = static_cast<uLongf>(packed.size());
    if (compress2(reinterpret_cast<Bytef*>(packed.data()), &packed_size,
                  reinterpret_cast<const Bytef*>(rows.data()), static_cast<uLong>(rows.size()), 6) != Z_OK ||
        packed_size > 0x7fffffff)
        throw OutputError(path.string() + ": the picture cannot be packed as PNG");
    std::string header;
    append_word(header, picture.width);
    append_word(header, picture.height);
    header += '\x10';                               // 16 bits
    header += picture.channels == 1 ? '\0' : '\2';  // grey or RGB
    header.append(3, '\0');                         // deflate, adaptive filters, not interlaced
    std::string bytes(reinterpret_cast<const char*>(kSignature), sizeof kSignature);
    append_chunk(bytes, "IHDR", header);
    append_chunk(bytes, "IDAT", std::string_view(packed).substr(0, packed_size));
    append_chunk(bytes, "IEND", {});
    write_file_atomic(path, std::string_view(bytes));
}

}  // namespace dfield
