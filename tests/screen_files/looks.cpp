// Albedos and cameras of glTF files.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "baker/error.hpp"
#include "baker/scene.hpp"
#include "tests/import/gltf_builder.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using namespace dfield::test;
using Catch::Contains;

namespace {

// A triangle with a material and colours, and a camera under a scaled parent.
GltfBuilder dressed() {
    GltfBuilder gltf;
    const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int mesh = gltf.mesh(positions);
    const int colours = gltf.accessor(bytes_of<std::uint8_t>({255, 0, 0, 9, 0, 255, 0, 9, 0, 51, 255, 9}),
                                      kUnsignedByte, "VEC4", 3, {{"normalized", true}});
    gltf.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colours;
    gltf.json["meshes"][0]["primitives"][0]["material"] = 0;
    gltf.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 1}}}}}};
    gltf.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.25}}}},
                            {{"name", "plan"},
                             {"type", "orthographic"},
                             {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0}, {"zfar", 50}}}}};
    gltf.node({{"mesh", mesh}, {"children", {1, 2}}, {"scale", {2, 2, 2}}, {"translation", {0, 0, 1}}});
    gltf.node({{"camera", 0}, {"translation", {1, 2, 3}}});
    gltf.node({{"camera", 1}, {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}});
    return gltf;
}

ImportedScene import(const GltfBuilder& gltf, bool looks = true) {
    const TestFolder folder;
    return import_scene(folder.write("a.glb", gltf.glb()), {.looks = looks});
}

std::string error_with(const std::function<void(nlohmann::json&)>& change) {
    GltfBuilder gltf = dressed();
    change(gltf.json);
    CHECK_NOTHROW(import(gltf, false));  // who does not ask for looks is not bothered
    try {
        import(gltf);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace

TEST_CASE("albedo is base colour times vertex colour") {
    const ImportedScene scene = import(dressed());
    const std::vector<glm::vec3>& albedo = scene.meshes.at(0).albedo;
    REQUIRE(albedo.size() == 3);
    CHECK(glm::length(albedo[0] - glm::vec3(0.5f, 0, 0)) < 1e-6f);
    CHECK(glm::length(albedo[1] - glm::vec3(0, 0.25f, 0)) < 1e-6f);
    CHECK(glm::length(albedo[2] - glm::vec3(0, 0.05f, 1)) < 1e-6f);
    CHECK(import(dressed(), false).meshes.at(0).albedo.empty());
    CHECK(import(dressed(), false).cameras.empty());
}

TEST_CASE("cameras stand where their nodes are, without their scale") {
    const ImportedScene scene = import(dressed());
    REQUIRE(scene.cameras.size() == 2);
    const SceneCamera &first = scene.cameras[0], &plan = scene.cameras[1];
    CHECK(first.name == "camera_0");
    CHECK_FALSE(first.orthographic);
    CHECK(first.half_height == Approx(std::tan(0.5)));
    CHECK(first.near == 0.25f);
    CHECK(std::isinf(first.far));
    CHECK(glm::length(first.to_world[3] - glm::vec4(2, 4, 7, 1)) < 1e-5f);
    CHECK(glm::length(first.to_world[2] - glm::vec4(0, 0, 1, 0)) < 1e-6f);
    CHECK(plan.name == "plan");
    CHECK(plan.orthographic);
    CHECK(plan.half_height == 2);
    CHECK(plan.far == 50);
    CHECK(glm::length(plan.to_world[2] - glm::vec4(0, 1, 0, 0)) < 1e-6f);  // looks down
}

TEST_CASE("what is wrong with looks") {
    using nlohmann::json;
    CHECK(error_with([](json&) {}) == "no error");
    CHECK_THAT(error_with([](json& j) {
                   j["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 2};
               }),
               Contains("material 0: baseColorFactor needs 4"));
    CHECK_THAT(
        error_with([](json& j) { j["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][1] = 2; }),
        Contains("outside 0..1"));
    CHECK_THAT(error_with([](json& j) { j["meshes"][0]["primitives"][0]["material"] = 7; }),
               Contains("material 7, which does not exist"));
    CHECK_THAT(error_with([](json& j) { j["accessors"][1]["count"] = 2; }),
               Contains("3 positions and 2 colours"));
    CHECK_THAT(error_with([](json& j) { j["accessors"][1]["type"] = "VEC2"; }),
               Contains("3 or 4 components"));
    CHECK_THAT(error_with([](json& j) { j["cameras"][0]["type"] = "fisheye"; }), Contains("camera 0"));
    CHECK_THAT(error_with([](json& j) { j["cameras"][0]["perspective"]["yfov"] = -1; }), Contains("yfov"));
    CHECK_THAT(error_with([](json& j) { j["cameras"][1]["orthographic"]["zfar"] = 0; }), Contains("zfar"));
    CHECK_THAT(error_with([](json& j) { j["nodes"][1]["camera"] = 5; }),
               Contains("camera 5, which does not exist"));
    CHECK_THAT(error_with([](json& j) {
                   j["nodes"][0]["scale"] = {0, 0, 0};
               }),
               Contains("flat or not finite"));
}

TEST_CASE("the harbour has colours and a camera") {
    const ImportedScene scene = import_scene(source_file("models/harbour.glb"), {.looks = true});
    REQUIRE(scene.cameras.size() == 1);
    CHECK(scene.cameras[0].name == "mole");
    CHECK(scene.report.degenerate == 0);
    bool red = false, shaded_hull = false;
    for (const SceneMesh& mesh : scene.meshes) {
        REQUIRE(mesh.albedo.size() == mesh.mesh.positions.size());
        red = red || (mesh.albedo[0].x > 0.6f && mesh.albedo[0].y < 0.2f);
        for (const glm::vec3& albedo : mesh.albedo) shaded_hull = shaded_hull || albedo != mesh.albedo[0];
    }
    CHECK(red);
    CHECK(shaded_hull);
}
