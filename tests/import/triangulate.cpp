#include "baker/import/triangulate.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Polygon = std::vector<glm::vec3>;

Triangles triangulated(const Polygon& polygon) {
    Triangles triangles;
    dfield::triangulate(polygon, triangles);
    return triangles;
}

double signed_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    return 0.5 * ((double(b.x) - a.x) * (double(c.y) - a.y) - (double(b.y) - a.y) * (double(c.x) - a.x));
}

double polygon_area(const Polygon& p) {
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += signed_area(glm::vec3(0), p[i], p[(i + 1) % p.size()]);
    return sum;
}

bool inside(const Polygon& p, double x, double y) {
    bool in = false;
    for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++)
        if ((p[i].y > y) != (p[j].y > y) && x < (p[j].x - p[i].x) * (y - p[i].y) / (p[j].y - p[i].y) + p[i].x)
            in = !in;
    return in;
}

// For a counter-clockwise polygon in z = 0: n - 2 triangles, none turned over, together as large as the
// polygon, and each one's centre inside. Equal areas without overturned triangles leave no room for overlaps
// or gaps.
void check_flat(const Polygon& polygon) {
    const Triangles triangles = triangulated(polygon);
    REQUIRE(triangles.size() == polygon.size() - 2);
    double sum = 0;
    for (const auto& t : triangles) {
        const double part = signed_area(polygon[t[0]], polygon[t[1]], polygon[t[2]]);
        CHECK(part >= 0);
        sum += part;
        const glm::vec3 centre = (polygon[t[0]] + polygon[t[1]] + polygon[t[2]]) / 3.0f;
        if (part > 1e-9) CHECK(inside(polygon, centre.x, centre.y));
    }
    CHECK(sum == Approx(polygon_area(polygon)).epsilon(1e-9));
}

}  // namespace

TEST_CASE("a convex polygon becomes the fan around its first corner") {
    CHECK(triangulated({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}) == Triangles{{0, 1, 2}, {0, 2, 3}});
    CHECK(triangulated({{0, 0, 0}, {1, 0, 0}}).empty());
    CHECK(triangulated({}).empty());
}

TEST_CASE("concave polygons are covered exactly") {
    check_flat({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}});             // notch
    check_flat({{2, 1, 0}, {0, 4, 0}, {0, 0, 0}, {4, 0, 0}, {4, 4, 0}});             // starting at the notch
    check_flat({{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}});  // L
    check_flat(
        {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 2, 0}, {2, 2, 0}, {2, 1, 0}, {0, 1, 0}});  // C
    Polygon spiral;
    for (int i = 0; i <= 60; ++i) {
        const float t = 0.25f * static_cast<float>(i);
        spiral.push_back((1 + t) * glm::vec3(std::cos(t), std::sin(t), 0));
    }
    for (int i = 60; i >= 0; --i) {
        const float t = 0.25f * static_cast<float>(i);
        spiral.push_back((0.5f + t) * glm::vec3(std::cos(t), std::sin(t), 0));
    }
    check_flat(spiral);
}

TEST_CASE("random star-shaped polygons are covered exactly") {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> radius(0.2f, 2.0f);
    for (int round = 0; round < 300; ++round) {
        Polygon polygon;
        const int n = 4 + round % 40;
        for (int i = 0; i < n; ++i) {
            const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(n);
            polygon.push_back(radius(random) * glm::vec3(std::cos(angle), std::sin(angle), 0));
        }
        check_flat(polygon);
    }
}

TEST_CASE("collinear runs and repeated points do not disturb") {
    check_flat({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}});
    check_flat({{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2, 2, 0}, {0, 2, 0}});
    // A square with a square hole, joined by a seam that is walked twice.
    check_flat({{0, 0, 0},
                {4, 0, 0},
                {4, 4, 0},
                {0, 4, 0},
                {0, 0, 0},
                {1, 1, 0},
                {1, 3, 0},
                {3, 3, 0},
                {3, 1, 0},
                {1, 1, 0}});
}

TEST_CASE("polygons lie anywhere in space and keep their winding") {
    const Polygon flat = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}};
    std::mt19937 random(11);
    std::normal_distribution<float> normal;
    for (int round = 0; round < 50; ++round) {
        const glm::quat turn =
            glm::normalize(glm::quat(normal(random), normal(random), normal(random), normal(random)));
        Polygon polygon;
        for (const glm::vec3& p : flat) polygon.push_back(turn * p + glm::vec3(100, -50, 30));
        const glm::vec3 up = turn * glm::vec3(0, 0, 1);
        const Triangles triangles = triangulated(polygon);
        REQUIRE(triangles.size() == 3);
        double sum = 0;
        for (const auto& t : triangles)
            sum +=
                0.5 * glm::dot(up, glm::cross(polygon[t[1]] - polygon[t[0]], polygon[t[2]] - polygon[t[0]]));
        CHECK(sum == Approx(10).epsilon(1e-3));
    }
}

TEST_CASE("outlines that cross themselves or collapse still give n - 2 triangles") {
    CHECK(triangulated({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size() == 2);
    CHECK(triangulated({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}).size() == 3);
    CHECK(triangulated(Polygon(6, glm::vec3(1, 2, 3))).size() == 4);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> any(-1, 1);
    for (int round = 0; round < 200; ++round) {
        Polygon polygon(static_cast<std::size_t>(3 + round % 20));
        for (glm::vec3& p : polygon) p = {any(random), any(random), any(random)};
        CHECK(triangulated(polygon).size() == polygon.size() - 2);
    }
}
