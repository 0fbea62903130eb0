// The frame rule: which tangents go with a normal. FORMAT.md, "Frame rule", is normative.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace dfield {

// Right-handed orthonormal frame: tangent x bitangent = normal.
struct Frame {
    glm::vec3 tangent, bitangent, normal;

    glm::vec3 to_world(const glm::vec3& local) const {
        return tangent * local.x + bitangent * local.y + normal * local.z;
    }
    glm::vec3 to_local(const glm::vec3& world) const {
        return {glm::dot(world, tangent), glm::dot(world, bitangent), glm::dot(world, normal)};
    }
};

// Duff et al., "Building an Orthonormal Basis, Revisited" (JCGT 6(1), 2017), with the sign taken as +1 for
// n.z = -0 too. Continuous on each of the half spheres z >= 0 and z < 0, so neighbouring maps look alike. n
// is unit.
inline Frame frame_of_normal(const glm::vec3& n) {
    const float sign = n.z >= 0 ? 1.0f : -1.0f;
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

}  // namespace dfield
