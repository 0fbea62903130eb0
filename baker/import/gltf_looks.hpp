// What a glTF file says about looks: base colours of materials, and cameras.
#pragma once

#include <glm/vec3.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "baker/scene.hpp"

namespace dfield {

struct GltfMaterial {
    glm::vec3 base_colour{1};  // linear, 0..1
    bool textured = false;     // has a base colour texture, which multiplies it in viewers
};

struct GltfLooks {
    std::vector<GltfMaterial> materials;  // index = the file's
    std::vector<SceneCamera> cameras;     // index = the file's, not placed
};

// Throws InputError: numbers that are none, fields of view or magnifications out of range, an unknown kind of
// camera.
GltfLooks read_gltf_looks(const std::string& file, const nlohmann::json& document);

}  // namespace dfield
