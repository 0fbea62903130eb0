#include "baker/bounding_sphere.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

namespace dfield {
namespace {

struct Ball {
    glm::dvec3 centre{0};
    double squared_radius = -1;  // below 0: empty

    double excess(const glm::dvec3& p) const { return glm::dot(p - centre, p - centre) - squared_radius; }
};

// The ball with up to four points on its surface and its centre in their affine hull. False when the last
// point depends on the others (four points on a circle, three on a line): it then adds nothing.
bool ball_through(const std::array<glm::dvec3, 4>& points, int count, Ball& ball) {
    if (count == 0) {
        ball = {};
        return true;
    }
    // centre = p0 + sum x_i e_i with 2 e_i . (centre - p0) = e_i . e_i; Cramer-free elimination of at most 3
    // x 3.
    const int unknowns = count - 1;
    std::array<glm::dvec3, 3> edge;
    double a[3][4] = {};
    for (int i = 0; i < unknowns; ++i) edge[i] = points[i + 1] - points[0];
    for (int i = 0; i < unknowns; ++i) {
        for (int j = 0; j < unknowns; ++j) a[i][j] = 2 * glm::dot(edge[i], edge[j]);
        a[i][unknowns] = glm::dot(edge[i], edge[i]);
    }
    for (int i = 0; i < unknowns; ++i) {  // symmetric positive definite unless dependent: no pivoting needed
        if (!(a[i][i] > 1e-12 * 2 * glm::dot(edge[i], edge[i]))) return false;
        for (int row = i + 1; row < unknowns; ++row) {
            const double factor = a[row][i] / a[i][i];
            for (int column = i; column <= unknowns; ++column) a[row][column] -= factor * a[i][column];
        }
    }
    glm::dvec3 offset{0};
    double x[3] = {};
    for (int i = unknowns; i-- > 0;) {
        x[i] = a[i][unknowns];
        for (int j = i + 1; j < unknowns; ++j) x[i] -= a[i][j] * x[j];
        x[i] /= a[i][i];
        offset += x[i] * edge[i];
    }
    ball = {points[0] + offset, glm::dot(offset, offset)};
    return true;
}

// Welzl: the smallest ball of points[0, end) with the `count` support points on its surface.
Ball welzl(std::vector<glm::dvec3>& points, std::size_t end, std::array<glm::dvec3, 4>& support, int count,
           double tolerance) {
    Ball ball;
    ball_through(support, count, ball);
    if (count == 4) return ball;
    for (std::size_t i = 0; i < end; ++i) {
        if (ball.squared_radius >= 0 && ball.excess(points[i]) <= tolerance) continue;
        support[count] = points[i];
        Ball probe;
        if (!ball_through(support, count + 1, probe)) continue;
        ball = welzl(points, i, support, count + 1, tolerance);
        std::rotate(points.begin(), points.begin() + i, points.begin() + i + 1);
    }
    return ball;
}

}  // namespace

BoundingSphere smallest_enclosing_ball(const TriangleMesh& mesh) {
    const glm::dvec3 middle(triangle_bounds(mesh).centre());
    const double extent = glm::length(glm::dvec3(triangle_bounds(mesh).size()));
    const double tolerance = 1e-14 * extent * extent;

    // Around the middle of the box, so that large coordinates do not cost digits.
    const auto for_each_vertex = [&](auto&& visit) {
        for (const glm::uvec3& triangle : mesh.triangles)
            for (int corner = 0; corner < 3; ++corner)
                visit(glm::dvec3(mesh.positions[triangle[corner]]) - middle);
    };
    const auto farthest = [&](const glm::dvec3& from) {
        glm::dvec3 best{0};
        double best_square = -1;
        for_each_vertex([&](const glm::dvec3& p) {
            const double square = glm::dot(p - from, p - from);
            if (square > best_square) best = p, best_square = square;
        });
        return best;
    };

    std::vector<glm::dvec3> active{farthest({0, 0, 0})};
    std::array<glm::dvec3, 4> support;
    Ball ball = welzl(active, active.size(), support, 0, tolerance);
    // Every pivot enlarges the ball; it ends after about ten on real meshes. The bound is for rounding's
    // sake.
    for (int pivot = 0; pivot < 1000; ++pivot) {
        const glm::dvec3 outside = farthest(ball.centre);
        if (ball.excess(outside) <= tolerance) break;
        active.insert(active.begin(), outside);
        const Ball larger = welzl(active, active.size(), support, 0, tolerance);
        if (larger.squared_radius <= ball.squared_radius) break;
        ball = larger;
    }

    BoundingSphere sphere;
    sphere.centre = glm::vec3(ball.centre + middle);
    const glm::dvec3 centre = glm::dvec3(sphere.centre) - middle;
    const double radius = glm::length(farthest(centre) - centre);
    sphere.radius = static_cast<float>(radius);
    if (sphere.radius < radius)
        sphere.radius = std::nextafter(sphere.radius, std::numeric_limits<float>::infinity());
    return sphere;
}

}  // namespace dfield
