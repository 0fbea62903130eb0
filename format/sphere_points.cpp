#include "format/sphere_points.hpp"

#include <glm/vec2.hpp>
#include <numbers>

namespace dfield {
namespace {

// (cos, sin) of `numerator / denominator` quarter turns, exact on the axes.
glm::dvec2 unit_circle(std::uint32_t numerator, std::uint32_t denominator) {
    const double angle = std::numbers::pi / 2 * (numerator % denominator) / denominator;
    const glm::dvec2 first{std::cos(angle), std::sin(angle)};
    switch (numerator / denominator % 4) {
        case 0:
            return first;
        case 1:
            return {-first.y, first.x};
        case 2:
            return -first;
        default:
            return {first.y, -first.x};
    }
}

void append_ring(std::vector<glm::vec3>& points, std::uint32_t n, std::uint32_t k, bool south) {
    const double u = static_cast<double>(k) / n;
    const double z = (1 - u) * (1 + u);
    const double radius = u * std::sqrt((1 - u) * (1 + u) + 1);  // sqrt(1 - z^2)
    for (std::uint32_t j = 0; j < std::max(1u, 4 * k); ++j) {
        const glm::dvec2 circle = unit_circle(j, std::max(1u, k));
        points.emplace_back(radius * circle.x, radius * circle.y, south ? -z : z);
    }
}

}  // namespace

std::vector<glm::vec3> sphere_points(Positions positions, std::uint32_t subdivision) {
    std::vector<glm::vec3> points;
    const std::uint32_t n = subdivision;
    if (positions == Positions::kSlater) {
        points.reserve(SlaterRings{n}.count());
        for (std::uint32_t k = 0; k <= n; ++k) append_ring(points, n, k, false);
        for (std::uint32_t k = n; k-- > 0;) append_ring(points, n, k, true);
    } else {
        const LatlongGrid grid{n};
        points.reserve(grid.count());
        for (std::uint32_t row = 0; row < grid.rows(); ++row) {
            const double theta = std::numbers::pi * (row + 0.5) / grid.rows();
            for (std::uint32_t column = 0; column < grid.columns(); ++column) {
                const glm::dvec2 circle = unit_circle(4 * column, grid.columns());
                points.emplace_back(std::sin(theta) * circle.x, std::sin(theta) * circle.y, std::cos(theta));
            }
        }
    }
    return points;
}

}  // namespace dfield
