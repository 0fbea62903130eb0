// `dfield volume info` as a user runs it.
#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "tests/cli/command.hpp"

using namespace dfield::test;

namespace {

const std::string kNrrd =
    "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 3 1\nspace: left-posterior-superior\nspace directions: "
    "(0,2,0) "
    "(3,0,0) (0,0,4)\nspace origin: (5,6,7)\nspace units: \"mm\" \"mm\" \"mm\"\nendian: big\nencoding: "
    "raw\n\n";

std::string voxels() {
    return bytes_of<std::int16_t>({1, -2, 300, 4, 5, 6}, true);
}

}  // namespace

TEST_CASE("volume info tells what a volume holds and where it lies") {
    const Shell shell;
    shell.write("a.nrrd", kNrrd + voxels());
    const Run run = shell.run({"volume", "info", "a.nrrd"});
    CHECK(run.exit_code == 0);
    CHECK(run.err.empty());
    for (const char* part : {"a.nrrd, NRRD", "2 x 3 x 1, i16", "-2 to 300", "2 3 4 mm", "5 6 7",
                             "left-posterior-superior", "left-handed"}) {
        INFO(part);
        CHECK(contains(run.out, part));
    }
    const Run report = shell.run({"volume", "info", "a.nrrd", "--json", "-"});
    CHECK(report.exit_code == 0);
    CHECK(contains(report.err, "2 x 3 x 1"));
    CHECK(report.json() == Json::parse(R"({
        "file": "a.nrrd", "format": "NRRD", "dims": [2, 3, 1], "type": "i16", "voxels": 6,
        "spacing": [2.0, 3.0, 4.0], "origin": [5.0, 6.0, 7.0],
        "directions": [[0.0, 2.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, 4.0]],
        "space": "left-posterior-superior", "unit": "mm", "right_handed": false, "range": [-2.0, 300.0]})"));
    CHECK(shell.run({"volume", "info", "a.nrrd", "--json", "report.json"}).exit_code == 0);
    std::ifstream file(shell.folder() / "report.json");
    CHECK(Json::parse(file) == report.json());
}

TEST_CASE("volume info of raw voxels") {
    const Shell shell;
    shell.write("a.raw", "head" + voxels());
    const Run run = shell.run({"volume", "info", "a.raw", "--dims", "2x3x1", "--type", "i16", "--endian",
                               "BIG", "--header-bytes", "4", "--spacing", "1x0.5x2", "--json", "-"});
    REQUIRE(run.exit_code == 0);
    CHECK(run.json()["format"] == "raw");
    CHECK(run.json()["range"] == Json({-2, 300}));
    CHECK(run.json()["spacing"] == Json({1, 0.5, 2}));
    CHECK(run.json()["right_handed"] == true);
}

TEST_CASE("what is odd about a volume goes to stderr") {
    const Shell shell;
    shell.write("a.nrrd", kNrrd + voxels() + "more");
    const Run run = shell.run({"volume", "info", "a.nrrd", "--json", "-"});
    CHECK(run.exit_code == 0);
    CHECK(contains(run.err, "dfield: a.nrrd: bytes after the last voxel are left out"));
    CHECK(run.json()["voxels"] == 6);
}

TEST_CASE("volume: mistakes have the exit codes of the other commands") {
    const Shell shell;
    shell.write("a.nrrd", kNrrd + voxels());
    shell.write("short.nrrd", kNrrd + "x");
    shell.write("a.raw", voxels());
    struct Mistake {
        Arguments arguments;
        int exit_code;
        std::string said;
    };
    const auto raw = [](Arguments more) {
        Arguments arguments{"volume", "info", "a.raw"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    };
    for (const auto& [arguments, exit_code, said] : std::vector<Mistake>{
             {{"volume"}, 2, "subcommand is required"},
             {{"volume", "frobnicate"}, 2, "subcommand is required"},
             {{"volume", "info"}, 2, "FILE is required"},
             {{"volume", "info", "a.nrrd", "--frobnicate"}, 2, "--frobnicate"},
             {raw({"--dims", "2x3x1"}), 2, "--type"},
             {raw({"--type", "i16"}), 2, "--dims"},
             {raw({"--spacing", "1x1x1"}), 2, "--dims"},
             {raw({"--endian", "big"}), 2, "--dims"},
             {raw({"--header-bytes", "4"}), 2, "--dims"},
             {raw({"--dims", "2x3", "--type", "i16"}), 2, "'2x3'"},
             {raw({"--dims", "2x3x1x1", "--type", "i16"}), 2, "2x3x1x1"},
             {raw({"--dims", "2x-3x1", "--type", "i16"}), 2, "2x-3x1"},
             {raw({"--dims", "2x0x1", "--type", "i16"}), 2, "2x0x1"},
             {raw({"--dims", "2x3x99999999999999999999", "--type", "i16"}), 2, "--dims"},
             {raw({"--dims", "2x3x1", "--type", "half"}), 2, "--type"},
             {raw({"--dims", "2x3x1", "--type", "i16", "--spacing", "1x0x1"}), 2, "1x0x1"},
             {raw({"--dims", "2x3x1", "--type", "i16", "--spacing", "1xnanx1"}), 2, "1xnanx1"},
             {raw({"--dims", "2x3x1", "--type", "i16", "--header-bytes", "-1"}), 2, "--header-bytes"},
             {raw({"--dims", "2x3x1", "--type", "i16", "--endian", "middle"}), 2, "--endian"},
             {raw({"--dims", "2x3x2", "--type", "i16"}), 3, "take 24 bytes, the file has 12"},
             {raw({}), 3, "--dims"},
             {{"volume", "info", "missing.nrrd"}, 3, "missing.nrrd: no such file"},
             {{"volume", "info", "short.nrrd"}, 3, "short.nrrd: 2 x 3 x 1 voxels"},
             {{"volume", "info", "cube.obj"}, 3, "unknown kind of volume '.obj'"},
             {{"volume", "info", "a.nrrd", "--json", "none/report.json"}, 4, "does not exist"}})
        check_mistake(shell, arguments, exit_code, said);
}
