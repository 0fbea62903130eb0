// The integrated geometry term of equation 5: how much a surface with normal N faces each octant of the sky.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "volume/grid.hpp"

namespace dfield::runtime::volume {

using OctantTerms = std::array<float, kOctants>;  // by Table 1's sweep that the octant's light comes with

// G_s(N), the integral of max(0, N.w) over octant s, in closed form; sums to pi. N is unit.
OctantTerms octant_geometry(const glm::vec3& normal);
// The integral of |N.w|, for light that shines through (section 4.2); sums to 2 pi.
OctantTerms octant_geometry_through(const glm::vec3& normal);

// The closed form at the nodes of an octahedral map of the normals, blended between them.
class OctantTable {
  public:
    static constexpr std::size_t kNodes = 49;  // an edge; within kError of the closed form
    static constexpr float kError = 0.01f;
    OctantTable();
    // Made on the first call, for all threads: the same answers for one point and for a million.
    static const OctantTable& shared();
    OctantTerms operator()(const glm::vec3& normal) const;

  private:
    std::vector<OctantTerms> nodes_;
};

}  // namespace dfield::runtime::volume
