#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <set>

#include "baker/file_io.hpp"
#include "baker/scene.hpp"
#include "models/shapes.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
namespace fs = std::filesystem;

TEST_CASE("the generator writes the committed models, byte for byte") {
    const fs::path folder = fs::temp_directory_path() / "dfield_test_models";
    fs::remove_all(folder);
    REQUIRE(std::system(
                (std::string(DFIELD_GENERATOR) + " \"" + folder.string() + "\" > /dev/null").c_str()) == 0);
    std::uintmax_t size = 0;
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) {
        INFO(entry.path().filename());
        CHECK(read_file(entry.path()) ==
              read_file(test::source_file("models/" + entry.path().filename().string())));
        names.insert(entry.path().filename().string());
        size += entry.file_size();
    }
    CHECK(names == std::set<std::string>{"corner.obj", "cube_with_hole.obj", "harbour.glb", "leafy_tree.obj",
                                         "scene_instances.glb"});
    CHECK(size < 1'700'000);
    fs::remove_all(folder);
}

TEST_CASE("the cube with a hole is closed, manifold and of the right volume") {
    const ImportedScene scene = import_scene(test::source_file("models/cube_with_hole.obj"));
    const TriangleMesh& mesh = scene.meshes.at(0).mesh;
    REQUIRE(mesh.triangles.size() == 32);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    float volume = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
        volume += glm::dot(mesh.positions[t.x], glm::cross(mesh.positions[t.y], mesh.positions[t.z])) / 6;
    }
    CHECK(edges.size() == 96);
    for (const auto& [edge, count] : edges) {
        CHECK(count == 1);
        CHECK(edges.count({edge.second, edge.first}) == 1);
    }
    CHECK(volume == Approx(0.75));
}

TEST_CASE("the corner is the paper's: 3 x 33 x 33 vertices that face inwards") {
    const ImportedScene scene = import_scene(test::source_file("models/corner.obj"));
    const TriangleMesh& mesh = scene.meshes.at(0).mesh;
    CHECK(mesh.positions.size() == 3 * 33 * 33);
    CHECK(mesh.triangles.size() == 3 * 32 * 32 * 2);
    const Bounds bounds = triangle_bounds(mesh);
    CHECK(bounds.min == glm::vec3(0));
    CHECK(bounds.max == glm::vec3(2));
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 normal =
            glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
        REQUIRE(glm::dot(normal, glm::vec3(1) - mesh.positions[t.x]) > 0);
        for (int i = 0; i < 3; ++i) REQUIRE(glm::dot(glm::normalize(normal), mesh.normals[t[i]]) > 0.999f);
    }
}

TEST_CASE("the tree has leaves that look up, and nothing degenerate") {
    const models::Shape shape = models::leafy_tree();
    CHECK(models::triangle_count(shape) >= 15'000);
    CHECK(models::triangle_count(shape) <= 26'000);
    const ImportedScene scene = import_scene(test::source_file("models/leafy_tree.obj"));
    CHECK(scene.report.triangles == models::triangle_count(shape));
    CHECK(scene.report.degenerate == 0);
    CHECK(scene.report.not_finite == 0);
    const Bounds bounds = triangle_bounds(scene.meshes.at(0).mesh);
    CHECK(bounds.min.y == 0);
    CHECK(bounds.size().y > 3);
    std::size_t upwards = 0;
    for (const models::Face& leaf : shape.parts[1].faces) {
        const glm::dvec3 a = shape.positions[leaf.a];
        upwards += glm::cross(shape.positions[leaf.b] - a, shape.positions[leaf.c] - a).y > 0;
    }
    CHECK(static_cast<double>(upwards) > 0.9 * static_cast<double>(shape.parts[1].faces.size()));
}

TEST_CASE("the scene has mirrored, stretched and sheared instances of shared meshes") {
    const ImportedScene scene = import_scene(test::source_file("models/scene_instances.glb"));
    CHECK(scene.meshes.size() == 3);
    CHECK(scene.instances.size() == 9);
    int mirrored = 0, stretched = 0, sheared = 0;
    for (const SceneInstance& instance : scene.instances) {
        const glm::mat3 m(instance.transform);
        mirrored += glm::determinant(m) < 0;
        stretched += std::abs(glm::length(m[0]) - glm::length(m[1])) > 0.05f;
        sheared += std::abs(glm::dot(glm::normalize(m[0]), glm::normalize(m[2]))) > 0.05f;
    }
    CHECK(mirrored == 3);
    CHECK(stretched >= 4);
    CHECK(sheared == 2);
}
