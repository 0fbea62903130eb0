#include "baker/cli/surface_points.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace dfield::cli {
namespace {

// Calls use(voxel, axis, a, b) for every edge from a voxel along an axis whose ends, a and b, differ in sign.
template<class Use>
void for_crossings(const dfield_volume_grid& grid, std::span<const float> distance, const Use& use) {
    const std::array<std::size_t, 3> stride{1, grid.dims[0], std::size_t{grid.dims[0]} * grid.dims[1]};
    std::array<std::size_t, 3> begin{}, end{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        begin[axis] = grid.dims[axis] < 8 ? 0 : kSurfaceMargin;
        end[axis] = grid.dims[axis] - begin[axis];
    }
    for (std::size_t z = begin[2]; z < end[2]; ++z)
        for (std::size_t y = begin[1]; y < end[1]; ++y)
            for (std::size_t x = begin[0]; x < end[0]; ++x) {
                const std::array<std::size_t, 3> voxel{x, y, z};
                const std::size_t at = x + y * stride[1] + z * stride[2];
                for (std::size_t axis = 0; axis < 3; ++axis)
                    if (voxel[axis] + 1 < end[axis] &&
                        std::signbit(distance[at]) != std::signbit(distance[at + stride[axis]]))
                        use(voxel, axis, distance[at], distance[at + stride[axis]]);
            }
}

}  // namespace

std::vector<float> surface_points(const dfield_volume_grid& grid, std::span<const float> distance,
                                  std::size_t wanted, std::size_t* crossings) {
    std::size_t count = 0;
    for_crossings(grid, distance, [&](const auto&, std::size_t, float, float) { ++count; });
    if (crossings) *crossings = count;
    const std::size_t points = std::min(wanted, count);
    std::vector<float> positions;
    positions.reserve(3 * points);
    std::size_t seen = 0, taken = 0;
    for_crossings(grid, distance,
                  [&](const std::array<std::size_t, 3>& voxel, std::size_t axis, float a, float b) {
                      // The first crossing at or behind each of `points` even steps.
                      if (seen++ * points < taken * count || taken == points) return;
                      ++taken;
                      std::array<float, 3> index{static_cast<float>(voxel[0]), static_cast<float>(voxel[1]),
                                                 static_cast<float>(voxel[2])};
                      if (a != b) index[axis] += a / (a - b);  // equal: 0 and -0
                      for (std::size_t i = 0; i < 3; ++i) positions.push_back(index[i] * grid.spacing[i]);
                  });
    return positions;
}

VisibilityError visibility_error(std::span<const float> found, std::span<const float> truth) {
    const auto count = static_cast<double>(found.size());
    double mean_found = 0, mean_truth = 0, squares = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        mean_found += found[i] / count;
        mean_truth += truth[i] / count;
        const double error = double{found[i]} - double{truth[i]};
        squares += error * error;
    }
    double covariance = 0, variance_found = 0, variance_truth = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const double f = found[i] - mean_found, t = truth[i] - mean_truth;
        covariance += f * t;
        variance_found += f * f;
        variance_truth += t * t;
    }
    // What rounding leaves of a constant's variance is none.
    const double least = 1e-12 * count;
    const bool vary = variance_found > least && variance_truth > least;
    return {std::sqrt(squares / count), mean_found - mean_truth,
            vary ? covariance / std::sqrt(variance_found * variance_truth)
                 : std::numeric_limits<double>::quiet_NaN()};
}

}  // namespace dfield::cli
