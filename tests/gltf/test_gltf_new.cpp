#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "baker/output/gltf_output.hpp"
#include "tests/gltf/gltf_reader.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using namespace dfield::test;
namespace fs = std::filesystem;

TEST_CASE("a new GLB from an OBJ holds its geometry, normals and visibility") {
    const fs::path folder = scratch("new");
    ImportedScene scene = import_scene(source_file("models/cube_with_hole.obj"));
    const glm::mat4 mirrored = glm::scale(glm::translate(glm::mat4(1), {3, 0, 0}), {-1, 2, 0.5f});
    const glm::mat4 sheared = glm::scale(glm::mat4(1), {1, 3, 1}) *
                              glm::rotate(glm::mat4(1), 0.7f, glm::vec3(1, 2, 0)) *
                              glm::scale(glm::mat4(1), {-1, 1, 1});
    scene.instances.push_back({.mesh = 0, .transform = mirrored, .name = "mirrored"});
    scene.instances.push_back({.mesh = 0, .transform = sheared, .name = "sheared"});
    std::vector<std::vector<float>> visibility;
    for (std::size_t i = 0; i < 3; ++i) {
        visibility.emplace_back();
        for (std::size_t v = 0; v < scene.meshes[0].mesh.positions.size(); ++v)
            visibility.back().push_back(static_cast<float>((3 * v + i) % 64) / 63);
    }
    write_new_glb_occlusion(folder / "cube.glb", scene, visibility, {.color = true});

    const ImportedScene again = import_scene(folder / "cube.glb");
    const GltfFile file = read_gltf(folder / "cube.glb");
    REQUIRE(again.instances.size() == 3);
    const TriangleMesh& before = scene.meshes[0].mesh;
    for (std::size_t i = 0; i < 3; ++i) {
        const SceneInstance& instance = again.instances[i];
        const TriangleMesh& after = again.meshes[instance.mesh].mesh;
        REQUIRE(after.positions.size() == before.positions.size());
        REQUIRE(after.triangles.size() == before.triangles.size());
        for (std::size_t v = 0; v < before.positions.size(); ++v) {
            const glm::vec4 expected = scene.instances[i].transform * glm::vec4(before.positions[v], 1);
            REQUIRE(glm::distance(instance.transform * glm::vec4(after.positions[v], 1), expected) < 1e-5f);
            REQUIRE(glm::length(after.normals[v]) == Approx(1).margin(1e-5));
        }
        const Json& attributes = file.json["meshes"][i]["primitives"][0]["attributes"];
        const std::vector<double> values = file.accessor(attributes["_OCCLUSION"].get<std::size_t>());
        CHECK(std::vector<float>(values.begin(), values.end()) == visibility[i]);
        const std::vector<double> colors = file.accessor(attributes["COLOR_0"].get<std::size_t>());
        CHECK(colors[4 * 5 + 1] / 65535 == Approx(visibility[i][5]).margin(1e-5));
        CHECK(colors[4 * 5 + 3] == 65535);
    }
    // Instances with orthogonal axes share their mesh's accessors.
    const auto position = [&](std::size_t mesh) {
        return file.json["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"];
    };
    CHECK(position(0) == position(1));
    CHECK(position(0) != position(2));
    CHECK(!file.json["nodes"][2].contains("matrix"));
}

TEST_CASE("without --color there are no colours, and .gltf works as well") {
    const fs::path folder = scratch("new gltf");
    const ImportedScene scene = import_scene(source_file("models/corner.obj"));
    const std::vector<std::vector<float>> visibility{
        std::vector<float>(scene.meshes[0].mesh.positions.size(), 0.5f)};
    write_new_glb_occlusion(folder / "corner.gltf", scene, visibility, {});
    const GltfFile file = read_gltf(folder / "corner.gltf");
    CHECK(!file.json["meshes"][0]["primitives"][0]["attributes"].contains("COLOR_0"));
    CHECK(file.json["buffers"][0]["uri"] == "corner.bin");
    CHECK(import_scene(folder / "corner.gltf").meshes[0].mesh.triangles == scene.meshes[0].mesh.triangles);
}
