#include "format/line_table.hpp"

#include <glm/geometric.hpp>

namespace dfield {
namespace {

// The point of the sphere at (u, v) of the square [-1, 1]^2: inverts the warp g(x) = x + k x^2 for the
// coordinates' share of the sum, whose size follows from the point's length, 1.
glm::dvec3 point_of_square(double u, double v) {
    const double lower = std::fabs(u) + std::fabs(v) > 1 ? -1 : 1;
    const double a = lower > 0 ? std::fabs(u) : 1 - std::fabs(v),
                 b = lower > 0 ? std::fabs(v) : 1 - std::fabs(u);
    const glm::dvec3 share(a, b, std::max(0.0, 1 - a - b));
    constexpr double k = kLatticeWarp;
    const auto unwarped = [&](double sum) {
        const auto inverse = [&](double g) { return 2 * g / (1 + std::sqrt(1 + 4 * k * g)); };
        return glm::dvec3(inverse(share.x * sum), inverse(share.y * sum), inverse(share.z * sum));
    };
    // The length grows with the sum. It is 1 between g(1), a point on an axis, and 3 g(1 / sqrt 3), one in
    // the middle of an octant.
    double low = 1, high = 4;
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        const glm::dvec3 x = unwarped(middle);
        (glm::dot(x, x) < 1 ? low : high) = middle;
    }
    const glm::dvec3 x = unwarped(0.5 * (low + high));
    return {std::copysign(x.x, u), std::copysign(x.y, v), lower * x.z};
}

std::string lattice_error(std::uint32_t lattice, const char* name) {
    if (lattice >= kMinLineLattice && lattice <= kMaxLineLattice) return {};
    return std::string(name) + " " + std::to_string(lattice) + " is outside " +
           std::to_string(kMinLineLattice) + ".." + std::to_string(kMaxLineLattice);
}

}  // namespace

std::string line_parameters_error(const LineParameters& parameters) {
    if (std::string error = lattice_error(parameters.lattice, "line lattice"); !error.empty()) return error;
    if (parameters.depth_bits != 0 && parameters.depth_bits != 4 && parameters.depth_bits != 8)
        return std::to_string(parameters.depth_bits) + " bits a depth are not supported (0 for none, 4 or 8)";
    if (parameters.depth_bits == 0 && parameters.depth_lattice != 0)
        return "a depth lattice of " + std::to_string(parameters.depth_lattice) + " needs 4 or 8 depth bits";
    if (parameters.depth_bits != 0)
        if (std::string error = lattice_error(parameters.depth_lattice, "depth lattice"); !error.empty())
            return error;
    if (parameters.pivot && parameters.filtered)
        return "a line table is looked up with a pivot or filtered, not both";
    const std::uint64_t bytes = 4 * (line_hit_words(parameters) + line_depth_words(parameters));
    if (bytes > kMaxLineTableBytes)
        return "the line table would take " + std::to_string(bytes) + " bytes, more than the format's " +
               std::to_string(kMaxLineTableBytes) + "; lower the lattices";
    return {};
}

glm::vec3 lattice_point(std::uint32_t lattice, std::uint32_t index, const glm::dvec2& in_cell) {
    const glm::dvec2 cell(index % lattice, index / lattice);
    const glm::dvec2 square = 2.0 * (cell + in_cell) / static_cast<double>(lattice) - 1.0;
    return glm::vec3(point_of_square(square.x, square.y));
}

std::vector<glm::vec3> lattice_points(std::uint32_t lattice) {
    std::vector<glm::vec3> points;
    points.reserve(lattice_point_count(lattice));
    for (std::uint32_t i = 0; i < lattice_point_count(lattice); ++i)
        points.push_back(lattice_point(lattice, i));
    return points;
}

}  // namespace dfield
