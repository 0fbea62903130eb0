// Distances from points to a mesh, and which points of a grid lie inside it: Embree's closest-point queries
// and rays.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "baker/embree_scene.hpp"
#include "baker/mesh.hpp"

namespace dfield {

struct NearestPoint {
    glm::vec3 point{0};  // on the mesh
    float distance;      // `range` where nothing is nearer
};

// `scene` holds `mesh` alone, as it is.
NearestPoint nearest_point(const EmbreeScene& scene, const TriangleMesh& mesh, const glm::vec3& point,
                           float range);

// Samples at origin + (x, y, z) * spacing, x fastest.
struct SampleGrid {
    std::array<std::uint32_t, 3> dims{};
    glm::vec3 origin{0};
    float spacing = 0;

    std::size_t size() const { return std::size_t{dims[0]} * dims[1] * dims[2]; }
    glm::vec3 point(std::size_t i) const {
        return origin + spacing * glm::vec3(i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]);
    }
};

// A byte a sample, 1 inside. On the lines along x, y and z through it, surfaces count 1 where they are
// entered and -1 where they are left; a sample is inside where the counts up to it are not 0 on any of the
// three lines, and each line as a whole sums to 0. So nested and overlapping closed surfaces, whichever way
// round, have insides; what is open along some axis has none, nor has a soup of triangles that face anyhow.
// `scene` lets contexts filter (RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION).
std::vector<std::uint8_t> samples_inside(const EmbreeScene& scene, const TriangleMesh& mesh,
                                         const SampleGrid& grid, int threads,
                                         const std::atomic<bool>* cancel = nullptr);

}  // namespace dfield
