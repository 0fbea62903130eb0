// `dfield screen` as a user runs it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "baker/file_io.hpp"
#include "baker/picture/image.hpp"
#include "baker/screen/gbuffer.hpp"
#include "tests/cli/command.hpp"
#include "tests/cli/json_checks.hpp"
#include "tests/test_data.hpp"

using namespace dfield::test;
using dfield::GBuffer;
using dfield::Image;

namespace {

Arguments screen(const std::string& file, Arguments more, const std::string& size = "64x48") {
    Arguments arguments{
        "screen",           file, "--size", size, "--repetitions", "1", "--reference-pixels", "60",
        "--reference-rays", "400"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

Json report(const Shell& shell, const Arguments& arguments) {
    const Run run = shell.run(arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return run.json();
}

// The ground y = 0, and a block of height 9 on it that ends in a wall at x = 0.
std::string wall_obj(bool wall) {
    std::string text = "v -20 0 20\nv 20 0 20\nv 20 0 -20\nv -20 0 -20\nf 1 2 3 4\n";
    if (wall)
        text += "v 0 0 20\nv 0 0 -20\nv 0 9 -20\nv 0 9 20\nv -20 9 -20\nv -20 9 20\nf 5 6 7 8\nf 8 7 9 10\n";
    return text;
}

const Arguments kAbove{"--eye", "2.5", "6", "0", "--target", "2.5", "0", "0", "--up", "0", "0", "-1"};

Arguments above(Arguments more) {
    more.insert(more.end(), kAbove.begin(), kAbove.end());
    return more;
}

}  // namespace

TEST_CASE("screen: an open plane is open") {
    const Shell shell;
    shell.write("plane.obj", wall_obj(false));
    for (const char* estimator : {"sphere", "hemisphere", "importance", "tangent", "disk", "march"}) {
        INFO(estimator);
        const Json json = report(shell, screen("plane.obj", above({"--estimator", estimator, "--radius", "2",
                                                                   "-o", "a.png", "--json", "-"})));
        CHECK(json["estimator"] == estimator);
        CHECK(json["surface_pixels"] == 64 * 48);
        number(json, "rms_grey_world", 0, 4);
        number(json, "rms_grey_screen", 0, 4);
        number(json, "ms", 1e-4, 1e5);
        number(json, "mpixels_per_s", 1e-4, 1e6);
        const Image image = dfield::read_png(shell.folder() / "a.png");
        REQUIRE(image.width == 64);
        CHECK(*std::min_element(image.rgb.begin(), image.rgb.end()) > 235);
    }
}

TEST_CASE("screen: the ground beside a wall is as the closed form has it") {
    const Shell shell;
    shell.write("wall.obj", wall_obj(true));
    // Ten units of it, seen from above: R lies within the picture on both sides of the wall.
    const Json json = report(
        shell,
        screen("wall.obj",
               {"--radius", "4", "--samples", "256", "--orthographic", "10", "--eye", "1",  "30", "0",
                "--target", "1", "0",         "0",   "--up",           "0",  "0",     "-1", "-o", "a.png",
                "--json",   "-"},
               "100x100"));
    CHECK(json["projection"] == "orthographic");
    number(json, "rms_grey_screen", 0, 2);
    number(json, "rms_grey_world", 0, 30);  // towards the borders the wall goes on where nobody looks
    const Image image = dfield::read_png(shell.folder() / "a.png");
    const double pi = std::acos(-1.0);
    for (std::uint32_t x = 0; x < 60; ++x) {
        const double at = -4 + 0.1 * (x + 0.5), q = at / 4;  // world x of the column; the wall is at 0
        if (at < 0.4) continue;
        const double s = std::sqrt(1 - q * q);
        const double open = q < 1 ? 1 - (std::acos(q) - q * s - 2.0 / 3 * q * s * s * s) / pi : 1;
        INFO(at);
        CHECK(static_cast<double>(image.at(x, 50)[0]) == Approx(255 * open).margin(9));
    }
}

TEST_CASE("screen: G-buffers written and read give the same picture") {
    const Shell shell;
    const std::string harbour = source_file("models/harbour.glb").string();
    const Json first =
        report(shell, screen(harbour, {"--indirect", "-o", "a.png", "--gbuffer", "g.exr", "--json", "-"}));
    CHECK(first["camera"] == "camera 'mole'");
    number(first, "rms_grey_indirect_screen", 0, 30);
    number(first, "rms_grey_indirect_world", 0, 60);
    const std::string radius = std::to_string(first["radius"].get<double>());
    const Json again = report(shell, screen("g.exr", {"--indirect", "--radius", radius, "-o", "b.png",
                                                      "--scene", harbour, "--json", "-"}));
    CHECK(dfield::read_file(shell.folder() / "a.png") == dfield::read_file(shell.folder() / "b.png"));
    CHECK(again["rms_grey_world"] == first["rms_grey_world"]);
    CHECK(again["rms_grey_indirect_world"].is_null());  // a light of its own
    CHECK(report(shell, screen("g.exr", {"--radius", radius, "--json", "-"}))["rms_grey_world"].is_null());

    REQUIRE(shell.run(screen(harbour, {"--gbuffer", "g.json", "-o", "c.png"})).exit_code == 0);
    REQUIRE(shell.run(screen("g.json", {"--radius", radius, "-o", "d.png"})).exit_code == 0);
    const Image c = dfield::read_png(shell.folder() / "c.png"),
                d = dfield::read_png(shell.folder() / "d.png");
    double sum = 0;
    for (std::size_t i = 0; i < c.rgb.size(); ++i)
        sum += std::pow(static_cast<double>(c.rgb[i]) - static_cast<double>(d.rgb[i]), 2);
    CHECK(std::sqrt(sum / static_cast<double>(c.rgb.size())) < 4);
    CHECK(shell.list() == std::vector<std::string>{"a.png", "b.png", "c.png", "cube.obj", "d.png",
                                                   "g-albedo.png", "g-depth.png", "g-normals.png",
                                                   "g-radiance.png", "g.exr", "g.json"});
}

TEST_CASE("screen: orthographic 0 is the whole scene, whoever looks") {
    const Shell shell;
    const std::string harbour = source_file("models/harbour.glb").string();
    for (const Arguments& from : {Arguments{"--camera", "mole"}, Arguments{"--view", "1", "1", "1"},
                                  Arguments{"--eye", "7", "6", "15", "--target", "7", "0", "0"}}) {
        Arguments more{"--orthographic", "0", "--gbuffer", "g.exr"};
        more.insert(more.end(), from.begin(), from.end());
        REQUIRE(shell.run(screen(harbour, more)).exit_code == 0);
        const GBuffer buffer = dfield::read_gbuffer(shell.folder() / "g.exr");
        CHECK(buffer.camera.orthographic);
        CHECK(buffer.camera.half_width == Approx(buffer.camera.half_height * 64 / 48));
        // All of it, and not much more: sky at every border, surfaces close to two of them.
        const auto seen = [&](bool column, std::uint32_t at) {
            for (std::uint32_t i = 0; i < (column ? 48u : 64u); ++i)
                if (dfield::is_surface(buffer.depth[column ? i * 64 + at : at * 64 + i])) return true;
            return false;
        };
        for (const bool column : {false, true}) {
            CHECK_FALSE(seen(column, 0));
            CHECK_FALSE(seen(column, column ? 63 : 47));
        }
        CHECK(((seen(false, 4) && seen(false, 43)) || (seen(true, 4) && seen(true, 59))));
    }
}

TEST_CASE("screen: creases of models without normals") {
    const Shell shell;
    const std::string cube = source_file("models/cube_with_hole.obj").string();
    const auto bent = [&](const char* crease) {  // normals that are not along the cube's axes
        REQUIRE(shell.run(screen(cube, {"--crease", crease, "--gbuffer", "g.exr"})).exit_code == 0);
        const GBuffer buffer = dfield::read_gbuffer(shell.folder() / "g.exr");
        std::size_t count = 0;
        for (std::size_t i = 0; i < buffer.pixels(); ++i) {
            if (!dfield::is_surface(buffer.depth[i])) continue;
            const glm::vec3 normal = glm::abs(glm::mat3(buffer.camera.to_world) * buffer.normals[i]);
            count += std::max({normal.x, normal.y, normal.z}) < 0.999f;
        }
        return count;
    };
    CHECK(bent("30") == 0);
    CHECK(bent("180") > 500);
}

TEST_CASE("screen: colours bleed where light is indirect") {
    const Shell shell;
    const std::string harbour = source_file("models/harbour.glb").string();
    REQUIRE(shell.run(screen(harbour, {"--show", "ambient", "--indirect", "-o", "a.png"})).exit_code == 0);
    REQUIRE(shell.run(screen(harbour, {"--show", "lit", "-o", "b.png"})).exit_code == 0);
    const Image ambient = dfield::read_png(shell.folder() / "a.png"),
                lit = dfield::read_png(shell.folder() / "b.png");
    std::size_t brighter = 0;
    for (std::size_t i = 0; i < lit.rgb.size(); ++i) {
        REQUIRE(int{lit.rgb[i]} >= int{ambient.rgb[i]} - 1);
        brighter += lit.rgb[i] > ambient.rgb[i];
    }
    CHECK(brighter > lit.rgb.size() / 10);
}

TEST_CASE("screen: fields beyond the radius") {
    const Shell shell;
    const std::string cube = source_file("models/cube_with_hole.obj").string();
    const Json json =
        report(shell, screen(cube, {"--field", "auto", "--radius", "0.15", "--no-cache", "--quiet",
                                    "--reference-picture", "r.png", "-o", "a.png", "--json", "-"}));
    const Json& far = json["far"];
    const double both = number(far, "rms_grey_combined", 0, 40);
    CHECK(both < far["rms_grey_screen_alone"].get<double>());
    number(far, "rms_grey_product", 0, 255);
    number(far, "ms", 1e-4, 1e5);
    REQUIRE(shell.run(with_small_field({"bake", cube, "-o", "f.dfield"})).exit_code == 0);
    const Json file = report(shell, screen(cube, {"--field", "f.dfield", "--radius", "0.15", "--json", "-"}));
    CHECK(file["far"]["field"] == "f.dfield");
    CHECK(json["image"] == "a.png");
    CHECK_FALSE(file.contains("image"));
}

TEST_CASE("screen compare: every estimator") {
    const Shell shell;
    const Json json = report(shell, {"screen", "compare", "cube.obj", "--size", "40x30", "--repetitions", "1",
                                     "--reference-pixels", "20", "--reference-rays", "64", "--json", "-"});
    const Json& rows = json["estimators"];
    REQUIRE(rows.size() == 6 * 5 * 2);
    std::set<std::string> names;
    for (const Json& row : rows) {
        names.insert(row["estimator"]);
        for (const char* key : {"rms_grey_screen", "rms_grey_world"}) number(row, key, 0, 255);
        number(row, "ms", 1e-4, 1e5);
        number(row, "mpixels_per_s", 1e-4, 1e6);
    }
    CHECK(names.size() == 6);
}

TEST_CASE("screen: mistakes") {
    const Shell shell;
    shell.write("empty.exr", "");
    shell.write("wall.json", "{}");
    struct Mistake {
        Arguments arguments;
        int exit_code;
        std::string said;
    };
    for (const auto& [arguments, exit_code, said] : std::vector<Mistake>{
             {{"screen"}, 2, "nothing else comes out"},
             {{"screen", "-o", "a.png"}, 2, "FILE is required"},
             {{"screen", "cube.obj"}, 2, "--gbuffer"},
             {{"screen", "cube.obj", "-o", "a.jpg"}, 2, ".png"},
             {{"screen", "cube.obj", "-o", "a.png", "--estimator", "guess"}, 2, "--estimator"},
             {{"screen", "cube.obj", "-o", "a.png", "--samples", "0"}, 2, "--samples"},
             {{"screen", "cube.obj", "-o", "a.png", "--radius", "-1"}, 2, "--radius"},
             {{"screen", "cube.obj", "-o", "a.png", "--radius", "nan"}, 2, "--radius"},
             {{"screen", "cube.obj", "-o", "a.png", "--size", "800"}, 2, "no size such as 800x600"},
             {{"screen", "cube.obj", "-o", "a.png", "--size", "0x5"}, 2, "no size such as 800x600"},
             {{"screen", "cube.obj", "-o", "a.png", "--size", "99999x5"}, 2, "1 to 16384"},
             {{"screen", "cube.obj", "-o", "a.png", "--interleave", "9"}, 2, "--interleave"},
             {{"screen", "cube.obj", "-o", "a.png", "--view", "0", "0", "0"}, 2, "no direction"},
             {{"screen", "cube.obj", "-o", "a.png", "--eye", "1", "1", "1", "--view", "1", "0", "0"},
              2,
              "--view"},
             {{"screen", "cube.obj", "-o", "a.png", "--eye", "1", "1", "1", "--target", "1", "1", "1"},
              2,
              "same point"},
             {{"screen", "cube.obj", "-o", "a.png", "--fov", "0"}, 2, "--fov"},
             {{"screen", "cube.obj", "-o", "a.png", "--scene", "cube.obj"}, 2, "goes with a G-buffer"},
             {{"screen", "g.exr", "-o", "a.png", "--target", "1", "1", "1"}, 2, "g.exr is a G-buffer"},
             {{"screen", "g.exr", "-o", "a.png", "--sun", "1", "1", "1"}, 2, "its radiance"},
             {{"screen", "cube.obj", "--gbuffer", "a.tif"}, 2, ".exr"},
             {{"screen", "cube.obj", "-o", "a.png", "--camera", "none"}, 3, "no camera 'none'"},
             {{"screen", "none.obj", "-o", "a.png"}, 3, "none.obj: no such file"},
             {{"screen", "none.exr", "-o", "a.png"}, 3, "none.exr: no such file"},
             {{"screen", "empty.exr", "-o", "a.png"}, 3, "empty.exr"},
             {{"screen", "wall.json", "-o", "a.png"}, 3, "names no depth"},
             {{"screen", "cube.obj", "-o", "a.png", "--field", "none.dfield"},
              3,
              "none.dfield: no such file"},
             {{"screen", "cube.obj", "-o", "none/a.png"}, 4, "does not exist"},
             {{"screen", "cube.obj", "--gbuffer", "none/a.exr"}, 4, "does not exist"}})
        check_mistake(shell, arguments, exit_code, said);
}

TEST_CASE("screen: broken G-buffers, full disks") {
    const Shell shell;
    REQUIRE(shell.run(screen("cube.obj", {"--gbuffer", "g.exr"}, "9x7")).exit_code == 0);
    REQUIRE(shell.run(screen("cube.obj", {"--gbuffer", "g.json"}, "9x7")).exit_code == 0);
    const auto text_of = [&](const char* file) {
        const std::vector<std::byte> bytes = dfield::read_file(shell.folder() / file);
        return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    const std::string exr = text_of("g.exr"), json = text_of("g.json"), png = text_of("g-depth.png");
    shell.write("cut.exr", exr.substr(0, exr.size() / 2));
    shell.write("cut.json", json.substr(0, json.size() / 2));
    for (const char* file : {"cut.exr", "cut.json"})
        check_mistake(shell, {"screen", file, "-o", "a.png"}, 3, file);
    for (const std::string& broken : {std::string(), png.substr(0, png.size() / 2)}) {
        shell.write("g-depth.png", broken);
        check_mistake(shell, {"screen", "g.json", "-o", "a.png"}, 3, "g-depth.png");
    }
    // Depth that is NaN is sky: all of it is.
    GBuffer buffer = dfield::read_gbuffer(shell.folder() / "g.exr");
    buffer.depth.assign(buffer.pixels(), NAN);
    buffer.normals.assign(buffer.pixels(), glm::vec3(NAN));
    buffer.radiance.assign(buffer.pixels(), glm::vec3(NAN));
    dfield::write_gbuffer(shell.folder() / "nan.exr", buffer);
    const Json nothing = report(shell, screen("nan.exr", {"--indirect", "-o", "n.png", "--json", "-"}));
    CHECK(nothing["surface_pixels"] == 0);
    CHECK(nothing["rms_grey_screen"] == 0);

    if (!std::filesystem::exists("/dev/full")) return;
    CHECK(shell.run(screen("g.exr", {"--json", "/dev/full"})).exit_code == 4);
    CHECK(shell.run(screen("g.exr", {"--json", "-"}), "/dev/full").exit_code == 4);
    // Longer than a buffer: it fails long before the end.
    CHECK(shell
              .run({"screen", "compare", "cube.obj", "--size", "8x6", "--repetitions", "1",
                    "--reference-pixels", "4", "--reference-rays", "4", "--json", "-"},
                   "/dev/full")
              .exit_code == 4);
}

TEST_CASE("screen: Ctrl-C is exit code 130 and leaves nothing behind") {
    const Shell shell;
    const auto before = shell.list();
    for (const Arguments& arguments :
         {Arguments{"screen", "cube.obj", "--size", "640x480", "--reference-pixels", "307200",
                    "--reference-rays", "65536", "--gbuffer", "g.exr", "-o", "a.png"},
          Arguments{"screen", "cube.obj", "--size", "640x480", "--repetitions", "1000", "--samples", "256",
                    "--json", "a.json"},
          Arguments{"screen", "compare", "cube.obj", "--size", "640x480", "--reference-rays", "65536",
                    "--json", "a.json"}}) {
        const Run run = shell.interrupt(arguments);
        INFO(run.err);
        CHECK(run.exit_code == 130);
        CHECK(run.out.empty());
        CHECK(contains(run.err, "interrupted"));
        CHECK(shell.list() == before);
    }
}

TEST_CASE("screen: radius 0, sky alone, derived normals, threads") {
    const Shell shell;
    const Json none = report(shell, screen("cube.obj", {"--radius", "0", "-o", "a.png", "--json", "-"}));
    CHECK(none["rms_grey_world"] == 0);
    const Image open = dfield::read_png(shell.folder() / "a.png");
    CHECK(*std::min_element(open.rgb.begin(), open.rgb.end()) == 255);
    const Json sky = report(shell, screen("cube.obj", {"--eye", "9", "0", "0", "--target", "10", "0", "0",
                                                       "-o", "b.png", "--json", "-"}));
    CHECK(sky["surface_pixels"] == 0);
    CHECK(sky["rms_grey_screen"] == 0);
    for (const char* threads : {"1", "3"})
        REQUIRE(shell
                    .run(screen("cube.obj", {"--derive-normals", "--threads", threads, "-o",
                                             std::string(threads) + ".png"}))
                    .exit_code == 0);
    CHECK(dfield::read_file(shell.folder() / "1.png") == dfield::read_file(shell.folder() / "3.png"));
}
