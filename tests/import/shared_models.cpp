// Real models: figures that are known for them.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "baker/scene.hpp"
#include "tests/test_data.hpp"

TEST_CASE("models come in with all their triangles and vertices") {
    struct Known {
        const char* file;
        std::size_t triangles, vertices;
    };
    const Known known[] = {{"cow.obj", 5804, 2903},
                           {"stanford-bunny.obj", 69451, 35947},
                           {"igea_triangles.ply", 268686, 134345},
                           {"spot.obj", 5856, 2930},
                           {"lemon_tree.obj", 40036, 50328},
                           {"mountain_open.obj", 50562, 25600}};
    for (const Known& model : known) {
        const auto path = dfield::test::shared_file(std::string("models/") + model.file);
        if (!path) continue;
        const dfield::ImportedScene scene = dfield::import_scene(*path);
        INFO(model.file);
        CHECK(scene.report.triangles == model.triangles);
        CHECK(scene.report.faces == model.triangles);
        CHECK(scene.meshes[0].mesh.triangles.size() == model.triangles);
        CHECK(scene.meshes[0].mesh.positions.size() == model.vertices);
        CHECK(scene.report.warnings.empty());
        const auto& normals = scene.meshes[0].mesh.normals;
        CHECK(normals.size() == model.vertices);
        CHECK(std::all_of(normals.begin(), normals.end(),
                          [](auto& n) { return std::abs(glm::dot(n, n) - 1) < 1e-4f; }));
    }
}

TEST_CASE("a grove by nodes and by EXT_mesh_gpu_instancing is the same set of triangles") {
    const auto by_nodes = dfield::test::shared_file("scenes/lemon_grove_nodes.glb");
    const auto by_instancing = dfield::test::shared_file("scenes/lemon_grove_ext_instancing.glb");
    if (!by_nodes || !by_instancing) return;
    const dfield::ImportedScene a = dfield::import_scene(*by_nodes), b = dfield::import_scene(*by_instancing);
    REQUIRE(a.instances.size() == 25);
    REQUIRE(b.instances.size() == 25);
    CHECK(a.meshes.size() == 1);
    CHECK(b.meshes.size() == 1);
    for (int i = 0; i < 25; ++i) CHECK(b.instances[static_cast<std::size_t>(i)].gpu_instance == i);
    const dfield::TriangleMesh world_a = dfield::flatten_scene(a), world_b = dfield::flatten_scene(b);
    REQUIRE(world_a.triangles.size() == 25 * 40036);
    REQUIRE(world_b.triangles.size() == world_a.triangles.size());
    // As sets: centres sorted along x. Rotations went through floats in one of the two, so to 1e-4.
    const auto centres = [](const dfield::TriangleMesh& mesh) {
        std::vector<std::array<float, 3>> all;
        all.reserve(mesh.triangles.size());
        for (const glm::uvec3& t : mesh.triangles) {
            const glm::vec3 c = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0f;
            all.push_back({c.x, c.y, c.z});
        }
        return all;
    };
    const auto centres_a = centres(world_a), centres_b = centres(world_b);
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float> along_a, along_b;
        for (const auto& c : centres_a) along_a.push_back(c[static_cast<std::size_t>(axis)]);
        for (const auto& c : centres_b) along_b.push_back(c[static_cast<std::size_t>(axis)]);
        std::sort(along_a.begin(), along_a.end());
        std::sort(along_b.begin(), along_b.end());
        float worst = 0;
        for (std::size_t i = 0; i < along_a.size(); ++i)
            worst = std::max(worst, std::abs(along_a[i] - along_b[i]));
        CHECK(worst < 1e-4f);
    }
}

TEST_CASE("sample scenes: meshes, instances and names") {
    if (const auto path = dfield::test::shared_file("scenes/CesiumMilkTruck.glb")) {
        const dfield::ImportedScene scene = dfield::import_scene(*path);
        CHECK(scene.meshes.size() == 2);
        CHECK(scene.instances.size() == 3);
        CHECK(scene.report.degenerate + scene.report.not_finite + scene.report.index_out_of_range == 0);
        CHECK(scene.meshes[0].primitives.size() == 3);
        const auto size = [&](const char* mesh, const char* node) {
            return dfield::flatten_scene(scene, mesh, node).triangles.size();
        };
        CHECK(size("Wheels", "") > 0);
        CHECK(size("", "node_1") == size("Wheels", ""));  // an axle, a node without a name above the wheels
        CHECK(size("", "") == size("Cesium_Milk_Truck", "") + 2 * size("Wheels", ""));
    }
    if (const auto path = dfield::test::shared_file("scenes/BoxVertexColors.glb"))
        CHECK(dfield::import_scene(*path).report.triangles == 12);
}
