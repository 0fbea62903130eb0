// The same surface with more triangles.
#pragma once

#include "baker/mesh.hpp"

namespace dfield::paper {

// Every triangle into four by the midpoints of its edges, which neighbours share. Without normals.
TriangleMesh subdivided(const TriangleMesh& mesh);

}  // namespace dfield::paper
