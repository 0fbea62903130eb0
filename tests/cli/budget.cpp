// --budget: what is tried, that the best of it is taken, that it fits.
#include <catch2/catch.hpp>
#include <filesystem>
#include <set>
#include <string>

#include "dfield/dfield.hpp"
#include "tests/cli/command.hpp"
#include "tests/cli/json_checks.hpp"

namespace {

using namespace dfield::test;
namespace fs = std::filesystem;

Json bake(const Shell& shell, const Arguments& more) {
    Arguments arguments{"bake", "cube.obj", "-o", "out.dfield", "--json", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Run run = shell.run(arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return run.json();
}

dfield_field_info loaded(const fs::path& path) {
    const dfield::Context context;
    return dfield::Field::load(context, path.c_str()).info();
}

// That the report names candidates within the budget, and as the winner the one of least error in the corner.
// Returns the winner.
Json check_choice(const Json& budget, double bytes) {
    CHECK(budget.at("bytes") == bytes);
    const Json& candidates = budget.at("candidates");
    const Json winner = candidates.at(budget.at("chosen").get<std::size_t>());
    int coincidences = 0;  // by other rays other errors; of many, two may agree to all digits
    for (const Json& candidate : candidates) {
        number(candidate, "memory_bytes", 100, bytes);
        for (const char* scene : {"corner", "corner-contact"}) {
            const double rms = number(candidate.at(scene), "rms_grey", 0.01, 100);
            number(candidate.at(scene), "max_grey", rms, 255);
            coincidences += number(candidate.at(scene), "rms_grey_converged", 0.01, 100) == rms;
        }
        CHECK(candidate.at("corner").at("rms_grey") >=
              winner.at("corner").at("rms_grey").get<double>() - 0.01);
    }
    CHECK(coincidences <= 1);
    return winner;
}

}  // namespace

TEST_CASE("bake --budget takes the most accurate of the kinds that fit") {
    const Shell shell;
    const Json json = bake(shell, {"--budget", "24K"});
    const Json winner = check_choice(json.at("budget"), 24 * 1024);
    std::set<std::string> kinds;
    for (const Json& candidate : json.at("budget").at("candidates")) kinds.insert(candidate.at("kind"));
    CHECK(kinds == std::set<std::string>{"directions", "lines", "maps"});
    // What was measured is what was written.
    REQUIRE(json.at("kinds").size() == 1);
    for (const auto& [key, value] : json.at("kinds")[0].items())
        if (!contains(key, "bytes")) CHECK(winner.at(key) == value);
    const dfield_field_info info = loaded(shell.folder() / "out.dfield");
    CHECK(info.memory_bytes <= 24 * 1024);
    CHECK(info.memory_bytes > 12 * 1024);  // fills it
    const std::string hash = json.at("payload_hash");
    CHECK(bake(shell, {"--budget", "24576", "--threads", "1"}).at("payload_hash") == hash);
    CHECK(contains(shell.run({"info", "out.dfield"}).out, winner.at("kind").get<std::string>()));
    // More memory, less error.
    const Json more = check_choice(bake(shell, {"--budget", "256K"}).at("budget"), 256 * 1024);
    CHECK(more.at("corner").at("rms_grey").get<double>() < winner.at("corner").at("rms_grey").get<double>());
}

TEST_CASE("--kind restricts --budget") {
    const Shell shell;
    for (const std::string kind : {"maps", "lines", "directions"}) {
        INFO(kind);
        const Json json = bake(shell, {"--budget", "16K", "--kind", kind});
        check_choice(json.at("budget"), 16 * 1024);
        for (const Json& candidate : json.at("budget").at("candidates")) CHECK(candidate.at("kind") == kind);
        CHECK(json.at("kinds").at(0).at("kind") == kind);
    }
}

TEST_CASE("--budget takes the largest occlusion volume that fits") {
    const Shell shell;
    const Json json = bake(shell, {"--budget", "48K", "--kind", "volume"});
    const Json winner = check_choice(json.at("budget"), 48 * 1024);
    CHECK(json.at("budget").at("candidates").size() == 1);
    CHECK(winner.at("kind") == "volume");
    CHECK(winner.at("dims")[0].get<int>() >= 16);
}

TEST_CASE("--budget leaves room for what --self and --verify add") {
    const Shell shell;
    const Json json = bake(shell, {"--budget", "8K", "--self", "--verify"});
    CHECK(json.contains("verified"));
    const dfield_field_info info = loaded(shell.folder() / "out.dfield");
    CHECK(info.self_vertex_count > 0);
    CHECK(info.memory_bytes <= 8 * 1024);
}

TEST_CASE("a batch with --budget skips what was chosen for the same budget") {
    const Shell shell;
    const auto status = [&](const Arguments& more) {
        Arguments arguments{"bake", "cube.obj", "-o", "baked/", "--json", "-"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return shell.run(arguments).json().at("models")[0].at("status").get<std::string>();
    };
    CHECK(status({"--budget", "8K"}) == "baked");
    CHECK(status({"--budget", "8K"}) == "unchanged");
    CHECK(status({"--budget", "9K"}) == "baked");
    CHECK(status({"--budget", "9K", "--kind", "maps"}) == "baked");
    CHECK(status({"--budget", "9K", "--kind", "maps"}) == "unchanged");
}

TEST_CASE("compare --budget compares the winner") {
    const Shell shell;
    const Run run = shell.run({"compare", "--caster", "cube.obj", "--budget", "16K", "--repetitions", "1",
                               "--converged-rays", "64", "--json", "-"});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    const Json json = run.json();
    const Json winner = check_choice(json.at("budget"), 16 * 1024);
    CHECK(json.at("kind") == winner.at("kind"));
    CHECK(number(json, "field_bytes", 1024, 16 * 1024) > 0);
    // Other rays, the same field: about the same error.
    const double rms = winner.at("corner").at("rms_grey").get<double>();
    number(json, "rms_grey", 0.5 * rms, 2 * rms);
    CHECK(fs::is_empty(shell.cache()));
    CHECK(contains(run.err, "budget 16.0 KiB"));
}
