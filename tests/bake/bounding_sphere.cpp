#include "baker/bounding_sphere.hpp"

#include <catch2/catch.hpp>

#include "baker/scene.hpp"
#include "tests/random.hpp"
#include "tests/shapes.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using dfield::test::Random;

namespace {

// Triangles over all points, three at a time, so that every point is used.
TriangleMesh cloud(const std::vector<glm::vec3>& points) {
    TriangleMesh mesh;
    mesh.positions = points;
    const auto n = static_cast<unsigned>(points.size());
    for (unsigned i = 0; i < n; ++i) mesh.triangles.emplace_back(i, (i + 1) % n, (i + 2) % n);
    return mesh;
}

// The smallest radius over all balls through two, three or four points that hold every point.
double brute_force_radius(const std::vector<glm::vec3>& points) {
    const auto holds_all = [&](const glm::dvec3& centre, double radius) {
        for (const glm::vec3& p : points)
            if (glm::distance(glm::dvec3(p), centre) > radius * (1 + 1e-9)) return false;
        return true;
    };
    double best = 1e300;
    const auto consider = [&](const glm::dvec3& centre, const glm::dvec3& on) {
        const double radius = glm::distance(centre, on);
        if (radius < best && holds_all(centre, radius)) best = radius;
    };
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j) {
            const glm::dvec3 a(points[i]), b(points[j]);
            consider(0.5 * (a + b), a);
            for (std::size_t k = j + 1; k < n; ++k) {
                const glm::dvec3 c(points[k]), u = b - a, v = c - a, w = glm::cross(u, v);
                const double w2 = glm::dot(w, w);
                if (w2 < 1e-18) continue;
                const glm::dvec3 centre =
                    a + (glm::dot(u, u) * glm::cross(v, w) + glm::dot(v, v) * glm::cross(w, u)) / (2 * w2);
                consider(centre, a);
                for (std::size_t l = k + 1; l < n; ++l) {
                    // The centre moves along w until d is as far as a.
                    const glm::dvec3 d(points[l]);
                    const double along = glm::dot(d - a, w);
                    if (std::fabs(along) < 1e-12) continue;
                    const double t =
                        (glm::dot(d - centre, d - centre) - glm::dot(a - centre, a - centre)) / (2 * along);
                    consider(centre + t * w, a);
                }
            }
        }
    return best;
}

double largest_distance(const TriangleMesh& mesh, const glm::vec3& centre) {
    double largest = 0;
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner)
            largest = std::max(
                largest, glm::distance(glm::dvec3(mesh.positions[triangle[corner]]), glm::dvec3(centre)));
    return largest;
}

}  // namespace

TEST_CASE("The ball of a cube is its circumscribed ball") {
    const BoundingSphere ball = smallest_enclosing_ball(test::box_mesh({-1, -1, -1}, {1, 1, 1}));
    CHECK(glm::length(ball.centre) < 1e-6f);
    CHECK(ball.radius == Approx(std::sqrt(3.0)).epsilon(1e-6));
}

TEST_CASE("The ball is the smallest one, by brute force") {
    Random random(11);
    for (int trial = 0; trial < 60; ++trial) {
        std::vector<glm::vec3> points;
        const int count = 3 + trial % 14;
        for (int i = 0; i < count; ++i)
            points.emplace_back(random.uniform(-1, 1) * 3, random.uniform(-1, 1),
                                random.uniform(-1, 1) * 0.3);
        const BoundingSphere ball = smallest_enclosing_ball(cloud(points));
        CHECK(ball.radius == Approx(brute_force_radius(points)).epsilon(1e-5));
        CHECK(largest_distance(cloud(points), ball.centre) <= ball.radius);
    }
}

TEST_CASE("Degenerate clouds: a plane, a line, equal points, cospherical points") {
    Random random(12);
    std::vector<glm::vec3> plane, line, equal(5, {2, 3, 4}), sphere;
    for (int i = 0; i < 200; ++i) {
        plane.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1), 5);
        line.emplace_back(i, 2 * i, -i);
        sphere.emplace_back(random.direction());
    }
    for (const auto& points : {plane, line, sphere}) {
        const TriangleMesh mesh = cloud(points);
        const BoundingSphere ball = smallest_enclosing_ball(mesh);
        const double reach = largest_distance(mesh, ball.centre);
        CHECK(reach <= ball.radius);
        CHECK(ball.radius <= reach * (1 + 1e-6));
    }
    CHECK(smallest_enclosing_ball(cloud(line)).radius == Approx(0.5 * 199 * std::sqrt(6.0)).epsilon(1e-6));
    CHECK(smallest_enclosing_ball(cloud(sphere)).radius <= 1.000001f);
    CHECK(smallest_enclosing_ball(cloud(equal)).radius == 0);
}

TEST_CASE("Vertices that no triangle uses do not count, and far-off meshes keep their digits") {
    TriangleMesh mesh = test::box_mesh({1000, 1000, 1000}, {1001, 1001, 1001});
    mesh.positions.emplace_back(1e6f, 0, 0);
    const BoundingSphere ball = smallest_enclosing_ball(mesh);
    CHECK(ball.radius == Approx(std::sqrt(3.0) / 2).epsilon(1e-4));
}

TEST_CASE("The bunny's ball is smaller than its box's ball and holds every vertex") {
    const auto path = test::shared_file("models/stanford-bunny.obj");
    if (!path) return;
    const TriangleMesh mesh = flatten_scene(import_scene(*path));
    const BoundingSphere ball = smallest_enclosing_ball(mesh);
    CHECK(largest_distance(mesh, ball.centre) <= ball.radius);
    CHECK(ball.radius < 0.95f * 0.5f * glm::length(triangle_bounds(mesh).size()));
}
