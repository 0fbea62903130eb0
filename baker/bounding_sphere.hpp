// The smallest enclosing ball of a mesh.
#pragma once

#include <glm/vec3.hpp>

#include "baker/mesh.hpp"

namespace dfield {

struct BoundingSphere {
    glm::vec3 centre{0};
    float radius = 0;
};

// The smallest ball that holds every vertex used by a triangle: Welzl's move-to-front recursion over the few
// points that matter, found by Gaertner's farthest-point pivoting ("Fast and Robust Smallest Enclosing
// Balls", ESA 1999), in double. The radius is rounded up, so no vertex lies outside. The mesh has at least
// one triangle.
BoundingSphere smallest_enclosing_ball(const TriangleMesh& mesh);

}  // namespace dfield
