// Visibility of receivers by ray casting: the reference that lookups are judged by, and the way in which an
// object's occlusion by itself is baked.
#pragma once

#include <atomic>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "baker/embree_scene.hpp"
#include "baker/mesh.hpp"

namespace dfield {

struct RayVisibilityOptions {
    // Around +z, turned into each receiver's frame by the frame rule, of weight 1 / size; or shared by all
    // receivers, in world space and over the whole sphere, of weight max(0, n.w).
    std::span<const glm::vec3> directions;
    bool shared = false;
    std::span<const float> weights;  // empty; or around +z: one a direction, summing to 1
    float near_distance = 0;         // rays start here
    // Occlusion by distance; empty: any hit counts 1. Otherwise the first hit's distance is handed to it.
    float (*occlusion)(const void* data, float distance) = nullptr;
    const void* occlusion_data = nullptr;
    float max_distance = std::numeric_limits<float>::infinity();
    std::span<const float>
        ground;  // empty, or n.x n.y n.z d: solid ground below n.p = d, as dfield.h states it
    int threads = 0;
    const std::atomic<bool>* cancel = nullptr;  // when set and true: ends early with Error(kInterrupted)
};

// Where rays leave a mesh's own vertices, object space: 1% of the way to the middle of the triangles around,
// since a vertex of a concave edge lies in its neighbours' planes, but not against the normal, which would
// lead into the object, and 1e-4 bounding radii along the normal. Needs normals.
std::vector<glm::vec3> vertex_ray_origins(const TriangleMesh& mesh);

// One value a receiver, 1 = open. Normals are unit; one that no shared direction faces is open.
std::vector<float> ray_visibility(const EmbreeScene& scene, std::span<const glm::vec3> positions,
                                  std::span<const glm::vec3> normals, const RayVisibilityOptions& options);

// (directions + 31) / 32 words a receiver: bit r & 31 of word r >> 5 is 1 when ray r hits anything within
// max_distance, and 0 for a shared direction that the receiver does not face; as the masks of dfield.h, with
// which they combine by OR. Options as above, `occlusion` and `weights` apart, which are not read.
std::vector<std::uint32_t> ray_masks(const EmbreeScene& scene, std::span<const glm::vec3> positions,
                                     std::span<const glm::vec3> normals, const RayVisibilityOptions& options);

// Visibility of a mesh's own vertices past the mesh itself, by `rays` cosine-weighted rays. Vertices start
// 1e-4 of the bounding radius above the surface. A mesh without normals gets angle-weighted ones.
std::vector<float> self_visibility(const TriangleMesh& mesh, std::uint32_t rays, int threads,
                                   const std::atomic<bool>* cancel = nullptr);

}  // namespace dfield
