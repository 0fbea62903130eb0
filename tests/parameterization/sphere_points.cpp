#include "format/sphere_points.hpp"

#include <catch2/catch.hpp>
#include <cstdio>
#include <numbers>
#include <set>

#include "tests/random.hpp"

using namespace dfield;
using dfield::test::Random;

namespace {

FieldParameters slater(std::uint32_t n) {
    FieldParameters parameters;
    parameters.subdivision = n;
    return parameters;
}

// The true nearest sample, by looking only at rings (sorted by height) that can hold it.
std::size_t true_nearest(const std::vector<glm::vec3>& points, const glm::vec3& q, double radius) {
    // Slater's points are ordered by descending z, so those within `radius` of q lie in one range.
    const auto first = std::lower_bound(points.begin(), points.end(), q.z + radius,
                                        [](const glm::vec3& p, double z) { return p.z > z; });
    std::size_t best = first - points.begin();
    double best_dot = -2;
    for (auto p = first; p != points.end() && p->z >= q.z - radius; ++p)
        if (const double d = glm::dot(glm::dvec3(*p), glm::dvec3(q)); d > best_dot)
            best_dot = d, best = p - points.begin();
    return best;
}

}  // namespace

TEST_CASE("Sample counts are the paper's, and the equator is stored once") {
    CHECK(paper_position_count(slater(16)) == 1090);
    CHECK(paper_position_count(slater(32)) == 4226);
    CHECK(position_count(slater(16)) == 1026);
    CHECK(position_count(slater(32)) == 4098);
    FieldParameters latlong = slater(16);
    latlong.positions = Positions::kLatlong;
    CHECK(position_count(latlong) == 1122);  // 33 x 34, figure 5
    for (const std::uint32_t n : {1u, 2u, 3u, 7u, 8u, 16u, 32u, 64u}) {
        CHECK(sphere_points(Positions::kSlater, n).size() == position_count(slater(n)));
        latlong.subdivision = n;
        CHECK(sphere_points(Positions::kLatlong, n).size() == position_count(latlong));
    }
}

TEST_CASE("Samples are distinct unit vectors with mirror symmetry") {
    for (const std::uint32_t n : {1u, 5u, 32u}) {
        const auto points = sphere_points(Positions::kSlater, n);
        std::set<std::tuple<float, float, float>> distinct;
        for (const glm::vec3& p : points) {
            CHECK(std::fabs(glm::length(glm::dvec3(p)) - 1) < 2e-7);
            distinct.emplace(p.x, p.y, p.z);
        }
        CHECK(distinct.size() == points.size());
        for (const glm::vec3& p : points) CHECK(distinct.contains({p.x, p.y, p.z == 0 ? p.z : -p.z}));
    }
}

TEST_CASE("The inverse of every sample is itself") {
    for (const Positions positions : {Positions::kSlater, Positions::kLatlong})
        for (const std::uint32_t n : {1u, 2u, 3u, 8u, 16u, 32u, 33u, 64u, 256u}) {
            const auto points = sphere_points(positions, n);
            std::size_t wrong = 0;
            for (std::uint32_t i = 0; i < points.size(); ++i)
                wrong += nearest_sphere_point(positions, n, points.data(), points[i]) != i;
            CHECK(wrong == 0);
        }
}

TEST_CASE("A million random points find the nearest sample or one hardly further") {
    Random random(1);
    for (const std::uint32_t n : {8u, 32u}) {
        const auto points = sphere_points(Positions::kSlater, n);
        const double radius = 3.0 / n;  // beyond the covering radius, tested below
        std::size_t missed = 0;
        double worst = 1;
        for (int i = 0; i < 500000; ++i) {
            const glm::vec3 q = random.direction();
            const std::size_t best = true_nearest(points, q, radius);
            const std::uint32_t found = nearest_slater({n}, points.data(), q);
            REQUIRE(found < points.size());
            if (found == best) continue;
            ++missed;
            worst = std::max(worst, static_cast<double>(glm::distance(points[found], q)) /
                                        static_cast<double>(glm::distance(points[best], q)));
        }
        std::printf(
            "slater n=%u: %.4f%% of points get another sample than the nearest, at most %.4f x as far\n", n,
            missed / 5000.0, worst);
        CHECK(missed < 50);
        CHECK(worst < 1.001);
    }
}

TEST_CASE("Latitude-longitude cells give a sample within 1.1 of the nearest distance") {
    Random random(2);
    const std::uint32_t n = 8;
    const auto points = sphere_points(Positions::kLatlong, n);
    double worst = 1;
    for (int i = 0; i < 100000; ++i) {
        const glm::vec3 q = random.direction();
        float best = 4;
        for (const glm::vec3& p : points) best = std::min(best, glm::distance(p, q));
        const float found = glm::distance(points[nearest_latlong({n}, q)], q);
        if (best > 1e-4f) worst = std::max(worst, static_cast<double>(found / best));
    }
    std::printf("latlong n=%u: at most %.3f x as far as the nearest\n", n, worst);
    CHECK(worst < 1.1);
}

TEST_CASE("Cells are even: area by counting, covering radius, mean distance") {
    struct Evenness {
        double smallest, largest, covering, rms;
    };
    const auto measure = [](Positions positions, std::uint32_t n) {
        const auto points = sphere_points(positions, n);
        std::vector<double> hits(points.size());
        Random random(3);
        const int samples = 400 * static_cast<int>(points.size());
        double covering = 0, squares = 0;
        for (int i = 0; i < samples; ++i) {
            const glm::vec3 q = random.direction();
            const std::uint32_t found = nearest_sphere_point(positions, n, points.data(), q);
            ++hits[found];
            const double d = glm::distance(points[found], q);
            covering = std::max(covering, d);
            squares += d * d / samples;
        }
        const auto [low, high] = std::minmax_element(hits.begin(), hits.end());
        const double count = static_cast<double>(points.size());
        // In units of the mean cell: areas relative to 4 pi / count, distances to 1 / sqrt(count).
        return Evenness{*low / 400, *high / 400, covering * std::sqrt(count), std::sqrt(squares * count)};
    };
    for (const std::uint32_t n : {8u, 16u, 32u}) {
        const Evenness even = measure(Positions::kSlater, n);
        std::printf(
            "slater n=%2u: cells %.2f..%.2f of the mean area, covering radius %.2f / sqrt(count), "
            "rms distance %.3f / sqrt(count)\n",
            n, even.smallest, even.largest, even.covering, even.rms);
        CHECK(even.smallest > 0.5);
        CHECK(even.largest < 1.25);
        CHECK(even.covering < 2.6);
        CHECK(even.rms < 1.46);  // a hexagonal lattice has 1.4288
    }
    const Evenness uneven = measure(Positions::kLatlong, 16);
    std::printf(
        "latlong n=16: cells %.2f..%.2f of the mean area, covering radius %.2f / sqrt(count), rms distance "
        "%.3f\n",
        uneven.smallest, uneven.largest, uneven.covering, uneven.rms);
    CHECK(uneven.largest / uneven.smallest > 5);  // why the paper takes Slater's layout
}

TEST_CASE("Points that rounding pushed off the sphere or onto a border stay in range") {
    for (const Positions positions : {Positions::kSlater, Positions::kLatlong})
        for (const std::uint32_t n : {1u, 2u, 32u}) {
            const auto points = sphere_points(positions, n);
            for (const float scale : {0.999999f, 1.0f, 1.000001f})
                for (int axis = 0; axis < 27; ++axis) {
                    glm::vec3 q(axis % 3 - 1, axis / 3 % 3 - 1, axis / 9 - 1);
                    if (glm::length(q) == 0) continue;
                    q = glm::normalize(q) * scale;
                    CHECK(nearest_sphere_point(positions, n, points.data(), q) < points.size());
                }
        }
}

TEST_CASE("The polynomial angle is within its stated error") {
    double worst = 0;
    for (int i = 0; i <= 100000; ++i) {
        const double angle = 2 * std::numbers::pi * i / 100000;
        const double turns =
            quarter_turns(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
        const double exact = angle / (std::numbers::pi / 2);
        worst = std::max(worst, std::min(std::fabs(turns - exact), 4 - std::fabs(turns - exact)));
    }
    CHECK(worst < 2e-6);
}
