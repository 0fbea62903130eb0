// PNGs with a JSON file beside them.
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "baker/screen/png_channels.hpp"
#include "tests/screen_files/buffers.hpp"

using namespace dfield;
using namespace dfield::test;
using Catch::Contains;
using nlohmann::json;

namespace {

// A G-buffer of PNGs whose JSON was changed.
struct Written {
    TestFolder folder;
    json description;

    Written() {
        write_gbuffer(folder.path() / "a.json", small_buffer());
        description = json::parse(text_of(folder.path() / "a.json"));
    }
    std::string error(const std::function<void(json&)>& change) const {
        json changed = description;
        change(changed);
        return error_of(folder.write("changed.json", changed.dump()));
    }
};

}  // namespace

TEST_CASE("PNG: what is written is read back to 16 bits") {
    const TestFolder folder;
    const GBuffer buffer = small_buffer();
    write_gbuffer(folder.path() / "a.json", buffer);
    CHECK(folder.files() == 5);
    const GBuffer read = read_gbuffer(folder.path() / "a.json");
    REQUIRE(read.pixels() == buffer.pixels());
    CHECK(read.camera.offset == buffer.camera.offset);
    CHECK(read.camera.to_world == buffer.camera.to_world);
    for (std::size_t i = 0; i < buffer.pixels(); ++i) {
        if (i == 9) {
            CHECK(read.depth[i] == kSky);
            continue;
        }
        CHECK(read.depth[i] == Approx(buffer.depth[i]).margin(4.0 / 65535));
        CHECK(glm::length(read.normals[i] - buffer.normals[i]) < 1e-4f);
        CHECK(glm::length(read.albedo[i] - buffer.albedo[i]) < 1e-4f);
        CHECK(glm::length(read.radiance[i] - buffer.radiance[i]) < 2e-4f);
    }
    // A picture of sky alone.
    GBuffer sky = buffer;
    std::fill(sky.depth.begin(), sky.depth.end(), kSky);
    write_gbuffer(folder.path() / "sky.json", sky);
    CHECK(read_gbuffer(folder.path() / "sky.json").depth == sky.depth);
}

TEST_CASE("PNG: device depth and 8 bits") {
    const TestFolder folder;
    write_png_channels(folder.path() / "d.png", {3, 1, 1, {0, 0x8000, 0xffff}});
    folder.write("a.json", R"({"camera": {"half_width": 1, "half_height": 1, "near": 8, "far": 1},
                               "depth": {"file": "d.png", "encoding": "device"}})");
    const GBuffer reversed = read_gbuffer(folder.path() / "a.json");
    CHECK(reversed.depth[0] == kSky);
    CHECK(reversed.depth[1] == Approx(8 / (1 + 7 * 32768.0 / 65535)));
    CHECK(reversed.depth[2] == Approx(1));
}

TEST_CASE("PNG: errors say what is wrong") {
    const Written written;
    CHECK(written.error([](json&) {}) == "no error");
    CHECK_THAT(written.error([](json& d) { d.erase("depth"); }), Contains("names no depth"));
    CHECK_THAT(written.error([](json& d) { d.erase("camera"); }), Contains("which camera"));
    CHECK_THAT(written.error([](json& d) { d["depth"] = "a-depth.png"; }), Contains("no object with a file"));
    CHECK_THAT(written.error([](json& d) { d["depth"]["file"] = "none.png"; }),
               Contains("none.png: no such file"));
    CHECK_THAT(written.error([](json& d) { d["depth"]["file"] = "/etc/passwd"; }),
               Contains("no relative path"));
    CHECK_THAT(written.error([](json& d) { d["depth"]["file"] = "changed.json"; }), Contains("not a PNG"));
    CHECK_THAT(written.error([](json& d) { d["depth"]["file"] = "a-normals.png"; }),
               Contains("grey PNG is wanted"));
    CHECK_THAT(written.error([](json& d) { d["normals"]["file"] = "a-depth.png"; }),
               Contains("three channels"));
    CHECK_THAT(written.error([](json& d) { d["depth"]["to"] = 0; }), Contains("to is not above from"));
    CHECK_THAT(written.error([](json& d) { d["radiance"]["scale"] = "much"; }), Contains("no finite number"));
    write_png_channels(written.folder.path() / "small.png", {2, 2, 3, std::vector<std::uint16_t>(12)});
    CHECK_THAT(written.error([](json& d) { d["albedo"]["file"] = "small.png"; }),
               Contains("albedo has 2 x 2 pixels, the depth 7 x 5"));
    CHECK_THAT(error_of(written.folder.write("b.json", "{")), Contains("no JSON object"));
    CHECK_THAT(error_of(written.folder.path() / "c.json"), Contains("no such file"));
    const GBuffer buffer = small_buffer();
    CHECK_THROWS_WITH(write_gbuffer(written.folder.path() / "a.tif", buffer), Contains(".exr"));
    CHECK_THROWS_AS(write_gbuffer(written.folder.path() / "none" / "a.exr", buffer), OutputError);
}
