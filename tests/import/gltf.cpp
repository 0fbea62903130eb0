// glTF: every way to store triangles, and where nodes put them.
#include <catch2/catch.hpp>

#include "baker/error.hpp"
#include "baker/scene.hpp"
#include "tests/import/gltf_builder.hpp"

using Catch::Contains;
using dfield::flatten_scene;
using dfield::import_scene;
using dfield::ImportedScene;
using dfield::TriangleMesh;
using nlohmann::json;
using namespace dfield::test;

namespace {

ImportedScene import_built(const GltfBuilder& builder) {
    const TestFolder folder;
    return import_scene(folder.write("a.glb", builder.glb()));
}

const std::initializer_list<float> kSquare = {0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0};
const std::vector<glm::uvec3> kTriangles = {{0, 1, 2}, {0, 2, 3}};

GltfBuilder square() {
    GltfBuilder b;
    b.mesh(b.floats(kSquare),
           b.accessor(bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 3}), kUnsignedShort, "SCALAR", 6));
    b.node({{"mesh", 0}});
    return b;
}

void check_square(const ImportedScene& scene) {
    REQUIRE(scene.meshes.size() == 1);
    const TriangleMesh& mesh = scene.meshes[0].mesh;
    REQUIRE(mesh.positions.size() == 4);
    const glm::vec3 expected[] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    for (int i = 0; i < 4; ++i)
        CHECK(glm::distance(mesh.positions[static_cast<std::size_t>(i)], expected[i]) < 1e-3f);
    CHECK(mesh.triangles == kTriangles);
    for (const glm::vec3& n : mesh.normals) CHECK(n.z == Approx(1));
}

// World positions, sorted by node order.
std::vector<glm::vec3> world(const ImportedScene& scene) {
    return flatten_scene(scene).positions;
}

bool close(const glm::vec3& a, const glm::vec3& b) {
    return glm::distance(a, b) < 1e-5f;
}

}  // namespace

TEST_CASE("indices of every type, and none") {
    check_square(import_built(square()));
    for (const int type : {kUnsignedByte, kUnsignedShort, kUnsignedInt}) {
        GltfBuilder b;
        const std::string indices = type == kUnsignedByte    ? bytes_of<std::uint8_t>({0, 1, 2, 0, 2, 3})
                                    : type == kUnsignedShort ? bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 3})
                                                             : bytes_of<std::uint32_t>({0, 1, 2, 0, 2, 3});
        b.mesh(b.floats(kSquare), b.accessor(indices, type, "SCALAR", 6));
        b.node({{"mesh", 0}});
        check_square(import_built(b));
    }
    GltfBuilder b;
    b.mesh(b.floats({0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 0, 0, 2, 2, 0, 0, 2, 0}));
    b.node({{"mesh", 0}});
    const ImportedScene scene = import_built(b);
    CHECK(scene.meshes[0].mesh.triangles == std::vector<glm::uvec3>{{0, 1, 2}, {3, 4, 5}});
}

TEST_CASE("strips and fans keep the winding, points and lines are counted") {
    GltfBuilder strip;
    strip.mesh(strip.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}), -1, 5);
    strip.node({{"mesh", 0}});
    const ImportedScene strips = import_built(strip);
    CHECK(strips.meshes[0].mesh.triangles == std::vector<glm::uvec3>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}});
    for (const glm::vec3& n : strips.meshes[0].mesh.normals) CHECK(n == glm::vec3(0, 0, 1));

    GltfBuilder fan;
    fan.mesh(fan.floats(kSquare), -1, 6);
    fan.node({{"mesh", 0}});
    CHECK(import_built(fan).meshes[0].mesh.triangles == std::vector<glm::uvec3>{{1, 2, 0}, {2, 3, 0}});

    // Stitched strips repeat indices: those triangles have no area.
    GltfBuilder stitched;
    const int indices =
        stitched.accessor(bytes_of<std::uint8_t>({0, 1, 2, 2, 3, 3, 0, 1}), kUnsignedByte, "SCALAR", 8);
    stitched.mesh(stitched.floats(kSquare), indices, 5);
    for (const int mode : {0, 1, 2, 3}) {
        json primitive = stitched.json["meshes"][0]["primitives"][0];
        primitive["mode"] = mode;
        stitched.json["meshes"][0]["primitives"].push_back(primitive);
    }
    stitched.node({{"mesh", 0}});
    const ImportedScene scene = import_built(stitched);
    CHECK(scene.report.faces == 6);
    CHECK(scene.report.degenerate == 4);
    CHECK(scene.report.triangles == 2);
    CHECK(scene.report.skipped_primitives == 4);
    CHECK(scene.meshes[0].primitives.size() == 1);
}

TEST_CASE("positions interleaved, sparse, quantised") {
    GltfBuilder interleaved;
    std::string bytes;
    for (auto p = kSquare.begin(); p != kSquare.end(); p += 3)
        bytes += bytes_of<float>({9, 9, p[0], p[1], p[2], 9});
    bytes.resize(bytes.size() - 4);  // the last element need not fill its stride
    const int positions = interleaved.accessor(bytes, kFloat, "VEC3", 4, {{"byteOffset", 8}}, 24);
    interleaved.mesh(positions, -1, 6);
    interleaved.node({{"mesh", 0}});
    CHECK(area(import_built(interleaved).meshes[0].mesh) == Approx(4));

    for (const bool based : {true, false}) {
        GltfBuilder sparse;
        const int indices = sparse.view(bytes_of<std::uint16_t>({1, 2, 3}));
        const int values = sparse.view(bytes_of<float>({2, 0, 0, 2, 2, 0, 0, 2, 0}));
        const json more = {{"sparse",
                            {{"count", 3},
                             {"indices", {{"bufferView", indices}, {"componentType", kUnsignedShort}}},
                             {"values", {{"bufferView", values}}}}}};
        const std::string base = based ? bytes_of<float>({0, 0, 0, 7, 7, 7, 8, 8, 8, 9, 9, 9}) : "";
        const int accessor = sparse.accessor(base, kFloat, "VEC3", 4, more);
        sparse.mesh(accessor,
                    sparse.accessor(bytes_of<std::uint8_t>({0, 1, 2, 0, 2, 3}), kUnsignedByte, "SCALAR", 6));
        sparse.node({{"mesh", 0}});
        check_square(import_built(sparse));
    }

    struct Quantised {
        int type;
        bool normalized;
        std::string bytes;  // 0 and one extreme, padded to 4 bytes a vertex
        float scale;
    };
    const Quantised kinds[] = {
        {kByte, true, bytes_of<std::int8_t>({0, 0, 0, 0, 127, 0, 0, 0, 127, 127, 0, 0, 0, 127, 0, 0}), 2},
        {kUnsignedByte, false,
         bytes_of<std::uint8_t>({0, 0, 0, 0, 200, 0, 0, 0, 200, 200, 0, 0, 0, 200, 0, 0}), 0.01f},
        {kShort, true,
         bytes_of<std::int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 32767, 32767, 0, 0, 0, 32767, 0, 0}), 2},
        {kShort, false, bytes_of<std::int16_t>({0, 0, 0, 0, -200, 0, 0, 0, -200, -200, 0, 0, 0, -200, 0, 0}),
         -0.01f},
        {kUnsignedShort, true,
         bytes_of<std::uint16_t>({0, 0, 0, 0, 65535, 0, 0, 0, 65535, 65535, 0, 0, 0, 65535, 0, 0}), 2}};
    for (const Quantised& kind : kinds) {
        GltfBuilder b;
        b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
        const int stride = kind.type == kByte || kind.type == kUnsignedByte ? 4 : 8;
        b.mesh(b.accessor(kind.bytes, kind.type, "VEC3", 4, {{"normalized", kind.normalized}}, stride), -1,
               6);
        b.node({{"mesh", 0}, {"scale", {kind.scale, kind.scale, 1}}});
        const TriangleMesh mesh = flatten_scene(import_built(b));
        REQUIRE(mesh.positions.size() == 4);
        CHECK(close(mesh.positions[2], {2, 2, 0}));
        CHECK(close(mesh.positions[1], {2, 0, 0}));
    }
}

TEST_CASE("buffers inside, in data URIs and in files beside") {
    const TestFolder folder;
    const GltfBuilder b = square();
    check_square(import_scene(folder.write("a.gltf", b.gltf(b.data_uri("application/octet-stream")))));
    check_square(import_scene(folder.write("b.gltf", b.gltf(b.data_uri("application/gltf-buffer")))));
    check_square(import_scene(folder.write("c.gltf", b.gltf(b.data_uri("")))));
    folder.write("with space.bin", b.buffer);
    check_square(import_scene(folder.write("d.GLTF", b.gltf("with%20space.bin"))));
    CHECK_THROWS_WITH(import_scene(folder.write("e.gltf", b.gltf("none.bin"))),
                      Contains("none.bin") && Contains("missing"));
    folder.write("short.bin", b.buffer.substr(1));
    CHECK_THROWS_WITH(import_scene(folder.write("f.gltf", b.gltf("short.bin"))), Contains("short.bin"));
}

TEST_CASE("images are neither read nor missed, and the optional may be anything") {
    GltfBuilder b = square();
    b.json["images"] = {{{"uri", "nowhere.png"}}, {{"bufferView", 99}, {"mimeType", "image/png"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = json::array({json::object()});
    b.json["extensionsUsed"] = {"VENDOR_thing"};
    b.json["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_transform"};
    b.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 12345;
    check_square(import_built(b));
}

TEST_CASE(
    "several primitives: vertices keep the accessors' order, shared accessors are taken per primitive") {
    GltfBuilder b = square();
    b.json["meshes"][0]["name"] = "table";
    json line = b.json["meshes"][0]["primitives"][0], second = line;
    line["mode"] = 1;
    second["attributes"]["NORMAL"] = b.floats({0, 3, 0, 0, 3, 0, 0, 3, 0, 0, 3, 0});
    b.json["meshes"][0]["primitives"].push_back(line);
    b.json["meshes"][0]["primitives"].push_back(second);
    const ImportedScene scene = import_built(b);
    REQUIRE(scene.meshes.size() == 1);
    const dfield::SceneMesh& mesh = scene.meshes[0];
    CHECK(mesh.name == "table");
    CHECK(mesh.source_mesh == 0);
    REQUIRE(mesh.primitives.size() == 2);
    CHECK(mesh.primitives[0].primitive == 0);
    CHECK(mesh.primitives[0].vertex_count == 4);
    CHECK(mesh.primitives[1].primitive == 2);
    CHECK(mesh.primitives[1].first_vertex == 4);
    CHECK(mesh.primitives[1].vertex_count == 4);
    CHECK(mesh.primitives[1].first_triangle == 2);
    CHECK(mesh.primitives[1].triangle_count == 2);
    CHECK(mesh.mesh.triangles[2] == glm::uvec3(4, 5, 6));
    CHECK(mesh.mesh.normals[0] == glm::vec3(0, 0, 1));  // computed
    CHECK(mesh.mesh.normals[7] == glm::vec3(0, 1, 0));  // the file's, made unit
}

TEST_CASE("vertices of glTF are never split by a crease angle") {
    GltfBuilder b;
    const int indices = b.accessor(bytes_of<std::uint8_t>({0, 1, 2, 2, 1, 3}), kUnsignedByte, "SCALAR", 6);
    b.mesh(b.floats({0, 0, 0, 1, 0, 1, 1, 1, 1, 2, 0, 0}), indices);
    b.node({{"mesh", 0}});
    const TestFolder folder;
    CHECK(import_scene(folder.write("a.glb", b.glb()), {.crease_degrees = 10})
              .meshes[0]
              .mesh.positions.size() == 4);
}

TEST_CASE("bad triangles are counted and the rest is kept in place") {
    GltfBuilder b;
    const float nan = std::nanf("");
    const int indices =
        b.accessor(bytes_of<std::uint16_t>({0, 1, 2, 0, 1, 9, 0, 1, 3, 0, 0, 1, 65535, 1, 2, 0, 1}),
                   kUnsignedShort, "SCALAR", 17);
    b.mesh(b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0}), indices);
    b.node({{"mesh", 0}});
    const ImportedScene scene = import_built(b);
    CHECK(scene.report.faces == 5);
    CHECK(scene.report.triangles == 1);
    CHECK(scene.report.index_out_of_range == 2);
    CHECK(scene.report.not_finite == 1);
    CHECK(scene.report.degenerate == 1);
    REQUIRE(scene.report.warnings.size() == 1);
    CHECK_THAT(scene.report.warnings[0], Contains("2 indices behind"));
    CHECK(scene.meshes[0].mesh.positions.size() == 4);
    CHECK(scene.meshes[0].mesh.positions[3] == glm::vec3(0));
}

TEST_CASE("nodes: TRS, matrices, hierarchies, mirrors") {
    GltfBuilder b = square();
    const float h = std::sqrt(0.5f);
    b.json["nodes"] = {
        {{"mesh", 0}, {"name", "root"}, {"children", {1, 2}}, {"translation", {10, 0, 0}}},
        {{"mesh", 0}, {"rotation", {0, 0, h, h}}, {"scale", {2, 1, 1}}},  // then turned by 90 degrees
        {{"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1}}, {"children", {3}}},
        {{"mesh", 0}, {"name", "leaf"}},
        {{"mesh", 0}, {"name", "in no scene"}}};
    const ImportedScene scene = import_built(b);
    REQUIRE(scene.instances.size() == 3);
    CHECK(scene.instances[0].source_node == 0);
    CHECK(scene.instances[1].source_node == 1);
    CHECK(scene.instances[2].source_node == 3);
    CHECK(scene.instances[1].name == "node_1");
    CHECK(scene.meshes.size() == 1);
    const std::vector<glm::vec3> p = world(scene);
    REQUIRE(p.size() == 12);
    CHECK(close(p[2], {12, 2, 0}));
    CHECK(close(p[4 + 1], {10, 4, 0}));  // (2,0,0) scaled to (4,0,0), turned to (0,4,0)
    CHECK(close(p[8 + 2], {8, 2, 5}));
    // A mirrored node turns the winding over; its normals stay on the same side of the surface.
    const TriangleMesh mesh = flatten_scene(scene);
    for (const glm::vec3& n : mesh.normals) CHECK(close(n, {0, 0, 1}));

    b.json.erase("scene");  // no default scene: every root
    CHECK(import_built(b).instances.size() == 4);
}

TEST_CASE("normals follow non-uniform scale, mirrors and singular transforms") {
    GltfBuilder b;
    b.mesh(b.floats({0, 0, 0, 1, 0, -1, 1, 1, -1}));  // normal (1, 0, 1)
    b.node({{"mesh", 0}, {"scale", {1, 1, 3}}});
    const auto normal_for = [&](const json& scale) {
        b.json["nodes"][0]["scale"] = scale;
        return flatten_scene(import_built(b)).normals[0];
    };
    CHECK(close(normal_for({1, 1, 1}), glm::normalize(glm::vec3(1, 0, 1))));
    CHECK(close(normal_for({1, 1, 3}), glm::normalize(glm::vec3(3, 0, 1))));
    CHECK(close(normal_for({-1, 1, 1}), glm::normalize(glm::vec3(-1, 0, 1))));
    CHECK(close(normal_for({-1, -1, -1}), glm::normalize(glm::vec3(-1, 0, -1))));
    CHECK(close(normal_for({1, 1, 0}), {0, 0, 1}));
}

TEST_CASE("EXT_mesh_gpu_instancing is the same as nodes, also with quantised rotations") {
    const float h = std::sqrt(0.5f);
    GltfBuilder nodes = square();
    nodes.json["nodes"] = {
        {{"children", {1, 2}}, {"translation", {1, 2, 3}}},
        {{"mesh", 0}, {"translation", {5, 0, 0}}, {"rotation", {0, 0, h, h}}, {"scale", {1, 2, 3}}},
        {{"mesh", 0}, {"translation", {0, 7, 0}}, {"rotation", {0, 1, 0, 0}}, {"scale", {-1, 1, 1}}}};
    const std::vector<glm::vec3> expected = world(import_built(nodes));
    for (const int type : {kFloat, kShort, kByte}) {
        GltfBuilder b = square();
        const int translation = b.floats({5, 0, 0, 0, 7, 0}), scale = b.floats({1, 2, 3, -1, 1, 1});
        // Normalised integers round sqrt(1/2); equal roundings cancel once the quaternion is made unit.
        const int rotation = type == kFloat ? b.floats({0, 0, h, h, 0, 1, 0, 0}, "VEC4", 4)
                             : type == kShort
                                 ? b.accessor(bytes_of<std::int16_t>({0, 0, 23170, 23170, 0, 32767, 0, 0}),
                                              kShort, "VEC4", 2, {{"normalized", true}})
                                 : b.accessor(bytes_of<std::int8_t>({0, 0, 90, 90, 0, 127, 0, 0}), kByte,
                                              "VEC4", 2, {{"normalized", true}});
        const json attributes = {{"TRANSLATION", translation}, {"ROTATION", rotation}, {"SCALE", scale}};
        b.json["nodes"][0] = {{"mesh", 0},
                              {"translation", {1, 2, 3}},
                              {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}};
        b.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
        const ImportedScene scene = import_built(b);
        REQUIRE(scene.instances.size() == 2);
        CHECK(scene.instances[1].gpu_instance == 1);
        CHECK(scene.instances[1].source_node == 0);
        const std::vector<glm::vec3> found = world(scene);
        REQUIRE(found.size() == expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) CHECK(close(found[i], expected[i]));
    }
}

TEST_CASE("a mesh or a node can be chosen by name") {
    GltfBuilder b = square();
    b.mesh(b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}));
    b.json["meshes"][0]["name"] = "top";
    b.json["nodes"] = {{{"name", "table"}, {"children", {1, 2}}, {"translation", {0, 0, 1}}},
                       {{"name", "plate"}, {"mesh", 0}},
                       {{"name", "legs"}, {"children", {3, 4}}},
                       {{"name", "leg"}, {"mesh", 1}},
                       {{"name", "leg"}, {"mesh", 1}, {"translation", {2, 0, 0}}}};
    const ImportedScene scene = import_built(b);
    CHECK(flatten_scene(scene).triangles.size() == 4);
    const TriangleMesh top = flatten_scene(scene, "top");
    CHECK(top.triangles.size() == 2);
    CHECK(top.positions[0].z == 0);                               // its own space
    CHECK(flatten_scene(scene, "mesh_1").triangles.size() == 1);  // once, though two nodes use it
    CHECK(flatten_scene(scene, {}, "table").triangles.size() == 4);
    const TriangleMesh legs = flatten_scene(scene, {}, "legs");
    CHECK(legs.triangles.size() == 2);
    CHECK(legs.positions[3] == glm::vec3(2, 0, 1));  // in the world
    CHECK(flatten_scene(scene, {}, "leg").triangles.size() == 2);
    CHECK_THROWS_WITH(flatten_scene(scene, "bottom"),
                      Contains("'bottom'") && Contains("'top'") && Contains("'mesh_1'"));
    CHECK_THROWS_WITH(flatten_scene(scene, {}, "chair"),
                      Contains("'chair'") && Contains("'legs'") && Contains("'plate'"));
    CHECK_THROWS_AS(flatten_scene(scene, "top", "legs"), dfield::InputError);
    b.json["meshes"][1]["name"] = "top";
    CHECK_THROWS_WITH(flatten_scene(import_built(b), "top"), Contains("several"));
}
