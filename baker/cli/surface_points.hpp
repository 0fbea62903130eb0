// Points of a swept isosurface, evenly chosen: where errors of visibility are measured.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "dfield/dfield.hpp"

namespace dfield::cli {

// Voxels along the grid's border without points, where gradients are one-sided; none along axes of fewer than
// 8.
inline constexpr std::size_t kSurfaceMargin = 2;

// Where `distance` changes its sign along the grid's edges, in world units of the grid's own frame, 3 floats
// each: every crossing in the order of the voxels, or `wanted` of them, evenly spread over that order.
// `crossings` (may be null) says how many there are.
std::vector<float> surface_points(const dfield_volume_grid& grid, std::span<const float> distance,
                                  std::size_t wanted, std::size_t* crossings = nullptr);

struct VisibilityError {
    double rms = 0, bias = 0;  // of found - truth
    double correlation = 0;    // Pearson's; NaN where either does not vary
};
VisibilityError visibility_error(std::span<const float> found, std::span<const float> truth);

}  // namespace dfield::cli
