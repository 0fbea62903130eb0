// Where a ray meets a triangle that Embree found.
#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "baker/mesh.hpp"

namespace dfield {

// t of the ray's meeting with the triangle's plane, in double and in a fixed order of operations: Embree
// decides which triangle a ray hits first, but its distances rest on reciprocal estimates that differ between
// makers of processors. NaN for a ray in the plane.
inline double exact_distance(const TriangleMesh& mesh, std::uint32_t triangle, const glm::vec3& origin,
                             const glm::vec3& direction) {
    const glm::uvec3 corners = mesh.triangles[triangle];
    const glm::dvec3 a(mesh.positions[corners.x]);
    const glm::dvec3 normal =
        glm::cross(glm::dvec3(mesh.positions[corners.y]) - a, glm::dvec3(mesh.positions[corners.z]) - a);
    return glm::dot(a - glm::dvec3(origin), normal) / glm::dot(glm::dvec3(direction), normal);
}

}  // namespace dfield
