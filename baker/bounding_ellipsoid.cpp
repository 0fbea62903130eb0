#include "baker/bounding_ellipsoid.hpp"

#include <algorithm>
#include <cmath>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>
#include <vector>

namespace dfield {
namespace {

constexpr double kTolerance = 1e-3;      // excess of the farthest point's squared distance
constexpr double kThickness = 1.0 / 16;  // least half thickness, in longest sides of the box

struct Ellipsoid {
    glm::dmat3 shape{0};  // (x - centre)^T shape (x - centre) <= 1
    glm::dvec3 centre{0};

    double square(const glm::dvec3& x) const { return glm::dot(x - centre, shape * (x - centre)); }
};

// The smallest ellipsoid of some points: weights on them whose moments are the ellipsoid's, moved towards the
// farthest point or away from the nearest one of those that carry weight, whichever is farther from its due.
// `weights` is where the last round ended, which is a good start.
Ellipsoid smallest_ellipsoid(const std::vector<glm::dvec3>& points, std::vector<double>& weights) {
    constexpr double kLifted = 4;  // dimensions of (x, 1)
    for (int step = 0; step < 10000; ++step) {
        glm::dmat4 moments(0);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const glm::dvec4 q(points[i], 1);
            moments += weights[i] * glm::outerProduct(q, q);
        }
        const glm::dmat4 inverse = glm::inverse(moments);
        std::size_t far = 0, near = 0;
        double farthest = -1, nearest = 1e300;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const glm::dvec4 q(points[i], 1);
            const double distance = glm::dot(q, inverse * q);
            if (distance > farthest) farthest = distance, far = i;
            if (weights[i] > 0 && distance < nearest) nearest = distance, near = i;
        }
        if (farthest <= kLifted * (1 + 0.1 * kTolerance)) break;
        const bool towards = farthest - kLifted >= kLifted - nearest;
        const std::size_t i = towards ? far : near;
        const double distance = towards ? farthest : nearest;
        double change = (distance - kLifted) / (kLifted * (distance - 1));
        if (!towards) change = std::max(change, -weights[i] / (1 - weights[i]));
        for (double& weight : weights) weight *= 1 - change;
        weights[i] = std::max(weights[i] + change, 0.0);
    }
    Ellipsoid ellipsoid;
    for (std::size_t i = 0; i < points.size(); ++i) ellipsoid.centre += weights[i] * points[i];
    glm::dmat3 spread(0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 x = points[i] - ellipsoid.centre;
        spread += weights[i] * glm::outerProduct(x, x);
    }
    ellipsoid.shape = glm::inverse(3.0 * spread);
    return ellipsoid;
}

// U with U^T U = m, upper triangular (Cholesky).
glm::dmat3 upper_root(const glm::dmat3& m) {
    glm::dmat3 u(0);
    for (int row = 0; row < 3; ++row)
        for (int column = row; column < 3; ++column) {
            double sum = m[column][row];
            for (int k = 0; k < row; ++k) sum -= u[row][k] * u[column][k];
            u[column][row] = column == row ? std::sqrt(sum) : sum / u[row][row];
        }
    return u;
}

// The map in floats, its scale lowered until it holds every vertex.
UnitMap enclosing(const TriangleMesh& mesh, glm::dmat3 to_unit, const glm::dvec3& centre) {
    UnitMap map{glm::mat3(to_unit), glm::vec3(centre)};
    double largest = 0;
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner) {
            const glm::dvec3 x =
                to_unit * (glm::dvec3(mesh.positions[triangle[corner]]) - glm::dvec3(map.centre));
            largest = std::max(largest, glm::dot(x, x));
        }
    map.to_unit = glm::mat3(to_unit * ((1 - 1e-6) / std::sqrt(largest)));
    return map;
}

}  // namespace

UnitMap bounding_ellipsoid(const TriangleMesh& mesh) {
    const Bounds bounds = triangle_bounds(mesh);
    const glm::dvec3 middle(bounds.centre()), size(bounds.size());
    const double scale = std::max({size.x, size.y, size.z});
    const auto reduced = [&](std::uint32_t vertex) {
        return (glm::dvec3(mesh.positions[vertex]) - middle) / scale;
    };

    std::vector<glm::dvec3> points;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-kThickness, kThickness}) {
            points.emplace_back(0);
            points.back()[axis] = side;
        }
    std::vector<double> weights(points.size(), 1.0 / static_cast<double>(points.size()));
    Ellipsoid ellipsoid;
    // Every round enlarges the ellipsoid; it ends after some tens. The bound is for rounding's sake.
    for (int round = 0; round < 1000; ++round) {
        ellipsoid = smallest_ellipsoid(points, weights);
        glm::dvec3 outside(0);
        double farthest = 0;
        for (const glm::uvec3& triangle : mesh.triangles)
            for (int corner = 0; corner < 3; ++corner) {
                const glm::dvec3 x = reduced(triangle[corner]);
                const double square = ellipsoid.square(x);
                if (square > farthest) farthest = square, outside = x;
            }
        if (farthest <= 1 + kTolerance) break;
        points.push_back(outside);
        weights.push_back(0);
    }
    return enclosing(mesh, upper_root(ellipsoid.shape) / scale, middle + scale * ellipsoid.centre);
}

UnitMap unit_map(const BoundingSphere& sphere) {
    return {glm::mat3(1 / sphere.radius), sphere.centre};
}

}  // namespace dfield
