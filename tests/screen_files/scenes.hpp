// Scenes of a few rectangles.
#pragma once

#include <glm/geometric.hpp>

#include "baker/scene.hpp"

namespace dfield::test {

// corner, corner + a, corner + a + b, corner + b; its front is where a x b points.
inline void add_rectangle(ImportedScene& scene, const glm::vec3& corner, const glm::vec3& a,
                          const glm::vec3& b, const glm::vec3& albedo) {
    SceneMesh mesh;
    mesh.mesh.positions = {corner, corner + a, corner + a + b, corner + b};
    mesh.mesh.normals.assign(4, glm::normalize(glm::cross(a, b)));
    mesh.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.albedo.assign(4, albedo);
    SceneInstance instance;
    instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
    scene.meshes.push_back(mesh);
    scene.instances.push_back(instance);
}

// The ground y = 0 for |x|, |z| <= 50, and with a wall the plane x = 0 above it, facing +x.
inline ImportedScene ground_and_wall(bool wall) {
    ImportedScene scene;
    add_rectangle(scene, {-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, {0.5f, 0.5f, 0.5f});
    if (wall) add_rectangle(scene, {0, 0, 50}, {0, 0, -100}, {0, 50, 0}, {0.9f, 0.2f, 0.1f});
    return scene;
}

}  // namespace dfield::test
