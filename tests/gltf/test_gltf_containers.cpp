#include <catch2/catch.hpp>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/import/gltf_uri.hpp"
#include "baker/output/gltf_output.hpp"
#include "baker/picture/image.hpp"
#include "tests/gltf/gltf_reader.hpp"

using namespace dfield;
using namespace dfield::test;
namespace fs = std::filesystem;

namespace {

void occlude(const fs::path& input, const fs::path& output) {
    const ImportedScene scene = import_scene(input);
    const auto visibility = test_visibility(scene);
    write_gltf_occlusion(input, output, scene, visibility, {});
    check_occlusion(output, scene, visibility);
}

void add_texture(SmallGltf& small, const std::string& uri) {
    small.json["images"] = Json::array({Json::object({{"uri", uri}, {"name", "picture"}})});
    small.json["textures"] = Json::array({Json::object({{"source", 0}})});
    small.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
}

std::vector<fs::path> names_in(const fs::path& folder) {
    std::vector<fs::path> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), folder));
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace

TEST_CASE("a GLB's chunk becomes a file beside the .gltf") {
    const fs::path folder = scratch("glb to gltf");
    SmallGltf().write_glb(folder / "in.glb");
    occlude(folder / "in.glb", folder / "out put.gltf");
    const GltfFile file = read_gltf(folder / "out put.gltf");
    CHECK(file.json["buffers"].size() == 1);
    CHECK(file.json["buffers"][0]["uri"] == "out%20put.bin");
    CHECK(fs::file_size(folder / "out put.bin") == file.json["buffers"][0]["byteLength"].get<std::size_t>());
}

TEST_CASE("in another folder the files of a .gltf are found again") {
    const fs::path folder = scratch("gltf to gltf");
    fs::create_directories(folder / "in" / "textures");
    fs::create_directories(folder / "common");
    write_png(folder / "in" / "textures" / "a b.png", Image(4, 4, {200, 100, 50}));
    write_png(folder / "common" / "c.png", Image(4, 4, {20, 10, 5}));
    SmallGltf small;
    add_texture(small, "textures/a%20b.png");
    small.json["images"].push_back({{"uri", "../common/c.png"}});
    small.json["images"].push_back({{"uri", "data:image/png;base64,iVBORw0KGgo="}});
    small.write_gltf(folder / "in" / "scene.gltf", "geometry.bin");
    fs::create_directories(folder / "out" / "deeper");
    occlude(folder / "in" / "scene.gltf", folder / "out" / "deeper" / "scene.gltf");

    const fs::path out = folder / "out" / "deeper";
    CHECK(names_in(out) ==
          std::vector<fs::path>{"geometry.bin", "scene.bin", "scene.gltf", "textures/a b.png"});
    CHECK(read_file(out / "geometry.bin") == small.bin);
    CHECK(read_file(out / "textures" / "a b.png") == read_file(folder / "in" / "textures" / "a b.png"));
    const GltfFile file = read_gltf(out / "scene.gltf");
    CHECK(file.json["buffers"].size() == 2);
    CHECK(file.json["buffers"][1]["uri"] == "scene.bin");
    CHECK(file.json["images"][0] == small.json["images"][0]);
    CHECK(file.json["images"][1]["uri"] == "../../common/c.png");
    CHECK(file.json["images"][2] == small.json["images"][2]);
    // The data URI above is no whole PNG: not for the validator.
    fs::remove_all(folder / "in"), fs::remove_all(folder / "out");
}

TEST_CASE("a file of other contents in the output's folder is not overwritten") {
    const fs::path folder = scratch("conflict");
    fs::create_directories(folder / "in");
    SmallGltf().write_gltf(folder / "in" / "scene.gltf", "geometry.bin");
    const ImportedScene scene = import_scene(folder / "in" / "scene.gltf");
    const auto visibility = test_visibility(scene);
    write_file_atomic(folder / "geometry.bin", std::string_view("somebody else's"));
    CHECK_THROWS_WITH(
        write_gltf_occlusion(folder / "in" / "scene.gltf", folder / "scene.gltf", scene, visibility, {}),
        Catch::Contains("geometry.bin") && Catch::Contains("another folder"));
    CHECK(read_file(folder / "geometry.bin").size() == 15);
    CHECK(!fs::exists(folder / "scene.gltf"));
}

TEST_CASE("a .gltf over itself keeps its buffer and gets another, however often") {
    const fs::path folder = scratch("in place");
    const SmallGltf small;
    small.write_gltf(folder / "scene.gltf", "scene.bin");
    occlude(folder / "scene.gltf", folder / "scene.gltf");
    occlude(folder / "scene.gltf", folder / "scene.gltf");
    CHECK(read_file(folder / "scene.bin") == small.bin);
    CHECK(names_in(folder) ==
          std::vector<fs::path>{"scene.bin", "scene.gltf", "scene_occlusion.bin", "scene_occlusion2.bin"});
}

TEST_CASE("a .gltf becomes one self-contained GLB") {
    const fs::path folder = scratch("gltf to glb");
    SmallGltf small;
    write_png(folder / "picture.png", Image(4, 4, {200, 100, 50}));
    add_texture(small, "picture.png");
    // A second buffer, inline, with the texture coordinates.
    small.json["buffers"].push_back(
        {{"byteLength", 32},
         {"uri", "data:application/octet-stream;base64,AAAAAAAAAAAAAIA/AAAAAAAAgD8AAIA/AAAAAAAAgD8="}});
    small.json["bufferViews"][2] = {{"buffer", 1}, {"byteLength", 32}};
    small.write_gltf(folder / "in.gltf", "in.bin");
    fs::create_directories(folder / "elsewhere");
    occlude(folder / "in.gltf", folder / "elsewhere" / "out.glb");

    CHECK(names_in(folder / "elsewhere") == std::vector<fs::path>{"out.glb"});
    const GltfFile file = read_gltf(folder / "elsewhere" / "out.glb");
    REQUIRE(file.json["buffers"].size() == 1);
    CHECK(!file.json["buffers"][0].contains("uri"));
    CHECK(file.json["buffers"][0]["name"] == "geometry");
    CHECK(std::equal(small.bin.begin(), small.bin.end(), file.bin.begin()));
    CHECK(file.accessor(2) == std::vector<double>{0, 0, 1, 0, 1, 1, 0, 1});
    const Json& image = file.json["images"][0];
    CHECK(!image.contains("uri"));
    CHECK(image["mimeType"] == "image/png");
    CHECK(image["name"] == "picture");
    const Json& view = file.json["bufferViews"][image["bufferView"].get<std::size_t>()];
    const std::vector<std::byte> picture = read_file(folder / "picture.png");
    REQUIRE(view["byteLength"] == picture.size());
    CHECK(std::equal(picture.begin(), picture.end(),
                     file.bin.begin() + view["byteOffset"].get<std::ptrdiff_t>()));
}

TEST_CASE("a GLB keeps the files beside it as files") {
    const fs::path folder = scratch("glb with files");
    fs::create_directories(folder / "in");
    write_png(folder / "in" / "picture.png", Image(4, 4, {200, 100, 50}));
    SmallGltf small;
    add_texture(small, "picture.png");
    small.write_glb(folder / "in" / "in.glb");
    occlude(folder / "in" / "in.glb", folder / "out.glb");
    CHECK(read_gltf(folder / "out.glb").json["images"] == small.json["images"]);
    CHECK(read_file(folder / "picture.png") == read_file(folder / "in" / "picture.png"));
}

TEST_CASE("URIs and relative paths") {
    CHECK(relative_path_of_uri("a%20b/c.bin") == fs::path("a b/c.bin"));
    CHECK(relative_path_of_uri("100%.bin") == fs::path("100%.bin"));
    CHECK(relative_path_of_uri("./x:y.bin") == fs::path("./x:y.bin"));
    for (const char* uri : {"", "/etc/passwd", "%2Fetc/passwd",
                            "data:;base64,AA==", "https://example.org/a.bin", "file:a", "a%00b"})
        CHECK(!relative_path_of_uri(uri));
    CHECK(uri_of_relative_path(fs::path(u8"ä b/c#1.bin")) == "%C3%A4%20b/c%231.bin");
    CHECK(relative_path_of_uri(uri_of_relative_path(fs::path(u8"ä %41?/&.bin"))) ==
          fs::path(u8"ä %41?/&.bin"));
}
