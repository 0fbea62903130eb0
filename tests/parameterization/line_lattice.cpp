#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "format/line_table.hpp"
#include "tests/random.hpp"

using namespace dfield;
using dfield::test::Random;

namespace {

double angle(const glm::vec3& a, const glm::vec3& b) {
    const glm::dvec3 p = glm::normalize(glm::dvec3(a)), q = glm::normalize(glm::dvec3(b));
    return std::atan2(glm::length(glm::cross(p, q)), glm::dot(p, q));
}

// Solid angles of the lattice's cells, by counting an even spiral of points; in shares of the mean.
std::vector<double> cell_areas(std::uint32_t lattice, std::uint32_t points_a_cell) {
    const std::uint32_t cells = lattice_point_count(lattice), count = cells * points_a_cell;
    std::vector<double> areas(cells);
    for (std::uint32_t i = 0; i < count; ++i) {
        const double z = 1 - (2.0 * i + 1) / count, phi = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
        areas[nearest_lattice_point(lattice, {r * std::cos(phi), r * std::sin(phi), z})] +=
            1.0 / points_a_cell;
    }
    return areas;
}

}  // namespace

TEST_CASE("Lattice points are unit vectors, each in its own cell, and distinct") {
    for (const std::uint32_t lattice : {2u, 3u, 4u, 16u, 24u, 33u, 128u}) {
        const std::vector<glm::vec3> points = lattice_points(lattice);
        REQUIRE(points.size() == lattice * lattice);
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            if (std::fabs(glm::length(glm::dvec3(points[i])) - 1) > 2e-7) FAIL(i << ": not unit");
            if (nearest_lattice_point(lattice, points[i]) != i)
                FAIL(lattice << ": the point of cell " << i << " is in cell "
                             << nearest_lattice_point(lattice, points[i]));
        }
    }
}

TEST_CASE("The lattice's points are where FORMAT.md says: signs, rows, the folded half") {
    // 2 x 2 cells, one a quarter of the square: their middles lie on the diagonals, at z = 0.
    const float diagonal = std::sqrt(0.5f);
    CHECK(angle(lattice_point(2, 0), {-diagonal, -diagonal, 0}) < 1e-6);
    CHECK(angle(lattice_point(2, 1), {diagonal, -diagonal, 0}) < 1e-6);
    CHECK(angle(lattice_point(2, 2), {-diagonal, diagonal, 0}) < 1e-6);
    CHECK(angle(lattice_point(2, 3), {diagonal, diagonal, 0}) < 1e-6);
    CHECK(angle(lattice_point(3, 4), {0, 0, 1}) < 1e-6);           // the middle of the square
    CHECK(angle(lattice_point(3, 0, {0, 0}), {0, 0, -1}) < 1e-6);  // its corners
    CHECK(angle(lattice_point(3, 8, {1, 1}), {0, 0, -1}) < 1e-6);
    CHECK(angle(lattice_point(3, 5, {1, 0.5}), {1, 0, 0}) < 1e-6);  // the middles of its edges
    CHECK(angle(lattice_point(3, 1, {0.5, 0}), {0, -1, 0}) < 1e-6);
}

TEST_CASE("Cells have nearly equal areas, and no point is far from its cell's") {
    const std::vector<double> areas = cell_areas(24, 1000);
    const auto [smallest, largest] = std::minmax_element(areas.begin(), areas.end());
    INFO("smallest " << *smallest << ", largest " << *largest << " of the mean");
    CHECK(*smallest > 0.96);
    CHECK(*largest < 1.03);

    Random random(1);
    for (const std::uint32_t lattice : {8u, 33u, 100u}) {
        double farthest = 0;
        for (int i = 0; i < 20000; ++i) {
            const glm::vec3 q(random.direction());
            farthest =
                std::max(farthest, angle(q, lattice_point(lattice, nearest_lattice_point(lattice, q))));
        }
        // Square cells of equal area would have half diagonals of sqrt(4 pi / s^2) / sqrt 2 = 2.5 / s.
        INFO("farthest " << farthest * lattice << " / s");
        CHECK(farthest < 4.4 / lattice);
    }
}

TEST_CASE("The four neighbours of a point lie around it, across the square's edges too, and share it") {
    Random random(2);
    for (const std::uint32_t lattice : {2u, 3u, 16u, 33u})
        for (int i = 0; i < 20000; ++i) {
            glm::dvec3 q = random.direction();
            if (i % 2 == 0) q.z = -std::fabs(q.z) - (i % 4 == 0 ? 3 : 0);  // the folded half, and its pole
            q = glm::normalize(q);
            const LatticeNeighbours neighbours = lattice_neighbours(lattice, glm::vec3(q));
            float sum = 0, largest = 0;
            for (int k = 0; k < 4; ++k) {
                REQUIRE(neighbours.points[k] < lattice_point_count(lattice));
                REQUIRE(neighbours.shares[k] >= 0);
                sum += neighbours.shares[k];
                largest = std::max(largest, neighbours.shares[k]);
                if (lattice >= 16 && neighbours.shares[k] > 0)
                    REQUIRE(angle(q, lattice_point(lattice, neighbours.points[k])) < 8.5 / lattice);
            }
            REQUIRE(std::fabs(sum - 1) < 1e-5f);
            float nearest = 0;  // in the middle of an edge a point is its own neighbour
            for (int k = 0; k < 4; ++k)
                if (neighbours.points[k] == nearest_lattice_point(lattice, glm::vec3(q)))
                    nearest += neighbours.shares[k];
            REQUIRE(nearest > largest - 1e-5f);
        }
}

TEST_CASE("Coordinates that are no numbers still give a point") {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    for (const glm::vec3& q : {glm::vec3(kNan), glm::vec3(0), glm::vec3(1, kNan, 0),
                               glm::vec3(std::numeric_limits<float>::infinity(), 0, 0)}) {
        CHECK(nearest_lattice_point(24, q) < 576);
        for (const std::uint32_t point : lattice_neighbours(24, q).points) CHECK(point < 576);
    }
}

TEST_CASE("Every pair of points has its bit, one for both orders") {
    LineParameters parameters;
    parameters.lattice = 3;
    std::set<std::uint32_t> seen;
    for (std::uint32_t a = 0; a < 9; ++a)
        for (std::uint32_t b = 0; b < 9; ++b) {
            CHECK(hit_index(a, b) == hit_index(b, a));
            seen.insert(hit_index(a, b));
        }
    CHECK(seen.size() == line_hit_count(parameters));
    CHECK(*seen.rbegin() == line_hit_count(parameters) - 1);
    CHECK(line_hit_words(parameters) == 2);  // 45 bits

    parameters = {};
    CHECK(4 * line_hit_words(parameters) == 20772);  // the default: 576 points
    CHECK(4 * line_depth_words(parameters) == 32768);
}

TEST_CASE("A table's words hold what their rules say") {
    LineTable table;
    table.parameters.lattice = 3;
    table.parameters.depth_lattice = 2;
    table.hits.resize(line_hit_words(table.parameters));
    table.depths.resize(line_depth_words(table.parameters));
    table.hits[1] = 1u << 4;                // bit 36 = 8 * 9 / 2 + 0
    table.depths[0] = 0xau << 4 * (4 + 3);  // value 7 = 1 * 4 + 3
    CHECK(stored_hit(table, 8, 0));
    CHECK(stored_hit(table, 0, 8));
    CHECK_FALSE(stored_hit(table, 8, 1));
    CHECK(stored_depth(table, 1, 3) == 10);
    CHECK(stored_depth(table, 3, 1) == 0);
    CHECK(table.memory_bytes() == 4 * (2 + 2));
}

TEST_CASE("Line parameters beyond the limits are refused with the reason") {
    const auto error = [](auto change) {
        LineParameters parameters;
        change(parameters);
        return line_parameters_error(parameters);
    };
    using Catch::Contains;
    CHECK(line_parameters_error({}).empty());
    CHECK_THAT(error([](auto& p) { p.lattice = 1; }), Contains("line lattice 1 is outside 2..128"));
    CHECK_THAT(error([](auto& p) { p.lattice = 129; }), Contains("outside 2..128"));
    CHECK_THAT(error([](auto& p) { p.depth_bits = 5; }), Contains("5 bits a depth"));
    CHECK_THAT(error([](auto& p) { p.depth_bits = 0; }), Contains("needs 4 or 8 depth bits"));
    CHECK_THAT(error([](auto& p) { p.depth_lattice = 0; }), Contains("depth lattice 0 is outside"));
    CHECK_THAT(error([](auto& p) { p.pivot = p.filtered = true; }), Contains("not both"));
    CHECK_THAT(error([](auto& p) { p.lattice = p.depth_lattice = 128, p.depth_bits = 8; }),
               Contains("bytes, more than the format's"));
    CHECK(error([](auto& p) { p.depth_bits = p.depth_lattice = 0; }).empty());
}
