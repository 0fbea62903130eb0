// dfield compare: the figures it reports and how they hang together. That they are good enough is
// tests/quality's.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/cli/command.hpp"
#include "tests/cli/json_checks.hpp"
#include "tests/test_data.hpp"

namespace {

using namespace dfield::test;
namespace fs = std::filesystem;

Json compare(const Shell& shell, const Arguments& more, bool small = true) {
    Arguments arguments{"compare", "--json", "-", "--repetitions", "1", "--converged-rays", "16"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Run run = shell.run(small ? with_small_field(arguments) : arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return run.json();
}

}  // namespace

TEST_CASE("compare reports errors, speeds and sizes") {
    const Shell shell;
    const Json json = compare(shell, {"--caster", "cube.obj"});
    CHECK(json.at("scene") == "corner");
    CHECK(json.at("caster") == "cube.obj");
    CHECK(json.at("receivers") == 3 * 33 * 33);
    CHECK(json.at("rays") == 3 * 33 * 33 * 256);
    CHECK(json.at("threads") == 1);
    const double rms = number(json, "rms_grey", 1, 40), max = number(json, "max_grey", rms, 255);
    CHECK(std::fabs(number(json, "bias_grey", -rms, rms)) <= rms);
    const Json& percentiles = json.at("percentiles_grey");
    double before = 0;
    for (const char* percentile : {"50", "90", "95", "99"})
        before = number(percentiles, percentile, before, max);
    CHECK(number(json, "rms_grey_converged", 1, 40) != rms);
    CHECK(number(json, "disagree_fraction", 0.001, 0.2) > 0);
    CHECK(number(json, "sphere_hit_fraction", 0.2, 0.8) > 0);

    const double lookup = number(json, "lookup_mrays_per_s", 0.1, 1e5),
                 embree = number(json, "embree_mrays_per_s", 0.1, 1e5);
    CHECK(number(json, "speedup", 1e-3, 1e4) == Approx(lookup / embree).epsilon(1e-3));
    CHECK(number(json, "lookup_seconds", 1e-5, 100) == Approx(0.836352 / lookup).epsilon(1e-3));
    CHECK(number(json, "embree_seconds", 1e-5, 100) == Approx(0.836352 / embree).epsilon(1e-3));
    number(json, "speedup_sphere_hits", 1e-3, 1e4);
    const Json& modes = json.at("embree_modes_mrays_per_s");
    CHECK(modes.size() == 7);
    CHECK(modes.contains(json.at("embree_mode").get<std::string>()));
    for (const auto& mode : modes.items())
        CHECK(mode.value() <= modes.at(json.at("embree_mode").get<std::string>()));

    // All that is loaded, not only the maps: 66 x 8 x 8 texels.
    CHECK(number(json, "field_bytes", 66 * 64, 1e5) > 66 * 64);
    number(json, "file_bytes", 500, 66 * 64);
}

TEST_CASE("compare of an occlusion volume says nothing of single rays") {
    const Shell shell;
    const Arguments arguments{"--caster", "cube.obj", "--kind", "volume", "--volume-size", "24"};
    const Json json = compare(shell, arguments);
    CHECK(json.at("kind") == "volume");
    CHECK(number(json, "rms_grey", 1, 30) < number(json, "max_grey", 2, 255));
    CHECK(!json.contains("disagree_fraction"));
    CHECK(!json.contains("speedup_sphere_hits"));
    REQUIRE(shell.run({"bake", "cube.obj", "-o", "cube.dfield", "--kind", "volume", "--volume-size", "24"})
                .exit_code == 0);
    const Json given = compare(shell, {"--caster", "cube.obj", "--field", "cube.dfield"}, false);
    CHECK(given.at("kind") == "volume");
    CHECK(given.at("rms_grey") == json.at("rms_grey"));
}

TEST_CASE("compare takes a baked field, or bakes one and keeps it") {
    const Shell shell;
    REQUIRE(
        shell.run(with_small_field({"bake", "cube.obj", "-o", "cube.dfield", "--kind", "maps"})).exit_code ==
        0);
    const Json given = compare(shell, {"--caster", "cube.obj", "--field", "cube.dfield"}, false);
    CHECK(fs::is_empty(shell.cache()));
    CHECK(given.at("file_bytes") == fs::file_size(shell.folder() / "cube.dfield"));
    const Json baked = compare(shell, {"--caster", "cube.obj"});
    CHECK(std::distance(fs::directory_iterator(shell.cache()), fs::directory_iterator()) == 1);
    for (const char* key : {"rms_grey", "bias_grey", "max_grey", "disagree_fraction", "file_bytes", "rays"})
        CHECK(given.at(key) == baked.at(key));

    // Errors do not depend on threads; the field of another model is worth a warning.
    CHECK(compare(shell, {"--caster", "cube.obj", "--threads", "2"}).at("rms_grey") == baked.at("rms_grey"));
    shell.write("tetrahedron.obj",
                "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    const Run ignored = shell.run(
        {"compare", "--caster", "cube.obj", "--field", "cube.dfield", "--bits", "1", "--repetitions", "1"});
    CHECK(ignored.exit_code == 0);
    CHECK(contains(ignored.err, "--bits is ignored"));
    const Run wrong =
        shell.run({"compare", "--caster", "tetrahedron.obj", "--field", "cube.dfield", "--repetitions", "1"});
    CHECK(wrong.exit_code == 0);
    CHECK(contains(wrong.err, "cube.dfield was baked from another mesh"));
}

TEST_CASE("compare's options change what they should") {
    const Shell shell;
    const Json corner = compare(shell, {"--caster", "cube.obj", "--rays", "49"});
    CHECK(corner.at("rays") == 3267 * 49);
    const Json contact =
        compare(shell, {"--caster", "cube.obj", "--rays", "49", "--scene", "corner-contact"});
    CHECK(contact.at("scene") == "corner-contact");
    CHECK(contact.at("rms_grey") != corner.at("rms_grey"));
    const Json polar = compare(shell, {"--caster", "cube.obj", "--rays", "49", "--ray-sampling", "polar"});
    CHECK(polar.at("rays") == 3267 * 49);
    CHECK(polar.at("rms_grey") != corner.at("rms_grey"));
    // A finer field is better.
    const Json fine = compare(
        shell, {"--caster", "cube.obj", "--rays", "49", "--subdivision", "24", "--map-size", "24"}, false);
    CHECK(fine.at("rms_grey").get<double>() < 0.5 * corner.at("rms_grey").get<double>());
    CHECK(fine.at("disagree_fraction").get<double>() < 0.5 * corner.at("disagree_fraction").get<double>());
}

TEST_CASE("compare of a scene whose objects occlude each other") {
    const Shell shell;
    const std::string scene = source_file("models/scene_instances.glb").string();
    const Json json = compare(shell, {"--scene", scene, "--rays", "4"});
    CHECK(json.at("rays").get<std::size_t>() == 4 * json.at("receivers").get<std::size_t>());
    CHECK(number(json, "receivers", 3 * 51000, 200000) > 0);
    CHECK(number(json, "rms_grey", 0.1, 60) > 0);
    // With a caster the scene only receives.
    const Json receiving = compare(shell, {"--scene", scene, "--caster", "cube.obj", "--rays", "4"});
    CHECK(receiving.at("receivers") == json.at("receivers"));
    CHECK(receiving.at("field_bytes").get<double>() < json.at("field_bytes").get<double>());
}

TEST_CASE("compare draws reference, lookup and difference") {
    const Shell shell;
    compare(shell, {"--caster", "cube.obj", "--rays", "16", "--image", "out.png"});
    std::ifstream file(shell.folder() / "out.png", std::ios::binary);
    const std::string png((std::istreambuf_iterator<char>(file)), {});
    REQUIRE(png.size() > 10000);
    CHECK(png.substr(0, 8) == "\x89PNG\r\n\x1a\n");
    const auto big_endian = [&](std::size_t at) {
        return static_cast<unsigned char>(png[at + 2]) * 256u + static_cast<unsigned char>(png[at + 3]);
    };
    CHECK(big_endian(16) >= 3 * 560);  // three pictures in a row
    CHECK(big_endian(20) >= 480);
}
