// PNGs of one or three channels with 8 or 16 bits, as numbers 0..1: buffers, not pictures to look at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace dfield {

struct PngChannels {
    std::uint32_t width = 0, height = 0;
    int channels = 1;                   // 1 or 3
    std::vector<std::uint16_t> values;  // 0..65535; 8-bit ones are widened (255 becomes 65535)
};

// Greys as they are where channels is 1, colours where it is 3; alpha is dropped. Throws InputError.
PngChannels read_png_channels(const std::filesystem::path& path, int channels);

// 16 bits. Throws OutputError.
void write_png_channels(const std::filesystem::path& path, const PngChannels& picture);

}  // namespace dfield
