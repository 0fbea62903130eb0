// The paper's test scene: three mutually perpendicular planes behind a caster.
#pragma once

#include "baker/mesh.hpp"

namespace dfield::cli {

inline constexpr unsigned kCornerVertices = 33;  // along one side of a plane

// Three planes of 33 x 33 vertices, with side 2 x the longest side of the caster's box, facing its positive
// octant. `gap` is the distance from the box to each plane, in longest sides: 0.1 for scene `corner`, 0 for
// `corner-contact`. Vertices are not shared between planes, so that each plane keeps its normal: 3267 of
// them.
TriangleMesh corner_room(const Bounds& caster, float gap);

}  // namespace dfield::cli
