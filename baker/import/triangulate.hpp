// Polygons in space to triangles, by ear clipping on the plane that the polygon faces most.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace dfield {

// Appends exactly corners.size() - 2 triangles (none below 3 corners), each of three indices into `corners`,
// wound as the polygon is. Concave polygons, collinear runs and repeated points (a hole joined by a seam)
// come out right for simple, roughly planar polygons; where the outline crosses itself the triangles still
// number n - 2, and some may lack area. Positions are finite. Time grows with corners x reflex corners.
void triangulate(std::span<const glm::vec3> corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace dfield
