// dfield bake of several models into a folder: a farm's one command.
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>

#include "tests/cli/command.hpp"
#include "tests/cli/json_checks.hpp"
#include "tests/import/test_files.hpp"

namespace {

using namespace dfield::test;
namespace fs = std::filesystem;

const char* const kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

struct Batch {
    Shell shell;
    std::map<std::string, std::string> hashes;  // of the fields in baked/, by file name

    Batch() { shell.write("tetrahedron.obj", kTetrahedron); }

    Run run(Arguments more = {}) {
        Arguments arguments{"bake", "cube.obj", "tetrahedron.obj", "-o", "baked/", "--json", "-"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return shell.run(with_small_field(arguments));
    }
    // Status of each model in a report, "model: status" in the order of the command line.
    static std::vector<std::string> statuses(const Json& json) {
        std::vector<std::string> result;
        for (const Json& model : json.at("models"))
            result.push_back(model.at("model").get<std::string>() + ": " +
                             model.at("status").get<std::string>());
        return result;
    }
    fs::file_time_type written(const std::string& name) const {
        return fs::last_write_time(shell.folder() / "baked" / name);
    }
};

using Statuses = std::vector<std::string>;

}  // namespace

TEST_CASE("a batch bakes what is missing or changed and leaves the rest alone") {
    Batch batch;
    const Shell& shell = batch.shell;
    const Run first = batch.run();
    REQUIRE(first.exit_code == 0);
    const Json json = first.json();
    CHECK(json.at("baked") == 2);
    CHECK(json.at("unchanged") == 0);
    CHECK(json.at("failed") == 0);
    CHECK(Batch::statuses(json) == Statuses{"cube.obj: baked", "tetrahedron.obj: baked"});
    CHECK(shell.list("baked") == std::vector<std::string>{"cube.dfield", "tetrahedron.dfield"});
    CHECK(contains(first.err, "2 baked, 0 unchanged, 0 failed"));

    const auto cube = batch.written("cube.dfield"), tetrahedron = batch.written("tetrahedron.dfield");
    const Run second = batch.run();
    REQUIRE(second.exit_code == 0);
    CHECK(Batch::statuses(second.json()) == Statuses{"cube.obj: unchanged", "tetrahedron.obj: unchanged"});
    for (std::size_t i = 0; i < 2; ++i)  // an unchanged model's report still says what lies there
        for (const char* key : {"payload_hash", "positions", "map_size", "bits", "triangles", "file_bytes"})
            CHECK(second.json()["models"][i].at(key) == json["models"][i].at(key));
    CHECK(batch.written("cube.dfield") == cube);

    SECTION("content counts, not the time of the file") {
        shell.write("tetrahedron.obj", std::string("# a comment\n") + kTetrahedron);
        fs::last_write_time(shell.folder() / "cube.obj", fs::file_time_type::clock::now());
        CHECK(batch.run().json().at("unchanged") == 2);
    }
    SECTION("a changed model bakes again, the other does not") {
        shell.write("tetrahedron.obj", std::string(kTetrahedron).replace(2, 5, "0 0 .5"));
        CHECK(Batch::statuses(batch.run().json()) ==
              Statuses{"cube.obj: unchanged", "tetrahedron.obj: baked"});
        CHECK(batch.written("cube.dfield") == cube);
        CHECK(batch.written("tetrahedron.dfield") > tetrahedron);
    }
    SECTION("other parameters bake again") {
        for (const Arguments& parameter :
             {Arguments{"--bits", "16"}, Arguments{"--mapping", "polar"}, Arguments{"--positions", "latlong"},
              Arguments{"--self"}, Arguments{"--self", "--self-rays", "9"}, Arguments{"--kind", "maps"},
              Arguments{"--kind", "lines", "--line-size", "5"},
              Arguments{"--kind", "lines", "--line-size", "6"}, Arguments{"--direction-count", "38"},
              Arguments{"--direction-depth", "8"}}) {
            INFO(parameter[0]);
            CHECK(batch.run(parameter).json().at("baked") == 2);
            CHECK(batch.run(parameter).json().at("unchanged") == 2);
        }
    }
    SECTION("threads are no parameter") {
        CHECK(batch.run({"--threads", "1"}).json().at("unchanged") == 2);
    }
    SECTION("--force bakes all") {
        CHECK(batch.run({"--force"}).json().at("baked") == 2);
    }
    SECTION("a broken output bakes again") {
        fs::resize_file(shell.folder() / "baked/cube.dfield", 100);
        CHECK(Batch::statuses(batch.run().json()) ==
              Statuses{"cube.obj: baked", "tetrahedron.obj: unchanged"});
    }
}

TEST_CASE("one model that fails does not stop the others, and shows in the exit code") {
    const Shell shell;
    shell.write("broken.obj", "v 0 0 0\nf 1 1 1\n");
    shell.write("tetrahedron.obj", kTetrahedron);
    const Arguments arguments = with_small_field({"bake", "broken.obj", "cube.obj", "missing.obj",
                                                  "tetrahedron.obj", "-o", "new/baked/", "--json", "-"});
    for (const char* status : {"baked", "unchanged"}) {
        const Run run = shell.run(arguments);
        CHECK(run.exit_code == 5);
        const Json json = run.json();
        CHECK(json.at("failed") == 2);
        CHECK(json.at(status) == 2);
        CHECK(Batch::statuses(json) == Statuses{"broken.obj: failed", std::string("cube.obj: ") + status,
                                                "missing.obj: failed",
                                                std::string("tetrahedron.obj: ") + status});
        CHECK(contains(json.at("models")[2].at("error"), "missing.obj: no such file"));
        CHECK(contains(run.err, "broken.obj: no usable triangle"));
        CHECK(shell.list("new/baked") == std::vector<std::string>{"cube.dfield", "tetrahedron.dfield"});
    }
    // A single model into a folder is a batch of one.
    CHECK(shell.run(with_small_field({"bake", "broken.obj", "-o", "new/baked"})).exit_code == 5);
    CHECK(shell.run(with_small_field({"bake", "cube.obj", "-o", "new/baked"})).out ==
          "new/baked/cube.dfield: unchanged\n0 baked, 1 unchanged, 0 failed\n");
}
