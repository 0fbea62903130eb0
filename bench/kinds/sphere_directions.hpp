// Directions spread evenly over the whole sphere.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/gtc/constants.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace dfield::kinds {

// Spherical Fibonacci points: equal areas, azimuths a golden angle apart.
inline std::vector<glm::vec3> sphere_directions(std::uint32_t count) {
    std::vector<glm::vec3> directions;
    directions.reserve(count);
    const double golden_angle = glm::pi<double>() * (3 - std::sqrt(5.0));
    for (std::uint32_t i = 0; i < count; ++i) {
        const double z = 1 - (2.0 * i + 1) / count, radius = std::sqrt(1 - z * z);
        directions.emplace_back(radius * std::cos(golden_angle * i), radius * std::sin(golden_angle * i), z);
    }
    return directions;
}

}  // namespace dfield::kinds
