// Equation 5: closed form and table against quadrature.
#include "volume/octant_geometry.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "tests/random.hpp"

using namespace dfield::runtime::volume;

namespace {

// The octant integrals of f(N.w), on even steps of z and of the angle around it.
template<class Term>
std::array<double, kOctants> quadrature(const glm::dvec3& normal, const Term& term) {
    constexpr int kSteps = 300;
    std::array<double, kOctants> result{};
    for (int i = 0; i < 2 * kSteps; ++i)
        for (int j = 0; j < 4 * kSteps; ++j) {
            const double z = -1 + (i + 0.5) / kSteps, angle = glm::pi<double>() * (j + 0.5) / (2 * kSteps);
            const double r = std::sqrt(1 - z * z);
            const glm::dvec3 w(r * std::cos(angle), r * std::sin(angle), z);
            const auto octant = static_cast<std::size_t>((w.x > 0) | (w.y > 0) << 1 | (w.z > 0) << 2);
            result[octant] += term(glm::dot(normal, w)) * glm::pi<double>() / (2.0 * kSteps * kSteps);
        }
    return result;
}

std::vector<glm::dvec3> normals() {
    dfield::test::Random random(7);
    std::vector<glm::dvec3> result{{0, 0, 1},
                                   {0, -1, 0},
                                   {1, 0, 0},
                                   glm::normalize(glm::dvec3(1, 1, 1)),
                                   glm::normalize(glm::dvec3(-1, 1, 0)),
                                   glm::normalize(glm::dvec3(1, 1e-5, -1e-6))};
    for (int i = 0; i < 24; ++i) result.emplace_back(random.direction());
    return result;
}

}  // namespace

TEST_CASE("G_s(N) in closed form is the octant's integral", "[volume][geometry]") {
    for (const glm::dvec3& n : normals()) {
        const auto front = quadrature(n, [](double c) { return std::max(c, 0.0); });
        const auto both = quadrature(n, [](double c) { return std::abs(c); });
        const OctantTerms g = octant_geometry(glm::vec3(n)), through = octant_geometry_through(glm::vec3(n));
        double sum = 0;
        for (std::size_t s = 0; s < kOctants; ++s) {
            CHECK(g[s] == Approx(front[s]).margin(2e-4));
            CHECK(through[s] == Approx(both[s]).margin(4e-4));
            sum += double{g[s]};
        }
        CHECK(sum == Approx(glm::pi<double>()).epsilon(1e-6));
    }
}

TEST_CASE("The small table of G_s(N) is within its stated error", "[volume][geometry]") {
    const OctantTable table;
    dfield::test::Random random(8);
    float largest = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 n(random.direction());
        const OctantTerms exact = octant_geometry(n), blended = table(n);
        for (std::size_t s = 0; s < kOctants; ++s)
            largest = std::max(largest, std::abs(exact[s] - blended[s]));
    }
    CHECK(largest < OctantTable::kError);
    CHECK(largest > 1e-5f);  // it is a table
}
