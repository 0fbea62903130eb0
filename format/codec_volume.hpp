// Prediction of an occlusion volume's octants, shared by encoder and decoder. FORMAT.md, "Occlusion volume
// (VOLU)", is normative.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "format/occlusion_volume.hpp"

namespace dfield::codec {

// What is expected of octant `i` of sample (x, y, z), from samples that come before it.
inline int predict_octant(const OcclusionVolume& volume, std::size_t i, std::size_t x, std::size_t y,
                          std::size_t z) {
    const std::size_t row = volume.dims[0], slice = row * volume.dims[1];
    const std::size_t here = x + y * row + z * slice;
    const auto before = [&](std::size_t steps) { return static_cast<int>(volume.octant(here - steps, i)); };
    const bool has_x = x > 0, has_y = y > 0, has_z = z > 0;
    if (has_x && has_y && has_z) {
        const int a = before(1), b = before(row), c = before(slice);
        const int sum = 2 * (a + b + c) - before(1 + row) - before(1 + slice) - before(row + slice);
        return std::clamp((sum + 1) / 3, std::min({a, b, c}), std::max({a, b, c}));
    }
    if (has_x && has_y) return std::clamp(before(1) + before(row) - before(1 + row), 0, 255);
    if (has_x && has_z) return std::clamp(before(1) + before(slice) - before(1 + slice), 0, 255);
    if (has_y && has_z) return std::clamp(before(row) + before(slice) - before(row + slice), 0, 255);
    return has_x ? before(1) : has_y ? before(row) : has_z ? before(slice) : 255;
}

// Calls visit(octant, sample, expected) for the eight octants one after the other, samples in order. The
// octant of the sample may be set in the call.
template<class Visit>
void for_octants(const OcclusionVolume& volume, const Visit& visit) {
    for (std::size_t i = 0; i < kVolumeOctants; ++i) {
        std::size_t sample = 0;
        for (std::size_t z = 0; z < volume.dims[2]; ++z)
            for (std::size_t y = 0; y < volume.dims[1]; ++y)
                for (std::size_t x = 0; x < volume.dims[0]; ++x, ++sample)
                    visit(i, sample, predict_octant(volume, i, x, y, z));
    }
}

// Residuals modulo 256, folded: 0, -1, 1, -2, 2 ... become 0, 1, 2, 3, 4 ...
inline std::uint8_t fold_residual(int value, int expected) {
    const auto residual = static_cast<std::int8_t>(static_cast<std::uint8_t>(value - expected));
    return static_cast<std::uint8_t>(residual >= 0 ? 2 * residual : -2 * residual - 1);
}
inline std::uint8_t unfold_residual(std::uint8_t folded, int expected) {
    const int residual = folded % 2 == 0 ? folded / 2 : -(folded + 1) / 2;
    return static_cast<std::uint8_t>(expected + residual);
}

}  // namespace dfield::codec
