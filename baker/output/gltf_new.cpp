// write_new_glb_occlusion: a glTF document from nothing but the scene.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <optional>

#include "baker/output/gltf_output.hpp"
#include "baker/output/gltf_patch.hpp"
#include "baker/output/occlusion_values.hpp"

namespace dfield {
namespace {

struct MeshAccessors {
    std::size_t position = 0, indices = 0;
    std::optional<std::size_t> normal;
};

std::size_t append_vectors(GltfPatch& document, std::span<const glm::vec3> vectors) {
    return document.append_accessor(std::as_bytes(vectors), kGltfFloat, "VEC3", vectors.size(),
                                    kGltfArrayBuffer);
}

MeshAccessors append_mesh(GltfPatch& document, const TriangleMesh& mesh) {
    MeshAccessors result;
    result.position = append_vectors(document, mesh.positions);
    glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
    for (const glm::vec3& position : mesh.positions)
        low = glm::min(low, position), high = glm::max(high, position);
    Json& accessor =
        document.entry("accessors", result.position);  // glTF asks for the bounds of positions alone
    accessor["min"] = {low.x, low.y, low.z};
    accessor["max"] = {high.x, high.y, high.z};
    if (!mesh.normals.empty()) result.normal = append_vectors(document, mesh.normals);
    result.indices = document.append_accessor(std::as_bytes(std::span(mesh.triangles)), kGltfUnsignedInt,
                                              "SCALAR", 3 * mesh.triangles.size(), kGltfElementArrayBuffer);
    return result;
}

// glTF forbids matrices that are no product of translation, rotation and scale: those with oblique axes.
bool has_oblique_axes(const glm::mat4& transform) {
    for (int i = 0; i < 3; ++i) {
        const glm::vec3 a(transform[i]), b(transform[(i + 1) % 3]);
        if (std::abs(glm::dot(a, b)) > 1e-5f * glm::length(a) * glm::length(b)) return true;
    }
    return false;
}

TriangleMesh transformed(const TriangleMesh& mesh, const glm::mat4& transform) {
    TriangleMesh result = mesh;
    const glm::mat3 normals = normal_matrix(transform);
    for (glm::vec3& position : result.positions) position = glm::vec3(transform * glm::vec4(position, 1));
    for (glm::vec3& normal : result.normals) normal = glm::normalize(normals * normal);
    if (glm::determinant(glm::mat3(transform)) < 0)
        for (glm::uvec3& triangle : result.triangles) std::swap(triangle.y, triangle.z);
    return result;
}

}  // namespace

void write_new_glb_occlusion(const std::filesystem::path& output, const ImportedScene& scene,
                             std::span<const std::vector<float>> visibility,
                             const OcclusionOutputOptions& options) {
    check_visibility(scene, visibility);
    GltfPatch document;
    // The meshes may be open or inside-out, so both sides show.
    document.append("materials", {{"name", "default"},
                                  {"doubleSided", true},
                                  {"pbrMetallicRoughness",
                                   Json::object({{"metallicFactor", 0}, {"roughnessFactor", 1}})}});
    std::map<std::uint32_t, MeshAccessors> shared;
    Json roots = Json::array();
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const SceneInstance& instance = scene.instances[i];
        const SceneMesh& source = scene.meshes[instance.mesh];
        if (source.mesh.triangles.empty()) continue;  // glTF has no empty accessors
        const bool oblique = has_oblique_axes(instance.transform);
        MeshAccessors accessors;
        if (oblique) {
            accessors = append_mesh(document, transformed(source.mesh, instance.transform));
        } else {
            auto [entry, is_new] = shared.try_emplace(instance.mesh);
            if (is_new) entry->second = append_mesh(document, source.mesh);
            accessors = entry->second;
        }
        Json attributes = Json::object({{"POSITION", accessors.position}});
        if (accessors.normal) attributes["NORMAL"] = *accessors.normal;
        attributes["_OCCLUSION"] =
            document.append_accessor(std::as_bytes(std::span(visibility[i])), kGltfFloat, "SCALAR",
                                     visibility[i].size(), kGltfArrayBuffer);
        if (options.color) attributes["COLOR_0"] = append_grey_colors(document, visibility[i]);
        Json primitive = Json::object(
            {{"attributes", std::move(attributes)}, {"indices", accessors.indices}, {"material", 0}});
        Json mesh = Json::object({{"primitives", Json::array({std::move(primitive)})}});
        if (!source.name.empty()) mesh["name"] = source.name;
        Json node = Json::object({{"mesh", document.append("meshes", std::move(mesh))}});
        if (!instance.name.empty()) node["name"] = instance.name;
        if (!oblique && instance.transform != glm::mat4(1)) {
            Json& matrix = node["matrix"] = Json::array();
            for (int column = 0; column < 4; ++column)
                for (int row = 0; row < 4; ++row) matrix.push_back(instance.transform[column][row]);
        }
        roots.push_back(document.append("nodes", std::move(node)));
    }
    document.append("scenes", Json::object({{"nodes", std::move(roots)}}));
    document.json["scene"] = 0;
    document.write(output);
}

}  // namespace dfield
