// What an object hides of its own vertices, as masks over directions that all receivers share: united with
// the masks of what others hide (by OR) they give exactly the visibility past both.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "baker/embree_scene.hpp"
#include "baker/mesh.hpp"

namespace dfield::cli {

// Of one mesh, by ray casting.
class SelfMasks {
  public:
    // For so many instances of the mesh, which must have normals and outlive this. A few instances are cast
    // one by one. For more it pays to cast kObjectDirections once in object space; an instance's directions
    // then take the nearest of them.
    SelfMasks(const TriangleMesh& mesh, std::size_t instances, int threads);

    // (directions + 31) / 32 words a vertex, as ray_masks() states them, for an instance with this invertible
    // transform. Directions: world space, unit.
    std::vector<std::uint32_t> of_instance(const glm::mat4& object_to_world,
                                           std::span<const glm::vec3> directions);

    static constexpr std::uint32_t kObjectDirections = 2048;

  private:
    std::vector<std::uint32_t> cast(std::span<const glm::vec3> directions) const;

    const TriangleMesh& mesh_;
    std::size_t instances_;
    int threads_;
    EmbreeScene scene_{EmbreeUse::kFast};
    std::vector<glm::vec3> origins_;
    std::vector<glm::vec3> object_directions_;  // empty until wanted
    std::vector<std::uint32_t> object_masks_;
};

}  // namespace dfield::cli
