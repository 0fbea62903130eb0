// A small enclosing ellipsoid of a mesh, as the affine map that makes it the unit sphere.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "baker/bounding_sphere.hpp"
#include "baker/mesh.hpp"

namespace dfield {

// x_unit = to_unit * (x - centre). Every vertex that a triangle uses has |x_unit| < 1.
struct UnitMap {
    glm::mat3 to_unit{1};
    glm::vec3 centre{0};
};

// The smallest ellipsoid, up to 0.1% of its volume, that holds the vertices and, so that flat things get a
// thickness, the points 1/16 of the box's longest side from the box's centre along the axes. Khachiyan's
// iteration with away steps (Todd and Yildirim, "On Khachiyan's Algorithm for the Computation of
// Minimum-Volume Enclosing Ellipsoids", 2007), over the few points that matter, found by farthest-point
// pivoting. to_unit is upper triangular: planes z = const stay such. The mesh has an extent.
UnitMap bounding_ellipsoid(const TriangleMesh& mesh);

// The same map for the bounding sphere.
UnitMap unit_map(const BoundingSphere& sphere);

}  // namespace dfield
