#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/output/gltf_output.hpp"
#include "tests/gltf/gltf_reader.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using namespace dfield::test;
namespace fs = std::filesystem;

namespace {

// Everything that the patch has no business with is as it was, and the old entries of the lists stay in
// front.
void check_untouched(const GltfFile& before, const GltfFile& after) {
    for (const auto& [key, value] : before.json.items()) {
        INFO(key);
        if (key == "accessors" || key == "bufferViews") {
            REQUIRE(after.json[key].size() > value.size());
            for (std::size_t i = 0; i < value.size(); ++i) REQUIRE(after.json[key][i] == value[i]);
        } else if (key == "buffers") {
            Json first = after.json[key][0], old = value[0];
            first.erase("byteLength"), old.erase("byteLength");
            REQUIRE(first == old);
        } else if (key != "meshes" && key != "nodes" && key != "extensionsUsed" &&
                   key != "extensionsRequired") {
            REQUIRE(after.json[key] == value);
        }
    }
    const auto length = before.json["buffers"][0]["byteLength"].get<std::ptrdiff_t>();
    REQUIRE(std::equal(before.bin.begin(), before.bin.begin() + length, after.bin.begin()));
}

Json without_occlusion(Json mesh) {
    for (Json& primitive : mesh["primitives"]) primitive["attributes"].erase("_OCCLUSION");
    return mesh;
}

}  // namespace

TEST_CASE("one node: the attribute is added and nothing else changes") {
    const fs::path folder = scratch("one node");
    const SmallGltf small;
    const std::vector<std::byte> other{std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4}};
    small.write_glb(folder / "in.glb", other);
    const ImportedScene scene = import_scene(folder / "in.glb");
    const auto visibility = test_visibility(scene);
    write_gltf_occlusion(folder / "in.glb", folder / "out.glb", scene, visibility, {});
    check_occlusion(folder / "out.glb", scene, visibility);

    const GltfFile before = read_gltf(folder / "in.glb"), after = read_gltf(folder / "out.glb");
    check_untouched(before, after);
    CHECK(after.json["nodes"] == before.json["nodes"]);
    CHECK(after.json["meshes"].size() == 1);
    CHECK(without_occlusion(after.json["meshes"][0]) == before.json["meshes"][0]);
    CHECK(after.json["extensionsUsed"] == before.json["extensionsUsed"]);
    CHECK(after.other_chunk == other);
    // 9007199254740993 is no double: numbers come through as they were written.
    CHECK(after.json["meshes"][0]["extras"]["big"].get<std::int64_t>() == 9007199254740993);
}

TEST_CASE("a mesh of several nodes is cloned for each, sharing its other accessors") {
    const fs::path folder = scratch("several nodes");
    SmallGltf small;
    small.json["nodes"].push_back(
        {{"mesh", 0}, {"name", "second"}, {"translation", {0, 0, 3}}, {"scale", {-1, 2, 1}}});
    small.json["nodes"].push_back({{"name", "parent"}, {"rotation", {0, 0.6, 0, 0.8}}, {"children", {1}}});
    small.json["scenes"][0]["nodes"].push_back(2);
    const auto write = [&](const char* in, const char* out) {
        small.write_glb(folder / in);
        const ImportedScene scene = import_scene(folder / in);
        const auto visibility = test_visibility(scene);
        write_gltf_occlusion(folder / in, folder / out, scene, visibility, {});
        check_occlusion(folder / out, scene, visibility);
        return read_gltf(folder / out);
    };
    const GltfFile both = write("in.glb", "out.glb");
    REQUIRE(both.json["meshes"].size() == 2);
    CHECK(both.json["nodes"][0]["mesh"] != both.json["nodes"][1]["mesh"]);
    CHECK(without_occlusion(both.json["meshes"][0]) == without_occlusion(both.json["meshes"][1]));
    CHECK(both.json["meshes"][0] != both.json["meshes"][1]);

    // A node that is in no scene keeps the mesh as it was.
    small.json["nodes"].push_back({{"mesh", 0}, {"name", "elsewhere"}});
    const GltfFile three = write("in3.glb", "out3.glb");
    REQUIRE(three.json["meshes"].size() == 3);
    CHECK(three.json["nodes"][3] == small.json["nodes"][3]);
    CHECK(three.json["meshes"][0] == small.json["meshes"][0]);
}

TEST_CASE("instances by extension become child nodes") {
    const fs::path folder = scratch("gpu instancing");
    SmallGltf small;
    const float translations[] = {1, 2, 3, -4, 0.1f, 0};
    const std::int16_t rotations[] = {0, 23170, 0, 23170, 0, 0, 0, 32767};  // quantised: not quite unit
    const float scales[] = {1, 1, 1, -1, 2, 0.5f};
    const std::uint8_t ids[] = {11, 0, 0, 0, 12, 0, 0, 0};
    Json& node = small.json["nodes"][0];
    Json attributes = {
        {"TRANSLATION", small.add_accessor(translations, sizeof translations, 5126, "VEC3", 2)},
        {"ROTATION", small.add_accessor(rotations, sizeof rotations, 5122, "VEC4", 2)},
        {"SCALE", small.add_accessor(scales, sizeof scales, 5126, "VEC3", 2)},
        {"_ID", small.add_accessor(ids, sizeof ids, 5121, "SCALAR", 2)}};
    small.json["accessors"][4]["normalized"] = true;
    small.json["bufferViews"][6]["byteStride"] = 4;
    node["extensions"]["EXT_mesh_gpu_instancing"] = {{"attributes", attributes}};
    node["translation"] = {0, 0, 10};
    node["scale"] = {1, 1, 3};
    small.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing", "VENDOR_unknown"};
    small.json["extensionsRequired"] = Json::array({"EXT_mesh_gpu_instancing"});
    small.write_glb(folder / "in.glb");

    const ImportedScene scene = import_scene(folder / "in.glb");
    REQUIRE(scene.instances.size() == 2);
    const auto visibility = test_visibility(scene);
    write_gltf_occlusion(folder / "in.glb", folder / "out.glb", scene, visibility, {});
    check_occlusion(folder / "out.glb", scene, visibility);
    const GltfFile before = read_gltf(folder / "in.glb"), after = read_gltf(folder / "out.glb");
    check_untouched(before, after);
    CHECK(after.json["extensionsUsed"] == Json::array({"VENDOR_unknown"}));
    CHECK(!after.json.contains("extensionsRequired"));
    REQUIRE(after.json["nodes"].size() == 3);
    const Json& parent = after.json["nodes"][0];
    CHECK(!parent.contains("mesh"));
    CHECK(parent["children"] == Json::array({1, 2}));
    CHECK(parent["extras"] == before.json["nodes"][0]["extras"]);
    CHECK(parent["extensions"] == Json::object({{"VENDOR_unknown", Json::object({{"speed", 1e-3}})}}));
    CHECK(after.json["nodes"][2]["name"] == "first_1");
    CHECK(after.json["nodes"][2]["extras"]["_ID"] == 12);
    CHECK(after.json["nodes"][2]["scale"] == Json::array({-1.0, 2.0, 0.5}));
}

TEST_CASE("primitives that share positions share the attribute where their values agree") {
    const fs::path folder = scratch("shared positions");
    SmallGltf small;
    const std::uint8_t first[] = {0, 1, 2}, second[] = {0, 2, 3};
    Json& primitives = small.json["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
    primitives[0]["indices"] = small.add_accessor(first, 3, 5121, "SCALAR", 3);
    primitives[1]["indices"] = small.add_accessor(second, 3, 5121, "SCALAR", 3);
    small.write_glb(folder / "in.glb");
    const ImportedScene scene = import_scene(folder / "in.glb");
    REQUIRE(scene.meshes[0].mesh.positions.size() == 8);

    const auto occlusion = [&](const std::vector<float>& values, std::size_t primitive, const char* name) {
        const std::vector<std::vector<float>> visibility{values};
        write_gltf_occlusion(folder / "in.glb", folder / name, scene, visibility, {});
        const GltfFile file = read_gltf(folder / name);
        const auto index =
            file.json["meshes"][0]["primitives"][primitive]["attributes"]["_OCCLUSION"].get<std::size_t>();
        return std::pair(index, file.accessor(index));
    };
    // Vertex 3 is only in the second triangle, vertex 1 only in the first; what the other says of them is
    // void.
    const std::vector<float> agree{0.25f, 0.5f, 0.75f, 0.0f, 0.25f, 0.0f, 0.75f, 1.0f};
    CHECK(occlusion(agree, 0, "agree.glb") == occlusion(agree, 1, "agree.glb"));
    CHECK(occlusion(agree, 0, "agree.glb").second == std::vector<double>{0.25, 0.5, 0.75, 1.0});
    const std::vector<float> disagree{0.25f, 0.5f, 0.75f, 0.0f, 0.5f, 0.0f, 0.75f, 1.0f};
    CHECK(occlusion(disagree, 0, "disagree.glb").second == std::vector<double>{0.25, 0.5, 0.75, 0.0});
    CHECK(occlusion(disagree, 1, "disagree.glb").second == std::vector<double>{0.5, 0.0, 0.75, 1.0});
}

TEST_CASE("colours are grey, or the file's times visibility") {
    const fs::path folder = scratch("colours");
    const std::vector<std::vector<float>> visibility{{0.0f, 0.25f, 0.5f, 1.0f}};
    const auto colors = [&](const SmallGltf& small, const char* name) {
        small.write_glb(folder / (std::string("in_") + name));
        const ImportedScene scene = import_scene(folder / (std::string("in_") + name));
        write_gltf_occlusion(folder / (std::string("in_") + name), folder / name, scene, visibility,
                             {.color = true});
        check_occlusion(folder / name, scene, visibility);
        const GltfFile file = read_gltf(folder / name);
        const auto index =
            file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"].get<std::size_t>();
        CHECK(file.json["accessors"][index]["type"] == "VEC4");
        CHECK(file.json["accessors"][index]["componentType"] == 5123);
        CHECK(file.json["accessors"][index]["normalized"] == true);
        std::vector<double> values = file.accessor(index);
        for (double& value : values) value /= 65535;
        return values;
    };
    const auto check_colors = [&](const std::vector<double>& values, const double(&base)[4]) {
        REQUIRE(values.size() == 16);
        for (std::size_t v = 0; v < 4; ++v)
            for (std::size_t c = 0; c < 4; ++c)
                CHECK(values[4 * v + c] ==
                      Approx(base[c] * (c < 3 ? double{visibility[0][v]} : 1.0)).margin(1e-5));
    };
    check_colors(colors(SmallGltf(), "grey.glb"), {1, 1, 1, 1});

    SmallGltf floats;
    const float rgba[] = {1, 0.5f, 0.25f, 0.125f, 1, 0.5f, 0.25f, 0.125f,
                          1, 0.5f, 0.25f, 0.125f, 1, 0.5f, 0.25f, 0.125f};
    floats.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
        floats.add_accessor(rgba, sizeof rgba, 5126, "VEC4", 4);
    check_colors(colors(floats, "floats.glb"), {1, 0.5, 0.25, 0.125});

    SmallGltf bytes;
    const std::uint8_t rgb[] = {255, 51, 102, 0, 255, 51, 102, 0, 255, 51, 102, 0, 255, 51, 102, 0};
    bytes.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
        bytes.add_accessor(rgb, sizeof rgb, 5121, "VEC3", 4);
    bytes.json["accessors"].back()["normalized"] = true;
    bytes.json["bufferViews"].back()["byteStride"] = 4;
    check_colors(colors(bytes, "bytes.glb"), {1, 0.2, 0.4, 1});
}

TEST_CASE("what does not fit is refused before anything is written") {
    const fs::path folder = scratch("refused");
    SmallGltf small;
    small.write_glb(folder / "in.glb");
    const ImportedScene scene = import_scene(folder / "in.glb");
    const auto write = [&](const std::vector<std::vector<float>>& visibility) {
        write_gltf_occlusion(folder / "in.glb", folder / "out.glb", scene, visibility, {});
    };
    CHECK_THROWS_AS(write({}), std::invalid_argument);
    CHECK_THROWS_AS(write({{1, 1, 1}}), std::invalid_argument);
    CHECK_THROWS_AS(write({{1, 1, 1, 1.5f}}), std::invalid_argument);
    CHECK_THROWS_AS(write({{1, 1, 1, std::numeric_limits<float>::quiet_NaN()}}), std::invalid_argument);

    const auto visibility = test_visibility(scene);
    CHECK_THROWS_AS(write_gltf_occlusion(folder / "in.glb", folder / "out.obj", scene, visibility, {}),
                    OutputError);
    CHECK_THROWS_AS(
        write_gltf_occlusion(folder / "in.glb", folder / "none" / "out.glb", scene, visibility, {}),
        OutputError);
    // The file changes between import and output.
    SmallGltf other;
    other.json["nodes"][0].erase("mesh");
    other.write_glb(folder / "in.glb");
    CHECK_THROWS_AS(write(visibility), InputError);
    other.json["nodes"][0]["mesh"] = 0;
    other.json["accessors"][1]["count"] = 3;
    other.write_glb(folder / "in.glb");
    CHECK_THROWS_AS(write(visibility), InputError);
    other.json["meshes"] = "none";
    other.write_glb(folder / "in.glb");
    CHECK_THROWS_AS(write(visibility), InputError);
    write_file_atomic(folder / "in.glb", std::string_view("glTF\2\0\0\0\377\377\0\0 cut off", 20));
    CHECK_THROWS_AS(write(visibility), InputError);
    fs::remove(folder / "in.glb");
    CHECK_THROWS_AS(write(visibility), InputError);
    CHECK(fs::is_empty(folder));
}

TEST_CASE("the project's own scene and the shared ones come back with their values") {
    const fs::path folder = scratch("scenes");
    std::vector<fs::path> inputs{source_file("models/scene_instances.glb")};
    for (const char* name :
         {"BoxVertexColors", "CesiumMilkTruck", "lemon_grove_ext_instancing", "lemon_grove_nodes"})
        if (const auto path = shared_file(std::string("scenes/") + name + ".glb")) inputs.push_back(*path);
    for (const fs::path& input : inputs) {
        const ImportedScene scene = import_scene(input);
        const auto visibility = test_visibility(scene);
        const fs::path output = folder / input.filename();
        write_gltf_occlusion(input, output, scene, visibility,
                             {.color = input.filename() == "BoxVertexColors.glb"});
        check_occlusion(output, scene, visibility);
        const GltfFile before = read_gltf(input), after = read_gltf(output);
        check_untouched(before, after);
        // One attribute for each mesh that is shown: three primitives of a tree share their positions.
        if (input.filename() == "lemon_grove_nodes.glb" ||
            input.filename() == "lemon_grove_ext_instancing.glb") {
            CHECK(after.json["meshes"].size() == 25);
            CHECK(after.json["accessors"].size() == before.json["accessors"].size() + 25);
        }
    }
}
