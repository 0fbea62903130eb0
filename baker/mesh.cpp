#include "baker/mesh.hpp"

#include <glm/common.hpp>
#include <limits>

#include "baker/hash.hpp"

namespace dfield {

static_assert(sizeof(glm::vec3) == 12 && sizeof(glm::uvec3) == 12,
              "arrays are hashed as packed 32-bit words");

Bounds triangle_bounds(const TriangleMesh& mesh) {
    Bounds bounds{glm::vec3(std::numeric_limits<float>::max()),
                  glm::vec3(std::numeric_limits<float>::lowest())};
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner) {
            bounds.min = glm::min(bounds.min, mesh.positions[triangle[corner]]);
            bounds.max = glm::max(bounds.max, mesh.positions[triangle[corner]]);
        }
    return bounds;
}

std::string mesh_hash(const TriangleMesh& mesh) {
    // The counts come first so that no mesh's bytes can pass for another's with the border elsewhere.
    const std::uint64_t counts[2] = {mesh.positions.size(), mesh.triangles.size()};
    return ContentHash()
        .add(counts, sizeof counts)
        .add(mesh.positions.data(), mesh.positions.size() * sizeof(glm::vec3))
        .add(mesh.triangles.data(), mesh.triangles.size() * sizeof(glm::uvec3))
        .hex();
}

}  // namespace dfield
