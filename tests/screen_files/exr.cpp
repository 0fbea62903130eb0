// OpenEXR in and out.
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <functional>

#include "tests/screen_files/buffers.hpp"

using namespace dfield;
using namespace dfield::test;
using Catch::Contains;

namespace {

// A 4 x 3 file with these channels, every value `value`.
std::filesystem::path exr(const TestFolder& folder, const std::vector<std::string>& channels, float value,
                          Imf::PixelType type = Imf::FLOAT,
                          const std::function<void(Imf::Header&)>& change = {}) {
    const std::filesystem::path path = folder.path() / "a.exr";
    Imf::Header header(4, 3);
    if (change) change(header);
    std::vector<float> floats(12, value);
    std::vector<half> halves(12, half(value));
    Imf::FrameBuffer frame;
    const Imath::V2i first = header.dataWindow().min;
    for (const std::string& name : channels) {
        header.channels().insert(name, Imf::Channel(type));
        const std::size_t size = type == Imf::FLOAT ? 4 : 2;
        frame.insert(name, Imf::Slice::Make(
                               type, type == Imf::FLOAT ? static_cast<void*>(floats.data()) : halves.data(),
                               first, 4, 3, size, 4 * size));
    }
    Imf::OutputFile file(path.string().c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(3);
    return path;
}

ScreenCamera lens() {
    ScreenCamera camera;
    camera.half_height = 0.5f;
    return camera;
}

}  // namespace

TEST_CASE("EXR: what is written is read back, bit for bit") {
    const TestFolder folder;
    GBuffer buffer = small_buffer();
    for (const bool all : {true, false}) {
        if (!all) buffer.albedo.clear(), buffer.normals.clear(), buffer.radiance.clear();
        write_gbuffer(folder.path() / "a.exr", buffer);
        CHECK(folder.files() == 1);
        const GBuffer read = read_gbuffer(folder.path() / "a.exr");
        CHECK(read.width == 7);
        CHECK(read.height == 5);
        CHECK(read.depth == buffer.depth);
        CHECK(read.normals == buffer.normals);
        CHECK(read.albedo == buffer.albedo);
        CHECK(read.radiance == buffer.radiance);
        CHECK(read.camera.to_world == buffer.camera.to_world);
        CHECK(read.camera.half_width == buffer.camera.half_width);
        CHECK(read.camera.offset == buffer.camera.offset);
        CHECK(read.camera.near == buffer.camera.near);
        CHECK(read.camera.far == kSky);
        CHECK_FALSE(read.camera.orthographic);
    }
}

TEST_CASE("EXR: files of other programs") {
    const TestFolder folder;
    const ScreenCamera camera = lens();
    const GBuffer halves =
        read_gbuffer(exr(folder, {"depth.Z", "Normal.X", "Normal.Y", "Normal.Z"}, 1.5f, Imf::HALF), &camera);
    CHECK(halves.depth == std::vector<float>(12, 1.5f));
    CHECK(halves.normals == std::vector<glm::vec3>(12, glm::vec3(1.5f)));
    CHECK(halves.albedo.empty());
    CHECK(halves.camera.half_height == 0.5f);
    CHECK(halves.camera.half_width == Approx(0.5 * 4 / 3));
    // NaN, zero and less are sky.
    for (const float sky : {NAN, 0.0f, -1.0f, kSky})
        CHECK(read_gbuffer(exr(folder, {"Z"}, sky), &camera).depth == std::vector<float>(12, kSky));
    // Reversed device depth with an infinite far plane: 0.25 of near 0.5 is depth 2.
    const auto reversed = [](Imf::Header& header) {
        header.insert("dfield",
                      Imf::StringAttribute(
                          R"({"camera": {"half_width": 1, "half_height": 1, "near": null, "far": 0.5},
                                        "depth": {"encoding": "device"}})"));
    };
    CHECK(read_gbuffer(exr(folder, {"Z"}, 0.25f, Imf::FLOAT, reversed)).depth ==
          std::vector<float>(12, 2.0f));
    // A data window that does not begin at 0 0.
    const auto moved = [](Imf::Header& header) {
        header.dataWindow() = header.displayWindow() = {{5, -2}, {8, 0}};
    };
    CHECK(read_gbuffer(exr(folder, {"Z"}, 3, Imf::FLOAT, moved), &camera).depth ==
          std::vector<float>(12, 3.0f));
}

TEST_CASE("EXR: errors say what is missing") {
    const TestFolder folder;
    CHECK_THAT(error_of(exr(folder, {"Z"}, 1)), Contains("which camera") && Contains("--fov"));
    const ScreenCamera camera = lens();
    const auto error = [&](const std::filesystem::path& path) {
        try {
            read_gbuffer(path, &camera);
        } catch (const InputError& caught) {
            return std::string(caught.what());
        }
        return std::string("no error");
    };
    CHECK_THAT(error(exr(folder, {"R", "G", "B"}, 1)), Contains("no channel Z"));
    CHECK_THAT(error(exr(folder, {"Z", "N.X", "N.Z"}, 1)), Contains("N.X, N.Y, N.Z (normals), but not all"));
    CHECK_THAT(error(exr(folder, {"Z"}, 1, Imf::FLOAT,
                         [](Imf::Header& header) {
                             header.displayWindow() = {{0, 0}, {7, 7}};
                         })),
               Contains("display window"));
    for (const auto& [attribute, said] : std::vector<std::pair<std::string, std::string>>{
             {"[]", "no JSON object"},
             {R"({"camera": 1})", "camera is no object"},
             {R"({"camera": {"half_width": 1}})", "half_height is missing"},
             {R"({"camera": {"half_width": 1e99, "half_height": 1}})", "half_width is no finite number"},
             {R"({"camera": {"half_width": 1, "half_height": 1, "projection": "fisheye"}})",
              "neither perspective"},
             {R"({"camera": {"half_width": 1, "half_height": 1, "near": 1, "far": 1}})", "the same"},
             {R"({"camera": {"half_width": 1, "half_height": 1, "to_world": [1, 2]}})", "array of 16"},
             {R"({"camera": {"half_width": 1, "half_height": 1,
                  "to_world": [2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}})",
              "no rotation"},
             {R"({"camera": {"half_width": 1, "half_height": 1,
                  "to_world": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}})",
              "mirrors"},
             {R"({"depth": {"encoding": "logarithmic"}})", "neither linear nor device"},
             {R"({"camera": {"half_width": 1, "half_height": 1}, "depth": {"encoding": "device"}})",
              "near and far, both above 0"},
             {R"({"camera": {"projection": "orthographic", "half_width": 1, "half_height": 1, "near": 1},
                  "depth": {"encoding": "device"}})",
              "near and far, both finite"}}) {
        INFO(attribute);
        CHECK_THAT(error(exr(folder, {"Z"}, 1, Imf::FLOAT,
                             [&text = attribute](Imf::Header& header) {
                                 header.insert("dfield", Imf::StringAttribute(text));
                             })),
                   Contains(said));
    }
}
