// What the writers of per-vertex visibility share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "baker/output/gltf_patch.hpp"
#include "baker/scene.hpp"

namespace dfield {

// One array for each instance, one finite value in 0..1 for each vertex. Throws std::invalid_argument
// otherwise.
void check_visibility(const ImportedScene& scene, std::span<const std::vector<float>> visibility);

// COLOR_0 as RGBA accessor; returns its index. `colors` has four values a vertex, clamped to 0..1 as glTF
// asks. 16-bit normalised, since COLOR_0 is linear and 8 bits would band in the dark.
std::size_t append_colors(GltfPatch& document, std::span<const float> colors);
std::size_t append_grey_colors(GltfPatch& document, std::span<const float> visibility);

// What carries normals (to be normalised) where `transform` carries points.
glm::mat3 normal_matrix(const glm::mat4& transform);

}  // namespace dfield
