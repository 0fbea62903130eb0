// dfield bake of one model, and what info and validate say of the result.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "tests/cli/command.hpp"
#include "tests/cli/json_checks.hpp"
#include "tests/test_data.hpp"

namespace {

using namespace dfield::test;
namespace fs = std::filesystem;

Json bake_json(const Shell& shell, Arguments more, const std::string& model = "cube.obj",
               const std::string& output = "out.dfield") {
    Arguments arguments{"bake", model, "-o", output, "--json", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Run run = shell.run(arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return run.json();
}

}  // namespace

TEST_CASE("bake reports what it did") {
    const Shell shell;
    const Json json =
        bake_json(shell, {"--kind", "maps", "--subdivision", "8", "--map-size", "16", "--threads", "2"});
    CHECK(json.at("model") == "cube.obj");
    CHECK(json.at("output") == "out.dfield");
    CHECK(json.at("status") == "baked");
    CHECK(json.at("triangles") == 32);
    CHECK(json.at("degenerate") == 0);
    CHECK(json.at("not_finite") == 0);
    CHECK(json.at("index_out_of_range") == 0);
    CHECK(json.at("positions") == 4 * 8 * 8 + 2);
    CHECK(json.at("paper_positions") == 2 * (2 * 8 * 8 + 2 * 8 + 1));
    CHECK(json.at("subdivision") == 8);
    CHECK(json.at("map_size") == 16);
    CHECK(json.at("bits") == 8);
    CHECK(json.at("layout") == "slater");
    CHECK(json.at("mapping") == "concentric");
    CHECK(json.at("rays") == 258 * 16 * 16);
    CHECK(json.at("threads") == 2);
    CHECK(number(json, "mrays_per_s", 0.01, 10000) > 0);
    CHECK(number(json, "seconds", 1e-6, 100) >= number(json, "trace_seconds", 0, 100));
    CHECK(is_hash(json.at("payload_hash")));
    CHECK(json.at("field_bytes") == 258 * 16 * 16);
    CHECK(json.at("file_bytes") == fs::file_size(shell.folder() / "out.dfield"));
    CHECK(json.at("instruction_set").get<std::string>().size() > 2);
    CHECK(json.at("warnings").is_array());
    CHECK(shell.list() == std::vector<std::string>{"cube.obj", "out.dfield"});
}

TEST_CASE("--json FILE holds what --json - prints, and people's lines stay on stdout") {
    const Shell shell;
    const Run to_file =
        shell.run(with_small_field({"bake", "cube.obj", "-o", "out.dfield", "--json", "report.json"}));
    REQUIRE(to_file.exit_code == 0);
    CHECK(contains(to_file.out, "out.dfield: 32 triangles, "));
    CHECK(contains(to_file.out,
                   "maps: 66 slater (subdivision 4; the paper counts 82) of 8x8 concentric, 8 bit"));
    CHECK(to_file.err.empty());
    std::ifstream file(shell.folder() / "report.json");
    Json written = Json::parse(file), printed = bake_json(shell, with_small_field({}));
    for (Json* json : {&written, &printed})
        for (const char* timing : {"mrays_per_s", "seconds", "build_seconds", "trace_seconds"})
            CHECK(json->erase(timing) == 1);
    CHECK(written == printed);

    REQUIRE(shell.run({"info", "out.dfield", "--json", "info.json"}).exit_code == 0);
    std::ifstream info(shell.folder() / "info.json");
    CHECK(Json::parse(info) == shell.run({"info", "out.dfield", "--json", "-"}).json());
    REQUIRE(shell.run({"validate", "out.dfield", "--json", "validate.json"}).exit_code == 0);
    std::ifstream validate(shell.folder() / "validate.json");
    CHECK(Json::parse(validate) == shell.run({"validate", "out.dfield", "--json", "-"}).json());
}

TEST_CASE("info shows what was baked") {
    const Shell shell;
    const Json baked = bake_json(shell, {"--subdivision", "8", "--map-size", "16"});
    const Json json = shell.run({"info", "out.dfield", "--json", "-"}).json();
    CHECK(json.at("file") == "out.dfield");
    for (const char* key : {"positions", "paper_positions", "subdivision", "layout", "mapping", "map_size",
                            "bits", "payload_hash", "field_bytes", "file_bytes"}) {
        INFO(key);
        CHECK(json.at(key) == baked.at(key));
    }
    CHECK(json.at("version") == "1.2");
    CHECK(json.at("self_vertices") == 0);
    // The cube of side 1 around the origin: its smallest ball has half the space diagonal as radius.
    for (int axis = 0; axis < 3; ++axis) {
        CHECK(json.at("centre").at(axis).get<double>() == Approx(0).margin(1e-6));
        CHECK(json.at("bounds_min").at(axis).get<double>() == Approx(-0.5));
        CHECK(json.at("bounds_max").at(axis).get<double>() == Approx(0.5));
    }
    CHECK(json.at("radius").get<double>() == Approx(std::sqrt(0.75)).epsilon(1e-5));
    const Json& provenance = json.at("provenance");
    CHECK(is_hash(provenance.at("mesh").at("hash")));
    CHECK(provenance.at("mesh").at("triangles") == 32);
    CHECK(provenance.at("parameters").at("map_size") == 16);
    CHECK(contains(provenance.at("tool"), "dfield "));
    std::uint64_t end = 0;
    for (const Json& section : json.at("sections")) {
        CHECK(section.at("id").get<std::string>().size() == 4);
        CHECK(section.at("offset").get<std::uint64_t>() >= end);
        end = section.at("offset").get<std::uint64_t>() + section.at("stored_bytes").get<std::uint64_t>();
        CHECK(number(section, "raw_bytes", 1, 1e9) > 0);
    }
    CHECK(end <= json.at("file_bytes").get<std::uint64_t>());
    const Run lines = shell.run({"info", "out.dfield"});
    CHECK(contains(lines.out, json.at("payload_hash").get<std::string>()));
    CHECK(contains(lines.out, "258 slater (subdivision 8; the paper counts 290)"));
}

TEST_CASE("any number of threads and any run gives the same payload") {
    const Shell shell;
    for (const Arguments& field : {Arguments{"--subdivision", "16", "--map-size", "16"},
                                   Arguments{"--subdivision", "16", "--map-size", "15", "--bits", "1",
                                             "--self", "--self-rays", "10"}}) {
        std::set<std::string> hashes;
        for (const char* threads : {"1", "2", "8", "8"}) {
            Arguments arguments = field;
            arguments.insert(arguments.end(), {"--threads", threads});
            hashes.insert(bake_json(shell, arguments).at("payload_hash").get<std::string>());
        }
        CHECK(hashes.size() == 1);
    }
}

TEST_CASE("every kind of field bakes, validates, and differs from the others") {
    const Shell shell;
    std::set<std::string> hashes;
    std::size_t count = 0;
    const auto bake = [&](const Arguments& field, std::uint64_t positions) {
        const Json json = bake_json(shell, field);
        CHECK(json.at("positions") == positions);
        hashes.insert(json.at("payload_hash").get<std::string>());
        ++count;
        CHECK(shell.run({"validate", "out.dfield"}).exit_code == 0);
    };
    for (const char* mapping : {"concentric", "polar", "rejection"})
        for (const char* positions : {"slater", "latlong"})
            for (const char* bits : {"1", "8", "16", "32"})
                bake({"--subdivision", "3", "--map-size", "5", "--mapping", mapping, "--positions", positions,
                      "--bits", bits},
                     positions[0] == 's' ? 38 : 56);
    bake({"--subdivision", "1", "--map-size", "1"}, 6);
    bake({"--subdivision", "1", "--map-size", "1", "--bits", "1"}, 6);
    bake({"--subdivision", "1", "--map-size", "2", "--mapping", "Rejection"}, 6);  // any case
    CHECK(hashes.size() == count);
}

TEST_CASE("names with spaces and umlauts, relative and absolute paths, the current folder") {
    const Shell shell;
    const std::string folder = "wei\xc3\x9f und gr\xc3\xbcn", model = folder + "/w\xc3\xbcrfel 1.OBJ";
    fs::create_directories(shell.folder() / folder);
    fs::copy_file(shell.folder() / "cube.obj", shell.folder() / model);
    const Arguments field = with_small_field({});
    CHECK(bake_json(shell, field, model, folder + "/\xc3\xb6l.dfield").at("model") == model);
    CHECK(shell.run({"info", folder + "/\xc3\xb6l.dfield", "--json", "-"}).json().at("file") ==
          folder + "/\xc3\xb6l.dfield");
    bake_json(shell, field, "./" + folder + "/../cube.obj", "./out.dfield");
    bake_json(shell, field, (shell.folder() / model).string(), (shell.folder() / "absolute.dfield").string());
    bake_json(shell, field, model, ".");
    CHECK(shell.list() == std::vector<std::string>{"absolute.dfield", "cube.obj", "out.dfield", folder + "/",
                                                   "w\xc3\xbcrfel 1.dfield"});
    // A name that is no UTF-8 cannot stand in JSON as it is, but is no reason to fail.
    const std::string latin1 = "w\xfcrfel.obj";
    fs::copy_file(shell.folder() / "cube.obj", shell.folder() / latin1);
    CHECK(contains(bake_json(shell, field, latin1).at("model"), "rfel.obj"));
}

TEST_CASE("bake replaces an old output, also where that is broken or the same") {
    const Shell shell;
    shell.write("out.dfield", "something else");
    const std::string hash = bake_json(shell, with_small_field({})).at("payload_hash");
    CHECK(shell.run({"validate", "out.dfield"}).exit_code == 0);
    CHECK(bake_json(shell, with_small_field({})).at("status") == "baked");
    CHECK(shell.run({"info", "out.dfield", "--json", "-"}).json().at("payload_hash") == hash);
    CHECK(shell.list() == std::vector<std::string>{"cube.obj", "out.dfield"});
}

TEST_CASE("bake --self stores a value for each vertex") {
    const Shell shell;
    bake_json(shell, with_small_field({"--self", "--self-rays", "7"}));
    CHECK(shell.run({"info", "out.dfield", "--json", "-"}).json().at("self_vertices") == 16);
}

TEST_CASE("parts of a glTF file bake alone") {
    const Shell shell;
    const std::string scene = source_file("models/scene_instances.glb").string();
    const auto bake = [&](Arguments part) { return bake_json(shell, with_small_field(part), scene); };
    CHECK(bake({}).at("triangles") == 6144 + 3 * 17139 + 5 * 32);
    const Json tree = bake({"--mesh", "leafy_tree"});
    CHECK(tree.at("triangles") == 17139);
    CHECK(bake({"--node", "tree_mirrored"}).at("triangles") == 17139);
    CHECK(bake({"--node", "squeezed"}).at("triangles") == 2 * 32);  // a group: its children
    CHECK(bake({"--mesh", "cube_with_hole"}).at("triangles") == 32);
}

TEST_CASE("what is left out of a model is counted and said") {
    const Shell shell;
    shell.write("bad.obj",
                "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 nan\n"
                "f 1 2 3 4\nf 1 2 2\nf 1 2 5\nf 1 2 9\n");  // a quad; without area; NaN; out of range
    const Run run = shell.run(with_small_field({"bake", "bad.obj", "-o", "out.dfield", "--json", "-"}));
    REQUIRE(run.exit_code == 0);
    const Json json = run.json();
    CHECK(json.at("faces") == 4);
    CHECK(json.at("triangles") == 2);
    CHECK(json.at("degenerate") == 1);
    CHECK(json.at("not_finite") == 1);
    CHECK(json.at("index_out_of_range") == 1);
    for (const char* said : {"bad.obj: left out: 1 without area", "1 with a NaN", "1 with an index"})
        CHECK(contains(run.err, said));
}

TEST_CASE("validate numbers its findings") {
    const Shell shell;
    bake_json(shell, with_small_field({}));
    const Run valid = shell.run({"validate", "out.dfield"});
    CHECK(valid.exit_code == 0);
    CHECK(contains(valid.out, "out.dfield: valid"));
    const Json good = shell.run({"validate", "out.dfield", "--json", "-"}).json();
    CHECK(good.at("valid") == true);
    CHECK(good.at("errors") == 0);
    CHECK(good.at("findings").empty());

    std::ifstream file(shell.folder() / "out.dfield", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    std::string flipped = bytes;
    flipped[bytes.size() / 2] = static_cast<char>(flipped[bytes.size() / 2] ^ 16);
    const std::vector<std::string> broken{
        "", bytes.substr(0, 20), bytes.substr(0, bytes.size() - 1), bytes + '\0', flipped, "a shopping list"};
    for (const std::string& contents : broken) {
        INFO("length " << contents.size());
        shell.write("broken.dfield", contents);
        const Run run = shell.run({"validate", "broken.dfield", "--json", "-"});
        CHECK(run.exit_code == 6);
        const Json json = run.json();
        CHECK(json.at("file") == "broken.dfield");
        CHECK(json.at("valid") == false);
        CHECK(number(json, "errors", 1, 100) == static_cast<double>(json.at("findings").size()));
        for (const Json& finding : json.at("findings")) {
            CHECK(finding.at("severity") == "error");
            CHECK(number(finding, "number", 100, 999) > 0);
            CHECK(number(finding, "offset", 0, static_cast<double>(bytes.size() + 1)) >= 0);
            CHECK(finding.at("message").get<std::string>().size() > 10);
        }
        const Run lines = shell.run({"validate", "broken.dfield"});
        CHECK(lines.exit_code == 6);
        CHECK(lines.out.starts_with("error " + json.at("findings")[0].at("number").dump() + " at byte "));
        // info refuses the same file with the same number.
        const Run info = shell.run({"info", "broken.dfield"});
        CHECK(info.exit_code == 3);
        CHECK(contains(info.err, "error " + json.at("findings")[0].at("number").dump()));
    }
}
