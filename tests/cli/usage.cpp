// Help, exit codes and messages: what a user meets who gets something wrong.
#include <catch2/catch.hpp>
#include <filesystem>

#include "tests/cli/command.hpp"
#include "tests/test_data.hpp"

namespace {

using namespace dfield::test;
namespace fs = std::filesystem;

struct Mistake {
    Arguments arguments;
    std::string said;  // part of the message
};

void check_mistakes(const Shell& shell, const std::vector<Mistake>& mistakes, int exit_code) {
    for (const auto& [arguments, said] : mistakes) check_mistake(shell, arguments, exit_code, said);
}

Mistake bake(Arguments more, const std::string& said) {
    Arguments arguments{"bake", "cube.obj", "-o", "out.dfield"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return {arguments, said};
}

Mistake ao(Arguments more, const std::string& said) {
    Arguments arguments{"ao", "cube.obj", "-o", "out.glb"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return {with_small_field(arguments), said};
}

}  // namespace

TEST_CASE("help and version go to stdout and name everything") {
    const Shell shell;
    const Run help = shell.run({"--help"});
    CHECK(help.exit_code == 0);
    CHECK(help.err.empty());
    for (const char* word :
         {"bake", "info", "validate", "ao", "compare", "volume", "Examples", "Exit codes", "130"})
        CHECK(contains(help.out, word));
    for (const std::string command : {"bake", "info", "validate", "ao", "compare"}) {
        INFO(command);
        const Run own = shell.run({command, "--help"});
        CHECK(own.exit_code == 0);
        CHECK(own.err.empty());
        CHECK(contains(own.out, "Usage: dfield " + command));
        CHECK(contains(own.out, "--json"));
    }
    const Run bake = shell.run({"bake", "--help"});
    for (const char* option : {"--output", "--subdivision", "--map-size", "--mapping", "--positions",
                               "--bits", "--threads", "--mesh", "--node", "4226", "concentric"})
        CHECK(contains(bake.out, option));
    const Run version = shell.run({"--version"});
    CHECK(version.exit_code == 0);
    CHECK(version.out == "dfield " DFIELD_VERSION "\n");
}

TEST_CASE("wrong usage is exit code 2") {
    const Shell shell;
    fs::create_directories(shell.folder() / "other");
    fs::copy_file(shell.folder() / "cube.obj", shell.folder() / "other/cube.obj");
    fs::copy_file(shell.folder() / "cube.obj", shell.folder() / "scene.ply");
    check_mistakes(
        shell,
        {{{}, "subcommand is required"},
         {{"frobnicate"}, "subcommand is required"},
         {{"bake"}, "MODEL is required"},
         {{"bake", "cube.obj"}, "--output is required"},
         {{"info"}, "FILE is required"},
         {{"validate"}, "FILE is required"},
         {{"validate", "--frobnicate", "cube.obj"}, "--frobnicate"},
         {{"ao", "cube.obj"}, "--output is required"},
         {{"compare"}, "--caster"},
         {{"compare", "--scene", "corner-contact"}, "--caster"},
         {{"compare", "--caster", "missing.obj"}, "missing.obj"},
         {{"compare", "--field", "cube.obj"}, "--caster"},
         {{"compare", "--caster", "cube.obj", "--image", "picture.jpg"}, ".png"},
         bake({"--frobnicate"}, "--frobnicate"),
         bake({"--subdivision", "0"}, "1 to 256"),
         bake({"--subdivision", "257"}, "1 to 256"),
         bake({"--subdivision", "-3"}, "1 to 256"),
         bake({"--subdivision", "4.5"}, "--subdivision"),
         bake({"--map-size", "0"}, "1 to 1024"),
         bake({"--map-size", "many"}, "--map-size"),
         bake({"--mapping", "square"}, "{concentric,polar,rejection}"),
         bake({"--mapping", "1"}, "{concentric,polar,rejection}"),
         bake({"--positions", "random"}, "{slater,latlong}"),
         bake({"--bits", "4"}, "{1,8,16,32}"),
         bake({"--threads", "0"}, "--threads"),
         bake({"--crease", "nan"}, "0 to 180"),
         bake({"--subdivision", "256", "--map-size", "1024"}, "lower the subdivision"),
         bake({"--mesh", "a", "--node", "b"}, "excludes"),
         bake({"--budget", "lots"}, "--budget"),
         bake({"--budget", "0"}, "--budget"),
         bake({"--budget", "-4K"}, "--budget"),
         bake({"--budget", "100"}, "smallest field fits"),
         bake({"--budget", "8K", "--bits", "1"}, "excludes"),
         bake({"--budget", "8K", "--line-size", "9"}, "excludes"),
         bake({"--budget", "8K", "--kind", "all"}, "chooses one kind"),
         {{"compare", "--budget", "8K"}, "--caster"},
         {{"compare", "--budget", "8K", "--caster", "cube.obj", "--field", "cube.obj"}, "excludes"},
         ao({"--kind", "all"}, "one kind"),
         ao({"--kind", "points"}, "{auto,maps,lines,directions,volume,all}"),
         ao({"--kind", "directions", "--rays", "4097"}, "at most 4096"),
         ao({"--kind", "volume", "--max-distance", "1"}, "take --kind maps"),
         ao({"--kind", "volume", "--bias", "1"}, "take --kind maps"),
         bake({"--volume-size", "20"}, "is for --kind volume"),
         bake({"--kind", "volume", "--volume-size", "11"}, "12"),
         bake({"--kind", "volume", "--volume-size", "257"}, "256"),
         bake({"--budget", "64K", "--kind", "volume", "--volume-size", "20"}, "excludes"),
         {{"ao", "cube.obj", "-o", "out.glb", "--kind", "directions", "--direction-depth", "0", "--bias",
           "1"},
          "--direction-depth 16"},
         ao({"--kind", "lines", "--line-bits", "0", "--max-distance", "1"}, "--line-bits"),
         {{"bake", "cube.obj", "-o", "cube.obj"}, ".dfield"},  // would replace the model
         {{"bake", "cube.obj", "-o", "cube"}, "/ for a folder"},
         {{"bake", "cube.obj", "-o", "cube.glb"}, ".dfield"},
         {{"bake", "cube.obj", "-o", ""}, ".dfield"},
         {{"bake", "cube.obj", "other/cube.obj", "-o", "."}, "would both become"},
         ao({"--method", "guess"}, "{lookup,rays}"),
         ao({"--rays", "0"}, "--rays"),
         ao({"--rays", "65537"}, "--rays"),
         ao({"--max-distance", "0"}, "above 0"),
         ao({"--max-distance", "nan"}, "above 0"),
         ao({"--bias", "-1"}, "0 or above"),
         ao({"--bias", "nan"}, "0 or above"),
         ao({"--falloff", "linear"}, "--max-distance"),
         ao({"--falloff", "cubic"}, "none,linear,smooth,exponential,table"),
         ao({"--falloff", "table", "--max-distance", "1"}, "--falloff-table"),
         ao({"--falloff-table", "cube.obj"}, "--falloff table"),
         ao({"--ground", "nan"}, "--ground"),
         ao({"--ground-plane", "0", "0", "0", "1"}, "normal is zero"),
         ao({"--ground-plane", "0", "1", "0"}, "4 required"),
         ao({"--ground", "0", "--ground-plane", "0", "1", "0", "0"}, "excludes"),
         ao({"--up", "x"}, "{y,z}"),
         ao({"--image", "picture.jpg"}, ".png"),
         {{"ao", "cube.obj", "-o", "out.obj"}, ".glb, .gltf or .ply"},
         {{"ao", "cube.obj", "-o", "out"}, ".glb, .gltf or .ply"},
         {{"ao", "cube.obj", "-o", "out.gltf"}, "glTF scene"},
         {{"ao", "cube.obj", "-o", "out.ply", "--color"}, "--color"},
         {{"ao", "scene.ply", "-o", "scene.ply"}, "scene itself"}},
        2);
}

TEST_CASE("an input that cannot be read is exit code 3") {
    const Shell shell;
    shell.write("empty.obj", "");
    shell.write("empty.glb", "");
    shell.write("empty.dfield", "");
    shell.write("point.obj", "v 0 0 0\n");
    shell.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    shell.write("text.ply", "a shopping list\n");
    shell.write("text.glb", "a shopping list\n");
    shell.write("table.txt", "1 0.5 2\n");
    shell.write("words.txt", "1 half 0\n");
    shell.write("one.glb", [] {
        std::string text = R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_unheard_of"]})";
        text.append((4 - text.size() % 4) % 4, ' ');
        const auto size = static_cast<std::uint32_t>(text.size());
        return bytes_of<std::uint32_t>({0x46546c67, 2, 20 + size, size, 0x4e4f534a}) + text;
    }());
    fs::create_directories(shell.folder() / "folder.obj");
    REQUIRE(shell.run(with_small_field({"bake", "cube.obj", "-o", "cube.dfield"})).exit_code == 0);
    const auto table = [](const char* name) {
        return Arguments{"--falloff", "table", "--max-distance", "1", "--falloff-table", name};
    };
    check_mistakes(shell,
                   {{{"bake", "missing.obj", "-o", "out.dfield"}, "missing.obj: no such file"},
                    {{"bake", "empty.obj", "-o", "out.dfield"}, "empty.obj: no usable triangle"},
                    {{"bake", "empty.glb", "-o", "out.dfield"}, "empty.glb"},
                    {{"bake", "point.obj", "-o", "out.dfield"}, "no usable triangle"},
                    {{"bake", "flat.obj", "-o", "out.dfield"}, "1 without area"},
                    {{"bake", "text.ply", "-o", "out.dfield"}, "text.ply"},
                    {{"bake", "text.glb", "-o", "out.dfield"}, "text.glb"},
                    {{"bake", "one.glb", "-o", "out.dfield"}, "KHR_unheard_of"},
                    {{"bake", "folder.obj", "-o", "out.dfield"}, "is a folder"},
                    {{"bake", ".", "-o", "out.dfield"}, "unknown kind of file"},
                    {{"bake", "cube.dfield", "-o", "out.dfield"}, "unknown kind of file '.dfield'"},
                    bake({"--mesh", "nobody"}, "no mesh is called 'nobody'"),
                    bake({"--node", "nobody"}, "no node is called 'nobody'"),
                    {{"info", "missing.dfield"}, "no such file"},
                    {{"info", "cube.obj"}, "not a .dfield"},
                    {{"info", "empty.dfield"}, "0 bytes"},
                    {{"info", "."}, "is a folder"},
                    {{"validate", "missing.dfield"}, "no such file"},
                    {{"ao", "missing.glb", "-o", "out.glb"}, "no such file"},
                    {{"ao", "flat.obj", "-o", "out.glb"}, "no usable triangle"},
                    ao(table("table.txt"), "entry 3 is outside 0..1"),
                    ao(table("words.txt"), "entry 2 is no number"),
                    {{"compare", "--scene", "missing.glb"}, "no such file"},
                    {{"compare", "--caster", "empty.obj"}, "no usable triangle"},
                    {{"compare", "--caster", "cube.obj", "--field", "cube.obj"}, "not a .dfield"},
                    {with_small_field({"compare", "--scene", "cube.obj"}), "fewer than two objects"}},
                   3);
}

TEST_CASE("an output that cannot be written is exit code 4") {
    const Shell shell;
    shell.write("file", "");
    fs::create_directories(shell.folder() / "folder.dfield/inside");
    fs::create_directories(shell.folder() / "folder.glb");
    check_mistakes(shell,
                   {{{"bake", "cube.obj", "-o", "nowhere/out.dfield"}, "nowhere does not exist"},
                    {{"bake", "cube.obj", "-o", "file/out.dfield"}, "file/out.dfield"},
                    {{"bake", "cube.obj", "-o", "file/"}, "file/"},
                    {with_small_field({"ao", "cube.obj", "-o", "nowhere/out.glb"}), "nowhere does not exist"},
                    {with_small_field({"ao", "cube.obj", "-o", "folder.glb"}), "a folder of that name"},
                    ao({"--image", "nowhere/out.png"}, "nowhere does not exist"),
                    {with_small_field({"compare", "--caster", "cube.obj", "--image", "nowhere/out.png"}),
                     "nowhere does not exist"}},
                   4);
    // Found out when the work is done; what was written before stays.
    CHECK(shell.run(with_small_field({"bake", "cube.obj", "-o", "out.dfield", "--json", "nowhere/r.json"}))
              .exit_code == 4);
    CHECK(shell.run(with_small_field({"bake", "cube.obj", "-o", "out.dfield"})).exit_code == 0);
    CHECK(shell.run({"info", "out.dfield", "--json", "nowhere/r.json"}).exit_code == 4);
    if (!fs::exists("/dev/full")) return skip("no /dev/full");
    const Run full = shell.run(with_small_field({"bake", "cube.obj", "-o", "/dev/full"}));
    CHECK(full.exit_code == 4);
    CHECK(contains(full.err, "No space left"));
    CHECK(shell.run({"info", "out.dfield"}, "/dev/full").exit_code == 4);
    CHECK(shell.run({"info", "out.dfield", "--json", "-"}, "/dev/full").exit_code == 4);
}

TEST_CASE("Ctrl-C is exit code 130 and leaves nothing behind") {
    const Shell shell;
    fs::copy_file(source_file("models/leafy_tree.obj"), shell.folder() / "tree.obj");
    const auto before = shell.list();
    const Arguments large{"--subdivision", "128", "--map-size", "64", "--threads", "1"};
    for (Arguments arguments :
         {Arguments{"bake", "tree.obj", "-o", "tree.dfield"}, Arguments{"ao", "tree.obj", "-o", "tree.glb"},
          Arguments{"compare", "--caster", "tree.obj", "--image", "tree.png"}}) {
        arguments.insert(arguments.end(), large.begin(), large.end());
        INFO(arguments[0]);
        const Run run = shell.interrupt(arguments);
        CHECK(run.exit_code == 130);
        CHECK(run.out.empty());
        CHECK(contains(run.err, "interrupted"));
        CHECK(shell.list() == before);
        CHECK(fs::is_empty(shell.cache()));
    }
    // A batch ends too, rather than counting the model as failed and going on; its folder is there, but
    // empty.
    Arguments batch{"bake", "tree.obj", "cube.obj", "-o", "baked/", "--json", "-"};
    batch.insert(batch.end(), large.begin(), large.end());
    const Run run = shell.interrupt(batch);
    CHECK(run.exit_code == 130);
    CHECK(run.out.empty());
    CHECK(shell.list("baked").empty());
}
