#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/output/gltf_output.hpp"
#include "baker/output/occlusion_values.hpp"

namespace dfield {
namespace {

template<class T>
void append(std::vector<std::byte>& bytes, const T& value) {
    const auto* begin = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), begin, begin + sizeof value);
}

std::string header(std::size_t vertices, std::size_t faces) {
    std::string text =
        "ply\nformat binary_little_endian 1.0\ncomment visibility per vertex, 1 = open\nelement vertex " +
        std::to_string(vertices) + "\n";
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "quality"})
        text += std::string("property float ") + name + "\n";
    for (const char* name : {"red", "green", "blue"}) text += std::string("property uchar ") + name + "\n";
    return text + "element face " + std::to_string(faces) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
}

}  // namespace

void write_ply_occlusion(const std::filesystem::path& output, const ImportedScene& scene,
                         std::span<const std::vector<float>> visibility) {
    check_visibility(scene, visibility);
    std::size_t vertex_count = 0, face_count = 0;
    for (const SceneInstance& instance : scene.instances) {
        vertex_count += scene.meshes[instance.mesh].mesh.positions.size();
        face_count += scene.meshes[instance.mesh].mesh.triangles.size();
    }
    if (vertex_count > INT32_MAX)
        throw OutputError(output.string() +
                          ": more than 2^31 vertices do not fit into a PLY; write .glb, which shares "
                          "meshes between nodes");

    const std::string text = header(vertex_count, face_count);
    const auto text_bytes = std::as_bytes(std::span(text));
    std::vector<std::byte> bytes(text_bytes.begin(), text_bytes.end());
    bytes.reserve(bytes.size() + 31 * vertex_count + 13 * face_count);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const glm::mat4& transform = scene.instances[i].transform;
        const TriangleMesh& mesh = scene.meshes[scene.instances[i].mesh].mesh;
        const glm::mat3 normals = normal_matrix(transform);
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
            append(bytes, glm::vec3(transform * glm::vec4(mesh.positions[v], 1)));
            append(bytes,
                   mesh.normals.empty() ? glm::vec3(0, 0, 1) : glm::normalize(normals * mesh.normals[v]));
            append(bytes, visibility[i][v]);
            const auto grey = static_cast<std::uint8_t>(std::lround(255.0f * visibility[i][v]));
            for (int c = 0; c < 3; ++c) append(bytes, grey);
        }
    }
    std::int32_t first = 0;
    for (const SceneInstance& instance : scene.instances) {
        const TriangleMesh& mesh = scene.meshes[instance.mesh].mesh;
        // A mirrored instance would show its inside without the other winding.
        const bool mirrored = glm::determinant(glm::mat3(instance.transform)) < 0;
        for (glm::ivec3 triangle : mesh.triangles) {
            if (mirrored) std::swap(triangle.y, triangle.z);
            append(bytes, std::uint8_t{3});
            append(bytes, triangle + first);
        }
        first += static_cast<std::int32_t>(mesh.positions.size());
    }
    write_file_atomic(output, bytes);
}

}  // namespace dfield
