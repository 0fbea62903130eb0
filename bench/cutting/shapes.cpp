#include "bench/cutting/shapes.hpp"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>
#include <span>

namespace dfield::cutting {
namespace {

// A profile of (radius, z) turned around the z axis; radii of 0 are poles. A closed profile joins its ends.
TriangleMesh revolved(std::span<const glm::dvec2> profile, unsigned sides, bool closed) {
    TriangleMesh mesh;
    for (unsigned side = 0; side < sides; ++side) {
        const double angle = 2 * glm::pi<double>() * (side + 0.5) / sides;
        for (const glm::dvec2& p : profile)
            mesh.positions.emplace_back(p.x * std::cos(angle), p.x * std::sin(angle), p.y);
    }
    const auto points = static_cast<unsigned>(profile.size());
    for (unsigned side = 0; side < sides; ++side)
        for (unsigned i = 0; i + (closed ? 0 : 1) < points; ++i) {
            const unsigned j = (i + 1) % points, here = side * points, next = (side + 1) % sides * points;
            if (profile[i].x > 0) mesh.triangles.emplace_back(here + i, next + i, next + j);
            if (profile[j].x > 0) mesh.triangles.emplace_back(here + i, next + j, here + j);
        }
    return mesh;
}

std::vector<glm::dvec2> arc(const glm::dvec2& centre, double radius, double from, double to, unsigned steps) {
    std::vector<glm::dvec2> points;
    for (unsigned i = 0; i <= steps; ++i) {
        const double angle = from + (to - from) * i / steps;
        points.push_back(centre + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
    }
    return points;
}

}  // namespace

TriangleMesh unit_sphere() {
    std::vector<glm::dvec2> half = arc(glm::dvec2(0), 1, -glm::half_pi<double>(), glm::half_pi<double>(), 48);
    half.front().x = half.back().x = 0;
    return revolved(half, 96, false);
}

TriangleMesh torus(double tube) {
    std::vector<glm::dvec2> circle = arc({1, 0}, tube, 0, 2 * glm::pi<double>(), 32);
    circle.pop_back();
    return revolved(circle, 96, true);
}

TriangleMesh cylinder(double height) {
    const glm::dvec2 profile[] = {{0, -height / 2}, {1, -height / 2}, {1, height / 2}, {0, height / 2}};
    return revolved(profile, 96, false);
}

TriangleMesh prism(double x, double y) {
    const double corner = glm::root_two<double>();
    const glm::dvec2 profile[] = {{0, -1}, {corner, -1}, {corner, 1}, {0, 1}};
    TriangleMesh mesh = revolved(profile, 4, false);
    for (glm::vec3& p : mesh.positions) p = {p.x * x, p.y * y, p.z};
    return mesh;
}

}  // namespace dfield::cutting
