// The sets of rays that tables 5 and 6 compare.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dfield::cutting {

// w_k of the paper's set of 6, 14, 26 or 54 directions that integrate more exactly than equal ones: Lebedev's
// quadrature where the directions are its own, otherwise the solid angles of the stickers.
std::vector<float> better_weights(std::uint32_t rays);

}  // namespace dfield::cutting
