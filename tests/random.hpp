// Seeded random input for property tests: the same on every run.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <random>

namespace dfield::test {

class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}

    double uniform(double low, double high) { return low + (high - low) * unit_(engine_); }
    std::uint32_t below(std::uint32_t end) { return static_cast<std::uint32_t>(uniform(0, end)); }

    // Uniform on the unit sphere.
    glm::dvec3 direction() {
        const double z = uniform(-1, 1), phi = uniform(0, 6.283185307179586), s = std::sqrt(1 - z * z);
        return {s * std::cos(phi), s * std::sin(phi), z};
    }
    // Cosine-weighted around +z.
    glm::dvec3 cosine_direction() {
        const double r2 = uniform(0, 1), phi = uniform(0, 6.283185307179586);
        return {std::sqrt(r2) * std::cos(phi), std::sqrt(r2) * std::sin(phi), std::sqrt(1 - r2)};
    }
    glm::dmat3 rotation() {
        const glm::dvec3 z = direction();
        glm::dvec3 x = direction();
        x = glm::normalize(x - z * glm::dot(x, z));
        return {x, glm::cross(z, x), z};
    }

  private:
    std::mt19937_64 engine_;
    std::uniform_real_distribution<double> unit_{0.0, 1.0};
};

}  // namespace dfield::test
