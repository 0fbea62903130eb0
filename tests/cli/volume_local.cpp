// `dfield volume lao`, `cao` and `render --clip` as a user runs them.
#include <algorithm>
#include <catch2/catch.hpp>

#include "baker/picture/image.hpp"
#include "baker/volume/read_volume.hpp"
#include "tests/cli/command.hpp"

using namespace dfield::test;

namespace {

constexpr int kSize = 40;

// A ball of matter in the middle, 12 voxels of radius, on a grid that is 0.5 wide and begins at (-10, -10,
// -10).
std::string ball() {
    std::string bytes =
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 40 40 40\nspace: right-anterior-superior\n"
        "space directions: (0.5,0,0) (0,0.5,0) (0,0,0.5)\nspace origin: (-10,-10,-10)\nendian: little\n"
        "encoding: raw\n\n";
    for (int z = 0; z < kSize; ++z)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const int dx = x - 20, dy = y - 20, dz = z - 20;
                bytes += static_cast<char>(dx * dx + dy * dy + dz * dz < 144 ? 100 : 0);
            }
    return bytes;
}

struct Scene : Shell {
    Scene() {
        write("ball.nrrd", ball());
        write("tf.json", R"({"points": [[0, 0], [100, 0.8]]})");
        write("tf.txt", "# value, opacity\n0, 0\n100 0.8\n");
        write("colours.txt", "0 1 0 0 0\n100 1 0 0 0.8\n");
        write("tetrahedron.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
        write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
    }
    Run volume(const char* command, Arguments more) const {
        Arguments arguments{"volume", command, "ball.nrrd", "--rays", "26", "--samples", "10"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }
    std::vector<float> values(const std::string& file) const {
        return float_values(dfield::read_volume(folder() / file));
    }
};

std::size_t voxel(std::size_t x, std::size_t y, std::size_t z) {
    return x + kSize * (y + kSize * z);
}

}  // namespace

TEST_CASE("volume lao writes factors and says how fast") {
    const Scene scene;
    const Run run =
        scene.volume("lao", {"--tf", "tf.json", "-o", "ao.nrrd", "--json", "-", "--threads", "2"});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    const Json json = run.json();
    CHECK(json["voxels"] == 64000);
    CHECK(json["rays"] == 26);
    CHECK(json["recomputed_fraction"] == 1);
    CHECK(json["seconds"] > 0);
    CHECK(json["gsamples_per_s"].get<double>() ==
          Approx(64000.0 * 26 * 9 / json["seconds"].get<double>() / 1e9).epsilon(1e-3));
    const std::vector<float> ao = scene.values("ao.nrrd");
    CHECK(ao[voxel(0, 0, 0)] == 1);
    CHECK(ao[voxel(20, 20, 20)] < 0.2f);
    CHECK(ao[voxel(20, 20, 33)] > ao[voxel(20, 20, 31)]);

    // The same transfer function as text, on one thread.
    for (const char* tf : {"tf.txt", "colours.txt"}) {
        REQUIRE(scene.volume("lao", {"--tf", tf, "-o", "text.nrrd", "--threads", "1"}).exit_code == 0);
        CHECK(scene.values("text.nrrd") == ao);
    }
    // One ray in one direction of the grid is a weight of one.
    scene.write("weights.txt", "26 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0");
    REQUIRE(
        scene.volume("lao", {"--tf", "tf.json", "-o", "one.nrrd", "--weights", "weights.txt"}).exit_code ==
        0);
    CHECK(scene.values("one.nrrd") != ao);
}

TEST_CASE("volume lao --approximate is near, and says so") {
    const Scene scene;
    scene.write("haze.json", R"({"points": [[0, 0], [100, 0.1]]})");  // light comes through
    const auto factors = [&](const char* output, Arguments more) {
        Arguments arguments{"volume",        "lao", "ball.nrrd", "--tf", "haze.json", "--rays", "26",
                            "--ray-samples", "40",  "-o",        output, "--json",    "-"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Run run = scene.run(arguments);
        INFO(run.err);
        REQUIRE(run.exit_code == 0);
        CHECK(run.json()["approximate"] == (more.front() == "--approximate"));
        return scene.values(output);
    };
    const auto exact = factors("exact.nrrd", {"--threads", "1"}),
               near = factors("near.nrrd", {"--approximate"});
    float largest = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) largest = std::max(largest, std::abs(exact[i] - near[i]));
    CHECK(largest > 0);
    CHECK(largest < 0.02f);
    CHECK(scene.volume("cao", {"--tf", "tf.json", "--clip", "cube.obj", "--approximate"}).exit_code == 2);
}

TEST_CASE("volume cao is local ambient occlusion of the clipped volume") {
    const Scene scene;
    scene.write("frames.json", R"({"frames": [{"move": [0, 0, 0]}, {"move": [3, 0, 0], "turn": [0, 0, 1, 40]},
        [{"mesh": 0, "pose": [4,0,0,0, 0,4,0,0, 0,0,4,0, -2,-2,-2,1]}], {"hidden": true}]})");
    for (const Arguments& more :
         {Arguments{"--clip", "tetrahedron.obj"},
          Arguments{"--probe", "tetrahedron.obj", "--clip-method", "exact"},
          Arguments{"--clip", "tetrahedron.obj", "--dilation-maps"},
          Arguments{"--clip", "tetrahedron.obj", "--clip-samples", "0", "--clip-resolution", "20"}}) {
        Arguments arguments{"--tf",        "tf.json",  "-o",     "ao.nrrd", "--frames",
                            "frames.json", "--verify", "--json", "-"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Run run = scene.volume("cao", arguments);
        INFO(run.err);
        REQUIRE(run.exit_code == 0);
        const Json json = run.json();
        CHECK(json["identical"] == true);
        CHECK(json["voxels"] == 64000);
        REQUIRE(json["frames"].size() == 4);
        CHECK(json["frames"][0]["recomputed_fraction"] > 0);
        CHECK(json["frames"][0]["recomputed_fraction"] < 1);
        CHECK(json["frames"][3]["changed_fraction"] > 0);
        CHECK(json["speedup_over_lao"].get<double>() ==
              Approx(json["seconds_lao"].get<double>() / json["seconds"].get<double>()).epsilon(1e-3));
    }
    // Without a pose the mesh is centred, a third of the diagonal large: the ball's middle is cut, its top is
    // not.
    REQUIRE(scene.volume("lao", {"--tf", "tf.json", "-o", "whole.nrrd"}).exit_code == 0);
    REQUIRE(scene.volume("cao", {"--tf", "tf.json", "-o", "cut.nrrd", "--clip", "cube.obj"}).exit_code == 0);
    const auto whole = scene.values("whole.nrrd"), cut = scene.values("cut.nrrd");
    CHECK(cut[voxel(20, 20, 20)] > whole[voxel(20, 20, 20)]);
    CHECK(cut[voxel(20, 20, 37)] == whole[voxel(20, 20, 37)]);
    CHECK(whole[voxel(20, 20, 37)] < 1);
}

TEST_CASE("volume render --clip draws what is left, frame by frame") {
    const Scene scene;
    scene.write("frames.json", R"([{"move": [0, 0, 0]}, {"hidden": true}])");
    const std::string pose = "9,0,0,0, 0,9,0,0, 0,0,9,0, 0,0,0,1";
    const auto render = [&](Arguments more) {
        Arguments arguments{"volume",
                            "render",
                            "ball.nrrd",
                            "--tf",
                            "tf.json",
                            "--clip",
                            "tetrahedron.obj",
                            "--pose",
                            pose,
                            "--width",
                            "60",
                            "--height",
                            "40",
                            "--samples",
                            "1",
                            "--rays",
                            "14",
                            "--view",
                            "1",
                            "1",
                            "1",
                            "--background",
                            "0",
                            "0",
                            "0"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Run run = scene.run(arguments);
        INFO(run.err);
        REQUIRE(run.exit_code == 0);
        return run;
    };
    const Json json = render({"-o", "cut.png", "--frames", "frames.json", "--json", "-"}).json();
    CHECK(json["images"] == Json({"cut-0000.png", "cut-0001.png"}));
    const auto cut = dfield::read_png(scene.folder() / "cut-0000.png"),
               whole = dfield::read_png(scene.folder() / "cut-0001.png");
    CHECK(cut.rgb != whole.rgb);
    render({"-o", "unclipped.png", "--ao", "unclipped"});
    render({"-o", "none.png", "--ao", "none"});
    // In the middle of the cut: black with factors of the whole volume, white without any, in between as it
    // should be.
    const int unclipped = dfield::read_png(scene.folder() / "unclipped.png").at(30, 20)[0],
              contextual = cut.at(30, 20)[0],
              none = dfield::read_png(scene.folder() / "none.png").at(30, 20)[0];
    CHECK(unclipped < contextual);
    CHECK(contextual < none);
    CHECK(none > 240);
    // Factors alone, twice as light as they say, unless told otherwise.
    const auto picture = [&](Arguments more) {
        more.insert(more.end(), {"-o", "a.png"});
        render(more);
        return dfield::read_png(scene.folder() / "a.png").rgb;
    };
    CHECK(picture({"--unshaded"}) == cut.rgb);
    CHECK(picture({"--shading", "both"}) != cut.rgb);
    CHECK(picture({"--shading", "local"}) == picture({"--shading", "both", "--ao", "none"}));
    CHECK(picture({"--shading", "local"}) != picture({"--unshaded", "--ao", "none"}));
    render({"-o", "dim.png", "--gain", "1"});
    const int dim = dfield::read_png(scene.folder() / "dim.png").at(30, 20)[0];
    CHECK(contextual <= 2 * dim + 1);  // less where twice the factors is more than 1
    CHECK(contextual > 1.6 * dim);
}

TEST_CASE("volume lao and cao refuse what makes no sense") {
    const Scene scene;
    scene.write("bad.txt", "0 0\n1 x\n");
    scene.write("ragged.txt", "0 0\n1 1 1 1 1\n");
    scene.write("frames.json", R"([{"mesh": 4}])");
    CHECK(scene.volume("lao", {"--tf", "bad.txt", "-o", "a.nrrd"}).exit_code == 3);
    CHECK(scene.volume("lao", {"--tf", "ragged.txt", "-o", "a.nrrd"}).exit_code == 3);
    CHECK(scene.volume("lao", {"--tf", "tf.json", "-o", "a.png"}).exit_code == 2);
    CHECK(scene.volume("lao", {"-o", "a.nrrd"}).exit_code == 2);
    CHECK(scene.volume("cao", {"--tf", "tf.json"}).exit_code == 2);
    const Run open = scene.volume("cao", {"--tf", "tf.json", "--clip", "open.obj"});
    CHECK(open.exit_code == 3);
    CHECK(contains(open.err, "not closed"));
    CHECK(scene.volume("cao", {"--tf", "tf.json", "--clip", "cube.obj", "--pose", "1,2,3"}).exit_code == 2);
    CHECK(scene.volume("lao", {"--tf", "tf.json", "-o", "a.nrrd", "--samples", "4", "--ray-samples", "5"})
              .exit_code == 2);
    CHECK(
        scene.volume("cao", {"--tf", "tf.json", "--clip", "cube.obj", "--frames", "frames.json"}).exit_code ==
        3);
    const std::vector<std::string> files = scene.list();
    CHECK(std::find(files.begin(), files.end(), "a.nrrd") == files.end());
}
