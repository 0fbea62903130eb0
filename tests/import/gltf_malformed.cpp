// Broken glTF: an InputError that says what is wrong, never a crash, a hang or a huge allocation.
#include <catch2/catch.hpp>

#include "baker/error.hpp"
#include "baker/scene.hpp"
#include "tests/import/gltf_builder.hpp"

using Catch::Contains;
using dfield::import_scene;
using dfield::InputError;
using nlohmann::json;
using namespace dfield::test;

namespace {

std::string error_of(const std::string& name, const std::string& bytes) {
    const TestFolder folder;
    const auto path = folder.write(name, bytes);
    try {
        import_scene(path);
    } catch (const InputError& error) {
        CHECK_THAT(error.what(), Contains(name));
        return error.what();
    }
    return "no error";
}
std::string error_of(const GltfBuilder& b) {
    return error_of("a.glb", b.glb());
}

// Accessor 0 has the positions, accessor 1 the indices: 36 and 6 bytes.
GltfBuilder triangle() {
    GltfBuilder b;
    const int positions = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0});
    b.mesh(positions, b.accessor(bytes_of<std::uint16_t>({0, 1, 2}), kUnsignedShort, "SCALAR", 3));
    b.node({{"mesh", 0}});
    return b;
}

}  // namespace

TEST_CASE("what is no glTF 2.0 says so") {
    CHECK(error_of(triangle()) == "no error");
    CHECK_THAT(error_of("a.gltf", ""), Contains("no glTF"));
    CHECK_THAT(error_of("a.gltf", "{"), Contains("broken at byte"));
    CHECK_THAT(error_of("a.gltf", "[]"), Contains("not an object"));
    CHECK_THAT(error_of("a.gltf", "{}"), Contains("asset.version"));
    CHECK_THAT(error_of("a.gltf", R"({"asset":{"version":"1.0"}})"), Contains("version 1.0"));
    CHECK_THAT(error_of("a.gltf", R"({"asset":{"version":"2.0"}})"), Contains("no usable triangle"));
    const std::string deep = R"({"asset":{"version":"2.0"},"extras":)";
    CHECK_THAT(error_of("a.gltf", deep + std::string(100000, '[') + std::string(100000, ']') + "}"),
               Contains("100 levels"));
    std::string glb = triangle().glb();
    glb[4] = 1;
    CHECK_THAT(error_of("a.glb", glb), Contains("GLB version 1"));
}

TEST_CASE("required extensions that dfield does not know are errors with their name") {
    for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "VENDOR_unknown"}) {
        GltfBuilder b = triangle();
        b.json["extensionsUsed"] = {name};
        CHECK(error_of(b) == "no error");
        b.json["extensionsRequired"] = {name};
        CHECK_THAT(error_of(b), Contains(name) && Contains("requires"));
    }
}

TEST_CASE("node graphs: cycles, two parents, missing children, a long chain") {
    GltfBuilder b = triangle();
    b.json["nodes"] = {{{"mesh", 0}, {"children", {0}}}};
    CHECK_THAT(error_of(b), Contains("cycle"));
    b.json["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}};
    CHECK_THAT(error_of(b), Contains("cycle") && Contains("node_1"));
    b.json["nodes"] = {{{"children", {1, 2}}}, {{"children", {2}}}, {{"mesh", 0}}};
    CHECK_THAT(error_of(b), Contains("two parents"));
    b.json["nodes"] = {{{"children", {1, 1}}}, {{"mesh", 0}}};
    CHECK_THAT(error_of(b), Contains("two parents"));
    b.json["nodes"] = {{{"mesh", 0}, {"children", {7}}}};
    CHECK_THAT(error_of(b), Contains("child 7"));
    b.json["nodes"] = {{{"mesh", 5}}};
    CHECK_THAT(error_of(b), Contains("mesh 5"));
    b.json["nodes"] = {{{"mesh", 0}, {"matrix", {1, 2, 3}}}};
    CHECK_THAT(error_of(b), Contains("16 numbers"));
    b.json["nodes"] = {{{"mesh", 0}, {"scale", {1e300, 1, 1}}}};
    CHECK_THAT(error_of(b), Contains("not finite"));
    b.json["nodes"] = {{{"mesh", 0}}};
    b.json["scenes"][0]["nodes"] = {3};
    CHECK_THAT(error_of(b), Contains("names node 3"));
    b.json["scenes"][0]["nodes"] = {0, 0};
    CHECK_THAT(error_of(b), Contains("twice"));
    b.json["scene"] = 4;
    CHECK_THAT(error_of(b), Contains("scene 4"));
    // No recursion: as deep as you like.
    b = triangle();
    for (int i = 1; i < 20000; ++i)
        b.json["nodes"][static_cast<std::size_t>(i) - 1]["children"] = {b.node({{"name", "n"}})};
    CHECK(error_of(b) == "no error");
}

TEST_CASE("accessors beyond their buffers, and huge counts") {
    const auto with = [](const auto& change) {
        GltfBuilder b = triangle();
        change(b.json);
        return error_of(b);
    };
    CHECK_THAT(with([](json& j) { j["accessors"][0]["count"] = 4; }),
               Contains("POSITION") && Contains("beyond its buffer view"));
    CHECK_THAT(with([](json& j) { j["accessors"][0]["count"] = 4000000000u; }), Contains("POSITION"));
    CHECK_THAT(with([](json& j) { j["accessors"][0]["count"] = 1ull << 62; }), Contains("POSITION"));
    CHECK_THAT(with([](json& j) { j["accessors"][0]["byteOffset"] = 1; }),
               Contains("beyond its buffer view"));
    CHECK_THAT(with([](json& j) { j["accessors"][0]["byteOffset"] = ~0ull; }), Contains("a.glb"));
    CHECK_THAT(with([](json& j) { j["bufferViews"][0]["byteLength"] = 1u << 30; }),
               Contains("beyond its buffer"));
    CHECK_THAT(with([](json& j) { j["bufferViews"][0]["byteOffset"] = ~0ull - 10; }), Contains("a.glb"));
    CHECK_THAT(with([](json& j) { j["bufferViews"][0]["buffer"] = 1; }), Contains("buffer 1"));
    CHECK_THAT(with([](json& j) { j["bufferViews"][0]["byteStride"] = 4; }), Contains("stride"));
    CHECK_THAT(with([](json& j) { j["accessors"][0]["bufferView"] = 9; }), Contains("buffer view 9"));
    CHECK_THAT(with([](json& j) {
                   j["accessors"][0].erase("bufferView");
                   j["accessors"][0]["count"] = 1000000000;
               }),
               Contains("without a buffer view"));
    CHECK_THAT(with([](json& j) { j["accessors"][0]["type"] = "VEC2"; }), Contains("3 components"));
    CHECK_THAT(with([](json& j) { j["accessors"][0]["componentType"] = kUnsignedInt; }),
               Contains("neither floats"));
    CHECK_THAT(with([](json& j) { j["accessors"][1]["componentType"] = kShort; }), Contains("unsigned"));
    CHECK_THAT(with([](json& j) { j["accessors"][1]["type"] = "VEC3"; }), Contains("SCALAR"));
    CHECK_THAT(with([](json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9; }),
               Contains("accessor 9"));
    CHECK_THAT(with([](json& j) { j["meshes"][0]["primitives"][0]["indices"] = 9; }), Contains("a.glb"));
    CHECK_THAT(with([](json& j) { j["meshes"][0]["primitives"][0]["mode"] = 7; }), Contains("mode 7"));
    CHECK_THAT(with([](json& j) { j["meshes"][0]["primitives"][0].erase("attributes"); }),
               Contains("malformed primitive"));
    CHECK_THAT(with([](json& j) {
                   j["meshes"][0]["primitives"][0]["attributes"] = json::object({{"NORMAL", 0}});
               }),
               Contains("1 points or lines"));
    CHECK_THAT(with([](json& j) { j["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 1; }),
               Contains("NORMAL"));
    const auto sparse = [&](int count, int index_view, int value_view, int index_offset = 0) {
        return with([&](json& j) {
            j["accessors"][0]["sparse"] = {{"count", count},
                                           {"indices",
                                            {{"bufferView", index_view},
                                             {"byteOffset", index_offset},
                                             {"componentType", kUnsignedShort}}},
                                           {"values", {{"bufferView", value_view}}}};
        });
    };
    CHECK(sparse(3, 1, 0) == "no error");
    CHECK_THAT(sparse(4, 1, 0), Contains("beyond its buffer view"));
    CHECK_THAT(sparse(-1, 1, 0), Contains("negative"));
    CHECK_THAT(sparse(3, 1, 8), Contains("buffer view 8"));
    CHECK_THAT(sparse(3, 0, 0, 12), Contains("sparse index"));
}

TEST_CASE("buffers that are missing, too short or no text") {
    GltfBuilder b = triangle();
    CHECK_THAT(error_of("a.gltf", b.gltf("data:application/octet-stream;base64,AAAA")), Contains("a.gltf"));
    CHECK_THAT(error_of("a.gltf", b.gltf("data:text/plain,hello")), Contains("base64"));
    CHECK_THAT(error_of("a.gltf", b.gltf("")), Contains("a.gltf"));
    CHECK_THAT(error_of("a.gltf", b.gltf("http://example.com/a.bin")), Contains("a.gltf"));
    json document = json::parse(b.gltf("x"));
    document["buffers"][0].erase("uri");
    CHECK_THAT(error_of("a.gltf", document.dump()), Contains("no data"));
    document["buffers"][0] = {{"byteLength", -5}};
    CHECK_THAT(error_of("a.gltf", document.dump()), Contains("byteLength"));
    std::string glb = b.glb();
    const std::size_t at = glb.find("\"buffers\":[{\"byteLength\":42");
    REQUIRE(at != std::string::npos);
    glb[at + 25] = '9';
    CHECK_THAT(error_of("a.glb", glb), Contains("byteLength"));
}

TEST_CASE("instancing without attributes, or with attributes of different lengths") {
    GltfBuilder b = triangle();
    json& extension = b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"];
    extension = json::object();
    CHECK_THAT(error_of(b), Contains("EXT_mesh_gpu_instancing") && Contains("no attributes"));
    const int two = b.floats({1, 0, 0, 2, 0, 0}), one = b.floats({1, 1, 1});
    extension = {{"attributes", {{"TRANSLATION", two}, {"SCALE", one}}}};
    CHECK_THAT(error_of(b), Contains("differ in length"));
    extension = {{"attributes", {{"TRANSLATION", 77}}}};
    CHECK_THAT(error_of(b), Contains("accessor 77"));
    extension = {{"attributes", {{"ROTATION", two}}}};
    CHECK_THAT(error_of(b), Contains("4 components"));
    extension = {{"attributes", {{"TRANSLATION", "x"}}}};
    CHECK_THAT(error_of(b), Contains("no accessor"));
}

TEST_CASE("every prefix and every flipped byte of a GLB is read or refused") {
    const TestFolder folder;
    const auto check = [&](const std::string& bytes) {
        const auto path = folder.write("a.glb", bytes);
        try {
            const dfield::ImportedScene scene = import_scene(path);
            dfield::flatten_scene(scene);
        } catch (const InputError&) {
        }
    };
    const std::string glb = triangle().glb();
    for (std::size_t size = 0; size < glb.size(); ++size) {
        check(glb.substr(0, size));
        REQUIRE(error_of("a.glb", glb.substr(0, size)) != "no error");
    }
    for (std::size_t at = 0; at < glb.size(); ++at)
        for (const int flip : {0x01, 0x02, 0x10, 0x80}) {
            std::string flipped = glb;
            flipped[at] = static_cast<char>(flipped[at] ^ flip);
            check(flipped);
        }
    SUCCEED("no crash");
}
