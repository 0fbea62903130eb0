#include "baker/output/occlusion_values.hpp"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <stdexcept>

namespace dfield {

void check_visibility(const ImportedScene& scene, std::span<const std::vector<float>> visibility) {
    if (visibility.size() != scene.instances.size())
        throw std::invalid_argument("one array of visibility for each instance is needed");
    for (std::size_t i = 0; i < visibility.size(); ++i) {
        if (visibility[i].size() != scene.meshes[scene.instances[i].mesh].mesh.positions.size())
            throw std::invalid_argument("one visibility for each vertex of the instance is needed");
        if (!std::all_of(visibility[i].begin(), visibility[i].end(),
                         [](float v) { return v >= 0 && v <= 1; }))
            throw std::invalid_argument("visibility is not within 0..1");
    }
}

std::size_t append_colors(GltfPatch& document, std::span<const float> colors) {
    std::vector<std::uint16_t> packed;
    packed.reserve(colors.size());
    for (const float value : colors)
        packed.push_back(static_cast<std::uint16_t>(std::lround(65535.0f * std::clamp(value, 0.0f, 1.0f))));
    const std::size_t accessor = document.append_accessor(
        std::as_bytes(std::span(packed)), kGltfUnsignedShort, "VEC4", colors.size() / 4, kGltfArrayBuffer);
    document.entry("accessors", accessor)["normalized"] = true;
    return accessor;
}

std::size_t append_grey_colors(GltfPatch& document, std::span<const float> visibility) {
    std::vector<float> colors;
    for (const float v : visibility) colors.insert(colors.end(), {v, v, v, 1.0f});
    return append_colors(document, colors);
}

glm::mat3 normal_matrix(const glm::mat4& transform) {
    return glm::transpose(glm::inverse(glm::mat3(transform)));
}

}  // namespace dfield
