// A mesh in the space where its bounding sphere is the unit sphere: where everything is baked.
#pragma once

#include "baker/bounding_sphere.hpp"
#include "baker/mesh.hpp"

namespace dfield {

// Positions and triangles only; vertices that nothing uses stay.
inline TriangleMesh unit_mesh(const TriangleMesh& mesh, const BoundingSphere& sphere) {
    TriangleMesh unit;
    unit.triangles = mesh.triangles;
    unit.positions.reserve(mesh.positions.size());
    const glm::dvec3 centre(sphere.centre);
    for (const glm::vec3& position : mesh.positions)
        unit.positions.emplace_back((glm::dvec3(position) - centre) / static_cast<double>(sphere.radius));
    return unit;
}

}  // namespace dfield
