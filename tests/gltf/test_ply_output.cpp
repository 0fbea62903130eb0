#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <string>

#include "baker/file_io.hpp"
#include "baker/output/gltf_output.hpp"
#include "tests/gltf/gltf_reader.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using namespace dfield::test;
namespace fs = std::filesystem;

namespace {

// The tests' own view of one vertex record, 31 bytes.
struct Vertex {
    float position[3], normal[3], quality;
    unsigned char grey[3];
};

}  // namespace

TEST_CASE("a PLY holds all instances in world space with quality and greys") {
    const fs::path folder = scratch("ply");
    const ImportedScene scene = import_scene(source_file("models/scene_instances.glb"));
    const auto visibility = test_visibility(scene);
    write_ply_occlusion(folder / "scene.ply", scene, visibility);
    const std::vector<std::byte> bytes = read_file(folder / "scene.ply");
    const std::string text(reinterpret_cast<const char*>(bytes.data()),
                           std::min<std::size_t>(bytes.size(), 600));
    const std::size_t body = text.find("end_header\n") + 11;
    std::size_t vertices = 0, faces = 0;
    for (const SceneInstance& instance : scene.instances) {
        vertices += scene.meshes[instance.mesh].mesh.positions.size();
        faces += scene.meshes[instance.mesh].mesh.triangles.size();
    }
    CHECK(text.find("format binary_little_endian 1.0\n") != std::string::npos);
    CHECK(text.find("element vertex " + std::to_string(vertices) + "\n") != std::string::npos);
    CHECK(text.find("element face " + std::to_string(faces) + "\n") != std::string::npos);
    CHECK(text.find("property float quality\n") != std::string::npos);
    REQUIRE(bytes.size() == body + 31 * vertices + 13 * faces);

    std::size_t offset = body;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const TriangleMesh& mesh = scene.meshes[scene.instances[i].mesh].mesh;
        for (std::size_t v = 0; v < mesh.positions.size(); ++v, offset += 31) {
            Vertex vertex;
            std::memcpy(&vertex, &bytes[offset], 31);
            const glm::vec3 expected(scene.instances[i].transform * glm::vec4(mesh.positions[v], 1));
            REQUIRE(glm::distance(expected, glm::vec3(vertex.position[0], vertex.position[1],
                                                      vertex.position[2])) < 1e-5f);
            REQUIRE(vertex.quality == visibility[i][v]);
            REQUIRE(std::abs(vertex.grey[0] - 255 * visibility[i][v]) <= 0.5001f);
            REQUIRE(vertex.grey[1] == vertex.grey[0]);
            REQUIRE(vertex.grey[2] == vertex.grey[0]);
        }
    }
}

TEST_CASE("our own importer reads the PLY, with faces and normals on the same side") {
    const fs::path folder = scratch("ply again");
    ImportedScene scene = import_scene(source_file("models/scene_instances.glb"));
    // Cubes only: faceted, so that every vertex normal is its face's.
    std::erase_if(scene.instances,
                  [&](const SceneInstance& i) { return scene.meshes[i.mesh].name != "cube_with_hole"; });
    REQUIRE(scene.instances.size() == 5);
    write_ply_occlusion(folder / "cubes.ply", scene, test_visibility(scene));
    const ImportedScene again = import_scene(folder / "cubes.ply");
    const TriangleMesh& mesh = again.meshes[0].mesh;
    CHECK(again.report.triangles == 5 * 32);
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 face =
            glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
        for (int corner = 0; corner < 3; ++corner) {
            REQUIRE(glm::length(mesh.normals[t[corner]]) == Approx(1).margin(1e-5));
            REQUIRE(glm::dot(glm::normalize(face), mesh.normals[t[corner]]) > 0.999f);
        }
    }
}
