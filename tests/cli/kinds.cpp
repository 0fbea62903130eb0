// dfield bake --kind, and what info and validate say of line tables, direction maps and occlusion volumes.
#include <catch2/catch.hpp>
#include <filesystem>
#include <set>

#include "tests/cli/command.hpp"
#include "tests/cli/json_checks.hpp"

namespace {

using namespace dfield::test;
namespace fs = std::filesystem;

constexpr const char* kOutput = "out.dfield";

Json baked(const Shell& shell, Arguments more) {
    Arguments arguments = with_small_field({"bake", "cube.obj", "-o", kOutput, "--json", "-"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Run run = shell.run(arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return run.json();
}

Json info(const Shell& shell) {
    const Run run = shell.run({"info", kOutput, "--json", "-"});
    REQUIRE(run.exit_code == 0);
    return run.json();
}

// "maps lines directions" and the like, in the order of the report.
std::string kinds_of(const Json& json) {
    std::string kinds;
    for (const Json& kind : json.at("kinds"))
        kinds += (kinds.empty() ? "" : " ") + kind.at("kind").get<std::string>();
    return kinds;
}

std::string sections_of(const Json& json) {
    std::string ids;
    for (const Json& section : json.at("sections")) ids += section.at("id").get<std::string>() + " ";
    return ids;
}

}  // namespace

TEST_CASE("--kind says what is baked, and info, validate and the report agree on it") {
    const Shell shell;
    const std::vector<std::array<const char*, 3>> cases = {
        {"maps", "maps", "FELD MASK DIST PROV "},
        {"lines", "lines", "FELD LINE PROV "},
        {"directions", "directions", "FELD DM00 PROV "},
        {"volume", "volume", "FELD VOLU PROV "},
        {"all", "maps lines directions volume", "FELD MASK DIST LINE DM00 VOLU PROV "},
        {"auto", "maps directions", "FELD MASK DIST DM00 PROV "}};
    std::set<std::string> hashes;
    for (const auto& [kind, kinds, sections] : cases) {
        INFO(kind);
        const Json report =
            baked(shell, {"--kind", kind, "--line-size", "6", "--line-depth-size", "4", "--direction-count",
                          "38", "--direction-size", "16", "--line-lookup", "pivot"});
        CHECK(kinds_of(report) == kinds);
        hashes.insert(report.at("payload_hash").get<std::string>());
        const Json shown = info(shell);
        CHECK(sections_of(shown) == sections);
        for (const char* key : {"kinds", "payload_hash", "field_bytes", "file_bytes"})
            CHECK(shown.at(key) == report.at(key));
        const Json valid = shell.run({"validate", kOutput, "--json", "-"}).json();
        CHECK(valid.at("valid") == true);
        CHECK(valid.at("kinds") == report.at("kinds"));
        std::uint64_t memory = 0, stored = 0;
        for (const Json& of_kind : report.at("kinds")) {
            memory += of_kind.at("memory_bytes").get<std::uint64_t>();
            stored += of_kind.at("file_bytes").get<std::uint64_t>();
        }
        CHECK(memory == report.at("field_bytes"));
        CHECK(stored < report.at("file_bytes"));
        CHECK(stored > 0);
    }
    CHECK(hashes.size() == cases.size());
    // Without --kind the same as with auto.
    CHECK(kinds_of(baked(shell, {})) == "maps directions");
}

TEST_CASE("parameters of line tables and direction maps arrive in the file") {
    const Shell shell;
    const Json report = baked(shell, {"--kind",
                                      "all",
                                      "--line-size",
                                      "7",
                                      "--line-bits",
                                      "8",
                                      "--line-depth-size",
                                      "5",
                                      "--line-lookup",
                                      "filtered",
                                      "--line-space",
                                      "sphere",
                                      "--direction-count",
                                      "258",
                                      "--direction-size",
                                      "32",
                                      "--direction-levels",
                                      "3",
                                      "--direction-depth",
                                      "32",
                                      "--volume-size",
                                      "24"});
    const Json& kinds = report.at("kinds");
    REQUIRE(kinds.size() == 6);
    CHECK(kinds[1].at("line_size") == 7);
    CHECK(kinds[1].at("points") == 49);
    CHECK(kinds[1].at("depth_bits") == 8);
    CHECK(kinds[1].at("depth_size") == 5);
    CHECK(kinds[1].at("lookup") == "filtered");
    CHECK(kinds[1].at("space") == "sphere");
    const int subdivisions[] = {2, 4, 8}, sizes[] = {16, 16, 32}, depths[] = {16, 16, 32};
    for (std::size_t level = 0; level < 3; ++level) {
        const Json& maps = kinds[2 + level];
        CHECK(maps.at("level") == level);
        CHECK(maps.at("subdivision") == subdivisions[level]);
        CHECK(maps.at("directions") == 4 * subdivisions[level] * subdivisions[level] + 2);
        CHECK(maps.at("map_size") == sizes[level]);
        CHECK(maps.at("depth_size") == depths[level]);
    }
    CHECK(kinds[5].at("kind") == "volume");
    CHECK(kinds[5].at("dims") == Json({24, 24, 24}));
    const Json provenance = info(shell).at("provenance");
    CHECK(provenance.at("lines").at("lookup") == "filtered");
    CHECK(provenance.at("directions").size() == 3);
    CHECK(!baked(shell, {"--kind", "lines"}).contains("positions"));
    CHECK(!info(shell).at("provenance").contains("parameters"));
}

TEST_CASE("counts of directions that cannot be met are rounded down, and said") {
    const Shell shell;
    const auto run = [&](Arguments more) {
        Arguments arguments{"bake", "cube.obj", "-o", kOutput, "--kind", "directions"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return shell.run(arguments);
    };
    const Run odd = run({"--direction-count", "1000"});
    REQUIRE(odd.exit_code == 0);
    CHECK(contains(odd.out, "--direction-count 1000: 902 directions are baked (4n^2+2 with n = 15)"));
    CHECK(info(shell).at("kinds")[0].at("directions") == 902);
    const Run exact = run({"--direction-count", "258", "--map-size", "16"});
    CHECK(!contains(exact.out, "--direction-count"));
    CHECK(info(shell).at("kinds")[0].at("map_size") == 16);
    const Run levels = run({"--direction-count", "6", "--direction-size", "16", "--direction-levels", "4"});
    CHECK(contains(levels.out, "--direction-levels 4: 1 levels are baked"));
    for (const Arguments& wrong :
         {Arguments{"--direction-count", "5"}, Arguments{"--direction-size", "24"},
          Arguments{"--map-size", "24"}, Arguments{"--direction-depth", "64", "--direction-size", "32"},
          Arguments{"--direction-levels", "9"}, Arguments{"--kind", "nonsense"},
          Arguments{"--line-bits", "5"}, Arguments{"--line-size", "1"}}) {
        INFO(wrong[0] << " " << wrong[1]);
        CHECK(run(wrong).exit_code == 2);
    }
}

TEST_CASE("any number of threads gives the same line table and direction maps") {
    const Shell shell;
    std::set<std::string> hashes;
    for (const char* threads : {"1", "2", "7"})
        hashes.insert(baked(shell, {"--kind", "all", "--line-size", "8", "--direction-depth", "16",
                                    "--threads", threads})
                          .at("payload_hash")
                          .get<std::string>());
    CHECK(hashes.size() == 1);
}

TEST_CASE("--verify measures every kind and leaves the payload as it is") {
    const Shell shell;
    const Arguments kinds{"--kind",      "all", "--direction-count", "258",
                          "--line-size", "16",  "--volume-size",     "20"};
    const Json plain = baked(shell, kinds);
    CHECK(!plain.contains("verified"));
    Arguments verify = kinds;
    verify.push_back("--verify");
    const Json report = baked(shell, verify);
    CHECK(report.at("payload_hash") == plain.at("payload_hash"));
    const Json shown = info(shell);
    CHECK(shown.at("provenance").at("verified") == report.at("verified"));
    for (const char* kind : {"maps", "lines", "directions", "volume"})
        for (const char* scene : {"corner", "corner-contact"}) {
            INFO(kind << " " << scene);
            const Json& errors = report.at("verified").at(kind).at(scene);
            // Some error there is, and not one of another order than the receivers' occlusion.
            CHECK(number(errors, "rms_grey", 0.01, 30) <= number(errors, "max_grey", 0.01, 255));
            number(errors, "bias_grey", -20, 20);
            number(errors, "rms_grey_converged", 0.01, 30);
        }
    CHECK(contains(shell.run({"info", kOutput}).out, "verified     maps "));

    // In a folder a file that was not verified is baked again, one that was stays.
    const auto status = [&](bool verified) {
        Arguments arguments = with_small_field({"bake", "cube.obj", "-o", "folder/", "--json", "-"});
        arguments.insert(arguments.end(),
                         {"--kind", "directions", "--direction-count", "38", "--direction-size", "16"});
        if (verified) arguments.push_back("--verify");
        return shell.run(arguments).json().at("models")[0].at("status").get<std::string>();
    };
    CHECK(status(false) == "baked");
    CHECK(status(true) == "baked");
    CHECK(status(true) == "unchanged");
    CHECK(status(false) == "unchanged");
}
