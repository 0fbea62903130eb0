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
    std::span<const glm::vec3> directions;  // around +z, each of weight 1 / size, unless `weights` is given
    std::span<const float> weights;         // empty, or one a direction, summing to 1
    float near_distance = 0;                // rays start here
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

// One value a receiver, 1 = open. Directions are turned into the receiver's frame by the frame rule. Normals
// are unit.
std::vector<float> ray_visibility(const EmbreeScene& scene, std::span<const glm::vec3> positions,
                                  std::span<const glm::vec3> normals, const RayVisibilityOptions& options);

// Visibility of a mesh's own vertices past the mesh itself, by `rays` cosine-weighted rays. Vertices start
// 1e-4 of the bounding radius above the surface. A mesh without normals gets angle-weighted ones.
std::vector<float> self_visibility(const TriangleMesh& mesh, std::uint32_t rays, int threads,
                                   const std::atomic<bool>* cancel = nullptr);

}  // namespace dfield
