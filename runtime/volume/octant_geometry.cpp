#include "volume/octant_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "format/octahedral.hpp"

namespace dfield::runtime::volume {
namespace {

// The integral of N.w over the part of the octant x > 0, y, z < 0 where it is positive, N = (a, b, c) >= 0: a
// spherical triangle with one corner on the x axis, cut off by the great circle of N. Lambert's sum over its
// edges, of arc times (N . the edge's inward normal) / 2.
float corner_beyond(float a, float b, float c) {
    const float along_circle = std::atan2(a, b * c);
    const float in_xy = std::atan2(a, b), in_xz = std::atan2(a, c);
    return 0.5f * (along_circle - c * in_xy - b * in_xz);
}

}  // namespace

OctantTerms octant_geometry(const glm::vec3& normal) {
    const glm::vec3 n = glm::abs(normal);
    // An octant in which N.w has one sign throughout has pi / 4 a component.
    const float quarter = glm::pi<float>() / 4, all = quarter * (n.x + n.y + n.z);
    const float corner[3] = {corner_beyond(n.x, n.y, n.z), corner_beyond(n.y, n.x, n.z),
                             corner_beyond(n.z, n.x, n.y)};
    OctantTerms terms;
    for (std::size_t s = 0; s < kOctants; ++s) {
        // The axes on which the octant lies on the other side of the origin than N.
        bool opposite[3];
        for (int axis = 0; axis < 3; ++axis) {
            const bool octant_positive = (s >> axis & 1) != 0;  // light of sweep +1 comes from below
            opposite[axis] = octant_positive != (normal[axis] >= 0);
        }
        switch (opposite[0] + opposite[1] + opposite[2]) {
            case 0:
                terms[s] = all;
                break;
            case 1: {  // G(N) = G(-N) + the integral of N.w over the octant
                const int axis = opposite[0] ? 0 : opposite[1] ? 1 : 2;
                terms[s] = corner[axis] + all - 2 * quarter * n[axis];
                break;
            }
            case 2:
                terms[s] = corner[!opposite[0] ? 0 : !opposite[1] ? 1 : 2];
                break;
            default:
                terms[s] = 0;
        }
    }
    return terms;
}

OctantTerms octant_geometry_through(const glm::vec3& normal) {
    OctantTerms front = octant_geometry(normal);
    const OctantTerms back = octant_geometry(-normal);
    for (std::size_t s = 0; s < kOctants; ++s) front[s] += back[s];
    return front;
}

OctantTable::OctantTable() {
    nodes_.reserve(kNodes * kNodes);
    constexpr float kStep = 2.0f / (kNodes - 1);
    for (std::size_t j = 0; j < kNodes; ++j)
        for (std::size_t i = 0; i < kNodes; ++i)
            nodes_.push_back(octant_geometry(octahedral_direction(
                {-1 + static_cast<float>(i) * kStep, -1 + static_cast<float>(j) * kStep})));
}

const OctantTable& OctantTable::shared() {
    static const OctantTable table;
    return table;
}

OctantTerms OctantTable::operator()(const glm::vec3& normal) const {
    const glm::vec2 at = (octahedral_place(normal) + 1.0f) * (0.5f * (kNodes - 1));
    const glm::vec2 low = glm::clamp(glm::floor(at), glm::vec2(0), glm::vec2(kNodes - 2)), f = at - low;
    const OctantTerms* const node =
        &nodes_[static_cast<std::size_t>(low.y) * kNodes + static_cast<std::size_t>(low.x)];
    OctantTerms terms;
    for (std::size_t s = 0; s < kOctants; ++s)
        terms[s] = (1 - f.y) * ((1 - f.x) * node[0][s] + f.x * node[1][s]) +
                   f.y * ((1 - f.x) * node[kNodes][s] + f.x * node[kNodes + 1][s]);
    return terms;
}

}  // namespace dfield::runtime::volume
