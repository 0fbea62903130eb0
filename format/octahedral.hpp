// The octahedral map: unit vectors on the square [-1, 1]^2, which is the octahedron |x| + |y| + |z| = 1 with
// its lower half, z < 0, unfolded outwards. Both ways take any thread.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace dfield {

// `direction` has any length but 0.
inline glm::vec2 octahedral_place(const glm::vec3& direction) {
    const glm::vec3 p =
        direction / (std::fabs(direction.x) + std::fabs(direction.y) + std::fabs(direction.z));
    if (p.z >= 0) return {p.x, p.y};
    return {std::copysign(1 - std::fabs(p.y), p.x), std::copysign(1 - std::fabs(p.x), p.y)};
}

inline glm::vec3 octahedral_direction(const glm::vec2& place) {
    glm::vec3 p(place.x, place.y, 1 - std::fabs(place.x) - std::fabs(place.y));
    if (p.z < 0) {
        p.x = std::copysign(1 - std::fabs(place.y), place.x);
        p.y = std::copysign(1 - std::fabs(place.x), place.y);
    }
    return glm::normalize(p);
}

}  // namespace dfield
