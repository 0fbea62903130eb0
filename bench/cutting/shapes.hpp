// Closed meshes to clip with, around the z axis.
#pragma once

#include "baker/mesh.hpp"

namespace dfield::cutting {

TriangleMesh unit_sphere();
TriangleMesh torus(double tube);         // radius 1
TriangleMesh cylinder(double height);    // radius 1
TriangleMesh prism(double x, double y);  // half sides, of half height 1

}  // namespace dfield::cutting
