// The sets of rays that tables 5 and 6 compare.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/cli/volume_local.hpp"
#include "bench/cutting/scenes.hpp"

namespace dfield::cutting {

inline constexpr std::array<std::uint32_t, 4> kRays{6, 14, 26, 54};
inline constexpr std::uint32_t kTruth = 512;

// So many rays of the scene's length.
cli::LocalOptions options_of(const Scene& scene, std::uint32_t rays);
// The root of the mean square of what two volumes of equal size differ by.
double rms(std::span<const float> a, std::span<const float> b);

// w_k of the paper's set of 6, 14, 26 or 54 directions that integrate more exactly than equal ones: Lebedev's
// quadrature where the directions are its own, otherwise the solid angles of the stickers.
std::vector<float> better_weights(std::uint32_t rays);

}  // namespace dfield::cutting
