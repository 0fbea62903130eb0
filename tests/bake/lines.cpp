#include <array>
#include <atomic>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>

#include "baker/bake_lines.hpp"
#include "baker/bounding_ellipsoid.hpp"
#include "baker/error.hpp"
#include "baker/scene.hpp"
#include "tests/random.hpp"
#include "tests/shapes.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using dfield::test::Random;

namespace {

// A table in the unit sphere, whatever the mesh's own bounding sphere is.
LineTable bake(const TriangleMesh& mesh, std::uint32_t lattice, std::uint32_t depth_bits,
               std::uint32_t depth_lattice, int threads = 2) {
    LineBakeOptions options;
    options.parameters = {lattice, depth_bits, depth_lattice, false, false, false};
    options.threads = threads;
    return bake_lines(mesh, BoundingSphere{glm::vec3(0), 1}, options);
}

// Where the chord from a to b is within something convex, in shares of its length; empty where it is not.
struct Inside {
    double enter, leave;
    bool empty() const { return !(enter < leave); }
};

Inside inside_box(const glm::dvec3& half, const glm::dvec3& a, const glm::dvec3& b) {
    Inside inside{0, 1};
    for (int axis = 0; axis < 3; ++axis) {
        const double s = (-half[axis] - a[axis]) / (b[axis] - a[axis]),
                     t = (half[axis] - a[axis]) / (b[axis] - a[axis]);
        inside.enter = std::max(inside.enter, std::min(s, t));
        inside.leave = std::min(inside.leave, std::max(s, t));
    }
    return inside;
}

bool same(const LineTable& a, const LineTable& b) {
    return a.parameters == b.parameters && a.to_unit == b.to_unit && a.centre == b.centre &&
           std::equal(a.hits.begin(), a.hits.end(), b.hits.begin(), b.hits.end()) &&
           std::equal(a.depths.begin(), a.depths.end(), b.depths.begin(), b.depths.end());
}

// Largest and smallest distance of a mesh's vertices from the middle of a unit map's sphere.
std::pair<double, double> reach(const TriangleMesh& mesh, const UnitMap& map) {
    double farthest = 0, nearest = 1e300;
    for (const glm::vec3& position : mesh.positions) {
        const double distance = glm::length(glm::dmat3(map.to_unit) * glm::dvec3(position - map.centre));
        farthest = std::max(farthest, distance);
        nearest = std::min(nearest, distance);
    }
    return {farthest, nearest};
}

}  // namespace

TEST_CASE("Bits of a ball are a chord's distance from its centre") {
    constexpr double kRadius = 0.5;
    const LineTable table = bake(test::sphere_mesh({0, 0, 0}, kRadius, 64), 12, 0, 0);
    const auto points = lattice_points(12);
    int hits = 0, misses = 0;
    for (std::uint32_t a = 0; a < points.size(); ++a)
        for (std::uint32_t b = 0; b < a; ++b) {
            const double distance = 0.5 * glm::length(glm::dvec3(points[a]) + glm::dvec3(points[b]));
            // The mesh's faces lie up to 1.3e-3 within the ball.
            if (std::fabs(distance - kRadius) < 2e-3) continue;
            if (stored_hit(table, a, b) != (distance < kRadius)) FAIL(a << ' ' << b << ": " << distance);
            ++(distance < kRadius ? hits : misses);
        }
    CHECK(hits > 2000);  // a chord between even points of the sphere is within r of the centre with 1 - r^2
    CHECK(misses > 2000);
    for (std::uint32_t a = 0; a < points.size(); ++a) CHECK_FALSE(stored_hit(table, a, a));
}

TEST_CASE("Bits and depths of a box are what the slabs say") {
    const glm::vec3 half(0.5f, 0.3f, 0.2f);
    for (const std::uint32_t bits : {4u, 8u}) {
        const LineTable table = bake(test::box_mesh(-half, half), 10, bits, 9);
        const auto hit_points = lattice_points(10);
        for (std::uint32_t a = 0; a < hit_points.size(); ++a)
            for (std::uint32_t b = 0; b < a; ++b) {
                const Inside inside = inside_box(half, hit_points[a], hit_points[b]);
                if (std::fabs(inside.leave - inside.enter) < 1e-5) continue;
                if (stored_hit(table, a, b) == inside.empty()) FAIL(a << ' ' << b);
            }

        const auto points = lattice_points(9);
        const double steps = (1 << bits) - 2;
        int exact = 0, borrowed = 0;
        for (std::uint32_t a = 0; a < points.size(); ++a)
            for (std::uint32_t b = 0; b < points.size(); ++b) {
                const Inside inside = inside_box(half, points[a], points[b]);
                if (a == b || std::fabs(inside.leave - inside.enter) < 1e-5) continue;
                const std::uint32_t last = stored_depth(table, a, b), first = stored_depth(table, b, a);
                if (inside.empty()) {  // 0, or a depth from somewhere else in the cells
                    borrowed += last != 0;
                    continue;
                }
                if (last == 0 || std::fabs((last - 1) / steps - inside.leave) > 0.5 / steps + 1e-5)
                    FAIL(a << ' ' << b << ": last hit " << last << ", not at " << inside.leave);
                if (first == 0 || std::fabs(1 - (first - 1) / steps - inside.enter) > 0.5 / steps + 1e-5)
                    FAIL(a << ' ' << b << ": first hit " << first << ", not at " << inside.enter);
                ++exact;
            }
        CHECK(exact > 1000);
        CHECK(borrowed > 50);
    }
}

TEST_CASE("A depth is known wherever a finer table may see a hit") {
    const LineTable table = bake(test::sphere_mesh({0.2f, -0.1f, 0.3f}, 0.4f, 48), 24, 4, 8);
    Random random(3);
    int hits = 0, unknown = 0;
    for (int i = 0; i < 50000; ++i) {
        const glm::vec3 p(random.direction()), q(random.direction());
        if (!stored_hit(table, nearest_lattice_point(24, p), nearest_lattice_point(24, q))) continue;
        ++hits;
        unknown += stored_depth(table, nearest_lattice_point(8, p), nearest_lattice_point(8, q)) == 0;
    }
    INFO(unknown << " of " << hits << " hits without a depth");
    CHECK(hits > 5000);
    CHECK(unknown < hits / 30);
}

TEST_CASE("Line tables do not depend on the number of threads") {
    TriangleMesh mesh = test::box_mesh({-0.3f, -0.2f, -0.4f}, {0.1f, 0.2f, 0.2f});
    test::append(mesh, test::sphere_mesh({0.4f, 0.2f, 0.1f}, 0.3f, 24));
    const LineTable one = bake(mesh, 17, 4, 9, 1);
    for (const int threads : {2, 3, 7}) CHECK(same(one, bake(mesh, 17, 4, 9, threads)));
}

TEST_CASE("The table's space is the bounding sphere's or the bounding ellipsoid's") {
    TriangleMesh mesh = test::box_mesh({10, 20, 30}, {11, 24, 32});
    const BoundingSphere sphere = smallest_enclosing_ball(mesh);
    LineBakeOptions options;
    options.parameters = {8, 0, 0, false, false, false};
    const LineTable in_sphere = bake_lines(mesh, sphere, options);
    CHECK(in_sphere.centre == sphere.centre);
    CHECK(in_sphere.to_unit == glm::mat3(1 / sphere.radius));

    options.parameters.ellipsoid = true;
    LineBakeReport report;
    const LineTable in_ellipsoid = bake_lines(mesh, sphere, options, &report);
    CHECK(report.rays == line_hit_count(options.parameters));
    // The smallest ellipsoid of a box has its proportions: semi-axes sqrt(3) times its half sides.
    for (int axis = 0; axis < 3; ++axis) {
        const double side = std::array{1.0, 4.0, 2.0}[axis];
        CHECK(in_ellipsoid.to_unit[axis][axis] == Approx(2 / (side * std::sqrt(3.0))).epsilon(2e-3));
        CHECK(in_ellipsoid.centre[axis] == Approx(sphere.centre[axis]).margin(2e-3));
    }
    // More of the chords of the tighter space meet the object.
    const auto count = [](const LineTable& table) {
        std::size_t bits = 0;
        for (const std::uint32_t word : table.hits) bits += static_cast<std::size_t>(std::popcount(word));
        return bits;
    };
    CHECK(count(in_ellipsoid) > 1.3 * count(in_sphere));
}

TEST_CASE("The bounding ellipsoid of an ellipsoid is that ellipsoid") {
    Random random(4);
    for (int i = 0; i < 5; ++i) {
        const glm::dmat3 rotation = random.rotation();
        const glm::dvec3 axes(3, random.uniform(1, 3), random.uniform(0.5, 1)), centre(5, -3, 40);
        TriangleMesh mesh = test::sphere_mesh({0, 0, 0}, 1, 32);
        for (glm::vec3& p : mesh.positions) p = centre + rotation * (axes * glm::dvec3(p));
        const UnitMap map = bounding_ellipsoid(mesh);
        const auto [farthest, nearest] = reach(mesh, map);
        CHECK(farthest < 1);
        CHECK(nearest > 0.99);
        const double volume = 1 / glm::determinant(glm::dmat3(map.to_unit));
        CHECK(volume == Approx(axes.x * axes.y * axes.z).epsilon(0.01));
    }
}

TEST_CASE("Sheets, needles and far objects get an ellipsoid that holds them") {
    const auto check = [](const TriangleMesh& mesh) {
        const UnitMap map = bounding_ellipsoid(mesh);
        CHECK(reach(mesh, map).first < 1);
        CHECK(reach(mesh, map).first > 0.999);
        for (int column = 0; column < 3; ++column) {
            CHECK(map.to_unit[column][column] > 0);
            for (int row = column + 1; row < 3; ++row) CHECK(map.to_unit[column][row] == 0);
        }
        return map;
    };
    const UnitMap sheet = check(test::box_mesh({-2, -2, 0}, {2, 2, 0}));
    CHECK(1 / sheet.to_unit[2][2] > 0.2);  // a sixteenth of the longest side, and not flatter
    CHECK(1 / sheet.to_unit[2][2] < 0.6);
    check(test::box_mesh({-5, 0, 0}, {5, 0, 0}));
    check(test::box_mesh({1e5f, 1e5f, 1e5f}, {1e5f + 3, 1e5f + 1, 1e5f + 2}));
    check(test::box_mesh({-1e-20f, -2e-20f, 0}, {1e-20f, 1e-20f, 1e-20f}));
    check(test::box_mesh({-1e15f, -2e15f, 0}, {1e15f, 1e15f, 1e15f}));
}

TEST_CASE("Real models fit into ellipsoids smaller than their spheres") {
    for (const char* name :
         {"models/stanford-bunny.obj", "models/mountain_open.obj", "models/lemon_tree.obj"}) {
        const auto path = test::shared_file(name);
        if (!path) continue;
        const TriangleMesh mesh = flatten_scene(import_scene(*path));
        const UnitMap map = bounding_ellipsoid(mesh);
        CHECK(reach(mesh, map).first < 1);
        const double volume = 1 / glm::determinant(glm::dmat3(map.to_unit)),
                     ball = std::pow(smallest_enclosing_ball(mesh).radius, 3);
        INFO(name << ": " << volume / ball << " of the sphere's volume");
        CHECK(volume < 0.9 * ball);
    }
}

TEST_CASE("A bake of lines refuses bad parameters and can be interrupted") {
    const TriangleMesh mesh = test::box_mesh({-1, -1, -1}, {1, 1, 1});
    LineBakeOptions options;
    options.parameters.lattice = 200;
    CHECK_THROWS_AS(bake_lines(mesh, smallest_enclosing_ball(mesh), options), InputError);
    const std::atomic<bool> cancel{true};
    options.parameters.lattice = 8;
    options.cancel = &cancel;
    try {
        bake_lines(mesh, smallest_enclosing_ball(mesh), options);
        FAIL("not interrupted");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::kInterrupted);
    }
}
