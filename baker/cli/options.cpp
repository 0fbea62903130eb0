#include "baker/cli/options.hpp"

#include <cmath>
#include <fstream>
#include <limits>

#include "baker/cli/arguments.hpp"
#include "baker/cli/report.hpp"
#include "baker/error.hpp"
#include "baker/file_io.hpp"

namespace dfield::cli {
namespace {

// CLI::Range and its kin let NaN through.
template<class Accept>
CLI::Validator number_that(const std::string& is, const std::string& shown, const Accept& accept) {
    return CLI::Validator(
        [=](std::string& input) {
            double value = 0;
            const bool good =
                CLI::detail::lexical_cast(input, value) && std::isfinite(value) && accept(value);
            return good ? std::string() : input + " is no number" + is;
        },
        shown);
}

}  // namespace

CLI::Validator number_between(double low, double high) {
    const std::string range = text("%g to %g", low, high);
    return number_that(" from " + range, range, [=](double value) { return value >= low && value <= high; });
}

CLI::Validator number_above_zero() {
    return number_that(" above 0", "above 0", [](double value) { return value > 0; });
}

CLI::Validator number_from_zero() {
    return number_that(" of 0 or above", "0 or above", [](double value) { return value >= 0; });
}

CLI::Validator finite_number() {
    return number_that("", "", [](double) { return true; });
}

void add_field_options(CLI::App& command, FieldParameters& parameters) {
    command
        .add_option(
            "--subdivision", parameters.subdivision,
            "n: positional samples on the bounding sphere. 8, 16, 32, 64 or any n up to 256; Slater's layout "
            "stores 4n^2+2 of them (n=32: 4098, which the paper counts as 4226)")
        ->capture_default_str()
        ->check(CLI::Range(1u, kMaxSubdivision))
        ->group("Field");
    command
        .add_option("--map-size", parameters.map_size,
                    "m: each sample's displacement map has m x m directions")
        ->capture_default_str()
        ->check(CLI::Range(1u, kMaxMapSize))
        ->group("Field");
    add_choice(command, "--mapping", parameters.mapping,
               {{"concentric", Mapping::kConcentric},
                {"polar", Mapping::kPolar},
                {"rejection", Mapping::kRejection}},
               "How a map's texels cover the hemisphere; concentric is the most accurate")
        ->group("Field");
    add_choice(command, "--positions", parameters.positions,
               {{"slater", Positions::kSlater}, {"latlong", Positions::kLatlong}},
               "Layout of positional samples: slater is even; latlong is the paper's uniform comparison, "
               "(2n+1) x (2n+2)")
        ->group("Field");
    command
        .add_option("--bits", parameters.bits,
                    "Bits a texel: 8 distances, 1 visibility with a mean depth a sample, 16, 32 (float)")
        ->capture_default_str()
        ->check(CLI::IsMember({1u, 8u, 16u, 32u}))
        ->group("Field");
}

void add_json_option(CLI::App& command, std::string& target, const std::string& what) {
    command.add_option("--json", target, "Also write " + what + " as JSON to this file (- for stdout)")
        ->type_name("FILE")
        ->each([](const std::string& file) {  // before the work, not after it
            if (file != "-") check_output(file);
        });
}

void add_repetitions_option(CLI::App& command, int& repetitions, const std::string& what) {
    command.add_option("--repetitions", repetitions, what)->capture_default_str()->check(CLI::Range(1, 1000));
}

void add_common_options(CLI::App& command, CommonOptions& options, const std::string& threads_default) {
    command.add_option("--threads", options.threads, "Threads; results do not depend on it")
        ->default_str(threads_default)
        ->check(CLI::Range(1, 1024));
    add_json_option(command, options.json, "the report");
    command.add_flag("--quiet,-q", options.quiet, "No progress");
}

void add_ao_options(CLI::App& command, AoOptions& options) {
    command
        .add_option("--rays", options.desc.ray_count,
                    "Cosine-weighted rays a vertex; a square number gives a grid")
        ->capture_default_str()
        ->check(CLI::Range(1, 65536))
        ->group("Ambient occlusion");
    command
        .add_option("--max-distance", options.desc.max_distance,
                    "Hits further than this (world units) do not occlude; default: any distance does")
        ->check(number_above_zero())
        ->group("Ambient occlusion");
    add_choice<std::uint32_t>(command, "--falloff", options.desc.falloff,
                              {{"none", DFIELD_FALLOFF_NONE},
                               {"linear", DFIELD_FALLOFF_LINEAR},
                               {"smooth", DFIELD_FALLOFF_SMOOTH},
                               {"exponential", DFIELD_FALLOFF_EXPONENTIAL},
                               {"table", DFIELD_FALLOFF_TABLE}},
                              "How occlusion falls to nothing at --max-distance (which all but none need)")
        ->group("Ambient occlusion");
    command.add_option("--falloff-rate", options.desc.falloff_rate, "k of the exponential falloff")
        ->capture_default_str()
        ->check(number_between(0.001, 80))
        ->group("Ambient occlusion");
    command
        .add_option("--falloff-table", options.table_file,
                    "Text file of visibilities (0..1) at even steps of distance from 0 to --max-distance")
        ->check(CLI::ExistingFile)
        ->group("Ambient occlusion");
    command.add_option("--bias", options.desc.bias, "Hits nearer than this (world units) do not count")
        ->capture_default_str()
        ->check(number_from_zero())
        ->group("Ambient occlusion");
}

void finish_ao_options(AoOptions& options) {
    dfield_ao_desc& desc = options.desc;
    if (desc.falloff != DFIELD_FALLOFF_NONE && !std::isfinite(desc.max_distance))
        throw Error(ExitCode::kUsage, "--falloff needs --max-distance, the distance at which it ends");
    if ((desc.falloff == DFIELD_FALLOFF_TABLE) != !options.table_file.empty())
        throw Error(ExitCode::kUsage, "--falloff table and --falloff-table FILE go together");
    if (options.table_file.empty()) return;
    std::ifstream file(options.table_file);
    for (float value; file >> value;) options.table.push_back(value);
    if (!file.eof() || options.table.size() < 2)
        throw InputError(
            options.table_file + ": entry " + std::to_string(options.table.size() + 1) +
            " is no number, or there are fewer than two; expected visibilities separated by white space");
    for (std::size_t i = 0; i < options.table.size(); ++i)
        if (!(options.table[i] >= 0 && options.table[i] <= 1))
            throw InputError(options.table_file + ": entry " + std::to_string(i + 1) + " is outside 0..1");
    desc.falloff_table = options.table.data();
    desc.falloff_table_size = options.table.size();
}

}  // namespace dfield::cli
