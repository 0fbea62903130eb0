// `dfield volume render` as a user runs it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "baker/picture/image.hpp"
#include "tests/cli/command.hpp"

using namespace dfield::test;
using dfield::Image;

namespace {

constexpr int kSize = 24;

// A cube of voxels as a raw file.
template<class T, class Value>
std::string cube(const Value& value) {
    std::string bytes;
    for (int z = 0; z < kSize; ++z)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) bytes += bytes_of<T>({static_cast<T>(value(x, y, z))});
    return bytes;
}

double distance_to_sphere(int x, int y, int z) {
    const double middle = 0.5 * (kSize - 1);
    return std::sqrt((x - middle) * (x - middle) + (y - middle) * (y - middle) +
                     (z - middle) * (z - middle)) -
           8;
}

std::string nrrd(const std::string& type, const std::string& voxels) {
    return "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: 24 24 24\nendian: little\nencoding: raw\n\n" +
           voxels;
}

Arguments render(Arguments more) {
    Arguments arguments{"volume", "render", "--width", "60", "--height", "40", "--samples", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

}  // namespace

TEST_CASE("volume render draws a surface and a volume") {
    const Shell shell;
    shell.write("sdf.nrrd", nrrd("float", cube<float>(distance_to_sphere)));
    shell.write("ball.raw", cube<std::uint8_t>([](int x, int y, int z) {
                    return distance_to_sphere(x, y, z) < 0 ? 200 : 0;
                }));
    shell.write("half.nrrd", nrrd("uchar", cube<std::uint8_t>([](int, int, int) { return 51; })));
    shell.write("tf.json", R"({"points": [[0, 0], [200, 1]], "colors": [[0, 0, 1, 0]]})");

    const Run surface = shell.run(
        render({"sdf.nrrd", "--surface", "--background", "0", "0", "0", "-o", "a.png", "--json", "-"}));
    INFO(surface.err);
    REQUIRE(surface.exit_code == 0);
    CHECK(surface.json()["width"] == 60);
    CHECK(surface.json()["dims"] == Json({24, 24, 24}));
    CHECK(surface.json()["image"] == "a.png");
    CHECK(surface.json()["seconds"] > 0);
    const Image lit = dfield::read_png(shell.folder() / "a.png");
    REQUIRE(lit.width == 60);
    REQUIRE(lit.height == 40);
    CHECK(*std::max_element(lit.rgb.begin(), lit.rgb.end()) >= 250);  // faces the light at the eye
    CHECK(lit.at(30, 20)[0] > 128);
    CHECK(lit.at(0, 0)[0] == 0);  // background

    REQUIRE(shell
                .run(render({"sdf.nrrd", "--surface", "--unshaded", "--visibility", "half.nrrd",
                             "--background", "0", "0", "1", "-o", "b.png"}))
                .exit_code == 0);
    const Image dark = dfield::read_png(shell.folder() / "b.png");
    CHECK(dark.at(30, 20)[0] == 51);
    CHECK(dark.at(0, 0)[0] == 0);
    CHECK(dark.at(0, 0)[2] == 255);

    REQUIRE(shell
                .run(render({"ball.raw", "--dims", "24x24x24", "--type", "u8", "--tf", "tf.json",
                             "--unshaded", "-o", "c.png"}))
                .exit_code == 0);
    const Image green = dfield::read_png(shell.folder() / "c.png");
    CHECK(green.at(30, 20)[1] == 255);
    CHECK(green.at(30, 20)[0] == 0);
    CHECK(green.at(0, 0)[0] == 255);
}

TEST_CASE("volume render --iso: as the swept volumes' picture") {
    const Shell shell;
    // Inside is what is high: the ball with a crater that faces the eye.
    shell.write("crater.nrrd", nrrd("float", cube<float>([](int x, int y, int z) {
                                        return std::min(-distance_to_sphere(x, y, z),
                                                        distance_to_sphere(x - 4, y + 7, z - 3) + 3);
                                    })));
    REQUIRE(shell.run({"volume", "sweep", "crater.nrrd", "--iso", "0", "-o", "ao.nrrd", "--sdf", "sdf.nrrd"})
                .exit_code == 0);
    const Arguments ways[] = {{"--shading", "local"}, {"--shading", "ao"}, {}};
    const Arguments same[] = {{}, {"--unshaded", "--visibility", "ao.nrrd"}, {"--visibility", "ao.nrrd"}};
    for (int i = 0; i < 3; ++i) {
        Arguments swept{"crater.nrrd", "--iso", "0", "-o", "a.png", "--json", "-"};
        swept.insert(swept.end(), ways[i].begin(), ways[i].end());
        const Run run = shell.run(render(swept));
        INFO(run.err);
        REQUIRE(run.exit_code == 0);
        CHECK(run.json()["iso"] == 0);
        CHECK(run.json()["seconds_sweep"] > 0);
        Arguments drawn{"sdf.nrrd", "--surface", "-o", "b.png"};
        drawn.insert(drawn.end(), same[i].begin(), same[i].end());
        REQUIRE(shell.run(render(drawn)).exit_code == 0);
        const Image a = dfield::read_png(shell.folder() / "a.png");
        const Image b = dfield::read_png(shell.folder() / "b.png");
        CHECK(a.rgb == b.rgb);
        const auto [least, most] = std::minmax_element(a.rgb.begin(), a.rgb.end());
        CHECK(int{*least} < 230);  // not the background alone
        CHECK(int{*most} == 255);
    }
}

TEST_CASE("volume render: mistakes") {
    const Shell shell;
    shell.write("sdf.nrrd", nrrd("float", cube<float>(distance_to_sphere)));
    shell.write("small.nrrd", "NRRD0001\ntype: uchar\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n\nx");
    shell.write("short.nrrd", nrrd("short", cube<std::int16_t>([](int, int, int) { return 1; })));
    shell.write("tf.json", R"({"points": [[0, 2]]})");
    struct Mistake {
        Arguments arguments;
        int exit_code;
        std::string said;
    };
    for (const auto& [more, exit_code, said] : std::vector<Mistake>{
             {{"sdf.nrrd", "--surface"}, 2, "--output is required"},
             {{"sdf.nrrd", "-o", "a.png"}, 2, "--tf FILE or --surface"},
             {{"sdf.nrrd", "--surface", "--iso", "0", "-o", "a.png"}, 2, "--tf FILE or --surface"},
             {{"sdf.nrrd", "--iso", "99", "-o", "a.png"}, 2, "no surface there"},
             {{"sdf.nrrd", "--iso", "0", "--shading", "some", "-o", "a.png"}, 2, "--shading"},
             {{"sdf.nrrd", "--surface", "--shading", "ao", "-o", "a.png"}, 2, "--iso"},
             {{"sdf.nrrd", "--tf", "tf.json", "--shading", "ao", "-o", "a.png"}, 2, "--clip"},
             {{"sdf.nrrd", "--surface", "--gain", "2", "-o", "a.png"}, 2, "--gain goes with --tf"},
             {{"sdf.nrrd", "--surface", "--form", "paper", "-o", "a.png"}, 2, "--iso"},
             {{"sdf.nrrd", "--iso", "0", "--unshaded", "-o", "a.png"}, 2, "--unshaded"},
             {{"sdf.nrrd", "--shading", "ao", "--unshaded", "-o", "a.png"}, 2, "--unshaded"},
             {{"sdf.nrrd", "--surface", "--tf", "tf.json", "-o", "a.png"}, 2, "--tf FILE or --surface"},
             {{"sdf.nrrd", "--surface", "-o", "a.jpg"}, 2, ".png"},
             {{"sdf.nrrd", "--surface", "-o", "a.png", "--view", "0", "0", "0"}, 2, "no direction"},
             {{"sdf.nrrd", "--surface", "-o", "a.png", "--view", "0", "nan", "0"}, 2, "--view"},
             {{"sdf.nrrd", "--surface", "-o", "a.png", "--up", "0", "0"}, 2, "--up"},
             {{"sdf.nrrd", "--surface", "-o", "a.png", "--background", "0", "0", "2"}, 2, "--background"},
             {{"sdf.nrrd", "--surface", "-o", "a.png", "--step", "0"}, 2, "--step"},
             {{"sdf.nrrd", "--surface", "-o", "a.png", "--fov", "180"}, 2, "--fov"},
             {{"sdf.nrrd", "--tf", "tf.json", "-o", "a.png"},
              3,
              "tf.json: point 0 has an opacity outside 0..1"},
             {{"sdf.nrrd", "--tf", "none.json", "-o", "a.png"}, 3, "none.json: no such file"},
             {{"none.nrrd", "--surface", "-o", "a.png"}, 3, "none.nrrd: no such file"},
             {{"sdf.nrrd", "--surface", "--visibility", "small.nrrd", "-o", "a.png"}, 3, "1 x 1 x 1"},
             {{"sdf.nrrd", "--surface", "--visibility", "short.nrrd", "-o", "a.png"}, 3, "not i16"},
             {{"sdf.nrrd", "--surface", "-o", "none/a.png"}, 4, "does not exist"}})
        check_mistake(shell, render(more), exit_code, said);
}
