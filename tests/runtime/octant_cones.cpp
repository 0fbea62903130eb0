// The octants' terms under any axes, and a ball's occlusion, against quadrature.
#include "octants/octant_cones.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>

#include "tests/random.hpp"
#include "volume/octant_geometry.hpp"

using namespace dfield::runtime;
using dfield::test::Random;

namespace {

// Calls add(direction, solid angle) for directions over the whole sphere.
template<class Add>
void over_sphere(const Add& add) {
    constexpr int kSteps = 300;
    for (int i = 0; i < 2 * kSteps; ++i)
        for (int j = 0; j < 4 * kSteps; ++j) {
            const double z = -1 + (i + 0.5) / kSteps, angle = glm::pi<double>() * (j + 0.5) / (2 * kSteps);
            const double r = std::sqrt(1 - z * z);
            add(glm::dvec3(r * std::cos(angle), r * std::sin(angle), z),
                glm::pi<double>() / (2.0 * kSteps * kSteps));
        }
}

std::vector<glm::dmat3> transforms() {
    Random random(3);
    const glm::dmat3 rotation = random.rotation();
    const glm::dmat3 stretched(glm::dvec3(3, 0, 0), glm::dvec3(0, 0.5, 0), glm::dvec3(0, 0, 1));
    const glm::dmat3 mirrored(glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1));
    const glm::dmat3 sheared(glm::dvec3(1, 0, 0), glm::dvec3(0.8, 1, 0), glm::dvec3(0, -0.5, 1));
    return {glm::dmat3(1), rotation,           rotation * stretched,
            mirrored,      rotation * sheared, stretched * rotation * mirrored};
}

}  // namespace

TEST_CASE("An octant's term is the integral over its directions, whatever the transform") {
    Random random(7);
    for (const glm::dmat3& m : transforms()) {
        const OctantCones cones{glm::mat3(m)};
        const glm::dmat3 inverse = glm::inverse(m);
        std::vector<glm::dvec3> normals{{0, 0, 1}, {1, 0, 0}, glm::normalize(m[0]), glm::normalize(-m[1])};
        for (int i = 0; i < 6; ++i) normals.emplace_back(random.direction());
        for (const glm::dvec3& n : normals) {
            std::array<double, kOctantCount> expected{};
            over_sphere([&](const glm::dvec3& w, double angle) {
                const glm::dvec3 object = inverse * w;
                const auto octant =
                    static_cast<std::size_t>((object.x > 0) | (object.y > 0) << 1 | (object.z > 0) << 2);
                expected[octant] += std::max(glm::dot(n, w), 0.0) * angle;
            });
            const auto terms = octant_terms(cones, glm::vec3(n));
            double sum = 0;
            for (std::size_t s = 0; s < kOctantCount; ++s) {
                CHECK(terms[s] == Approx(expected[s]).margin(4e-3));
                CHECK(terms[s] >= 0);
                sum += terms[s];
            }
            CHECK(sum == Approx(glm::pi<double>()).epsilon(1e-5));
        }
    }
}

TEST_CASE("At right angles the terms are equation 5's") {
    Random random(8);
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 n(random.direction());
        const auto terms = octant_terms(OctantCones(glm::mat3(1)), n);
        const auto expected = volume::octant_geometry(n);
        for (std::size_t s = 0; s < kOctantCount; ++s) CHECK(terms[s] == Approx(expected[s]).margin(1e-5));
    }
}

TEST_CASE("A ball hides its form factor, also where the horizon cuts it") {
    for (const double sine : {0.1, 0.5, 0.9, 1.0})
        for (const double cosine : {-1.0, -0.6, -0.05, 0.0, 0.3, 0.7, 1.0}) {
            const glm::dvec3 n(0, 0, 1), way(std::sqrt(1 - cosine * cosine), 0, cosine);
            const double rim = std::sqrt(1 - sine * sine);
            double expected = 0;
            over_sphere([&](const glm::dvec3& w, double angle) {
                if (glm::dot(w, way) > rim) expected += std::max(glm::dot(n, w), 0.0) * angle;
            });
            CHECK(ball_occlusion(static_cast<float>(sine), static_cast<float>(cosine)) ==
                  Approx(expected / glm::pi<double>()).margin(4e-3));
        }
    CHECK(ball_occlusion(0.3f, -0.31f) == 0);  // wholly below
    CHECK(ball_occlusion(0, 1) == 0);
}
