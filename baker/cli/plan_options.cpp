#include "baker/cli/plan_options.hpp"

#include <algorithm>

#include "baker/cli/arguments.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/report.hpp"
#include "baker/error.hpp"
#include "baker/provenance.hpp"

namespace dfield::cli {
namespace {

constexpr std::uint32_t kSmallestDirectionMap = 16;

}  // namespace

bool PlanOptions::has_kind(const std::string& name) const {
    if (kind == "all") return true;
    if (kind != "auto") return kind == name;
    const FieldPlan plan = default_plan();
    return (name == "maps" && plan.maps) || (name == "lines" && plan.lines) ||
           (name == "directions" && !plan.directions.empty()) || (name == "volume" && plan.volume);
}

dfield_kind PlanOptions::forced_kind() const {
    return kind == "maps"         ? DFIELD_KIND_MAPS
           : kind == "lines"      ? DFIELD_KIND_LINES
           : kind == "directions" ? DFIELD_KIND_DIRECTIONS
           : kind == "volume"     ? DFIELD_KIND_VOLUME
                                  : DFIELD_KIND_AUTO;
}

FieldPlan PlanOptions::plan() const {
    FieldPlan plan;
    if (has_kind("maps")) plan.maps = maps;
    if (has_kind("lines")) {
        plan.lines = lines;
        if (lines.depth_bits == 0) plan.lines->depth_lattice = 0;
    }
    if (has_kind("volume"))
        plan.volume = VolumeParameters{volume_size.value_or(VolumeParameters{}.size)};
    else if (volume_size)
        throw Error(ExitCode::kUsage, "--volume-size is for --kind volume or all, not " + kind);
    if (has_kind("directions")) {
        DirectionParameters finest = directions;
        if (direction_count) finest.subdivision = direction_subdivision(*direction_count);
        if (direction_size)
            finest.map_size = *direction_size;
        else if (kind == "directions" && maps.map_size != FieldParameters{}.map_size)
            finest.map_size = maps.map_size;
        finest.depth_size = direction_depth.value_or(depths_by_default ? finest.map_size : 0);
        // Each coarser level has half the subdivision and half the map size, as far as there is one.
        for (std::uint32_t level = 0; level < direction_levels; ++level) {
            plan.directions.insert(plan.directions.begin(), finest);
            DirectionParameters coarser = finest;
            coarser.subdivision = std::max(1u, finest.subdivision / 2);
            coarser.map_size = std::max(kSmallestDirectionMap, finest.map_size / 2);
            coarser.depth_size = std::min(finest.depth_size, coarser.map_size);
            if (coarser == finest) break;
            finest = coarser;
        }
    }
    if (const std::string error = plan_error(plan); !error.empty()) throw Error(ExitCode::kUsage, error);
    return plan;
}

std::vector<std::string> PlanOptions::notes() const {
    std::vector<std::string> notes;
    if (direction_count && has_kind("directions")) {
        const std::uint32_t n = direction_subdivision(*direction_count), count = dfield::direction_count(n);
        if (count != *direction_count)
            notes.push_back(text("--direction-count %u: %u directions are baked (4n^2+2 with n = %u)",
                                 *direction_count, count, n));
    }
    if (const std::size_t levels = plan().directions.size();
        has_kind("directions") && levels != direction_levels)
        notes.push_back(
            text("--direction-levels %u: %zu levels are baked, the coarsest has %u directions and "
                 "%ux%u maps",
                 direction_levels, levels, dfield::direction_count(plan().directions[0].subdivision),
                 plan().directions[0].map_size, plan().directions[0].map_size));
    return notes;
}

void add_plan_options(CLI::App& command, PlanOptions& options) {
    command
        .add_option(
            "--kind", options.kind,
            "What to bake: maps (displacement maps, for any ray and its first hit), lines (a line table, "
            "any ray's visibility), directions (direction maps, for batches of receivers), volume (an "
            "occlusion "
            "volume, for ambient occlusion alone), all of them, or auto: maps and directions")
        ->capture_default_str()
        ->transform(CLI::IsMember({"auto", "maps", "lines", "directions", "volume", "all"}, CLI::ignore_case))
        ->group("Field");
    add_field_options(command, options.maps);
    command
        .add_option(
            "--direction-count", options.direction_count,
            "Directions of the direction maps: 4n^2+2 (258, 1026, 4098); others take the largest such "
            "number below")
        ->default_str(std::to_string(direction_count(options.directions.subdivision)))
        ->check(CLI::Range(direction_count(1), direction_count(kMaxDirectionSubdivision)))
        ->group("Direction maps");
    command
        .add_option("--direction-size", options.direction_size,
                    "m: a direction map has m x m texels; with --kind directions --map-size says it too")
        ->default_str(std::to_string(options.directions.map_size))
        ->check(CLI::IsMember({16u, 32u, 64u, 128u}))
        ->group("Direction maps");
    command
        .add_option("--direction-levels", options.direction_levels,
                    "Levels of detail: each coarser one has half the subdivision n and half the map size")
        ->capture_default_str()
        ->check(CLI::Range(1u, kMaxDirectionLevels))
        ->group("Direction maps");
    command
        .add_option(
            "--direction-depth", options.direction_depth,
            "Also the nearest and farthest hit of each direction, in maps of d x d texels (0: none), for "
            "receivers within the sphere and bounded distances")
        ->default_str(options.depths_by_default ? "--direction-size" : "0")
        ->check(CLI::IsMember({0u, 8u, 16u, 32u, 64u, 128u}))
        ->group("Direction maps");
    command
        .add_option("--line-size", options.lines.lattice,
                    "s: chords between s x s points of the bounding sphere or ellipsoid")
        ->capture_default_str()
        ->check(CLI::Range(kMinLineLattice, kMaxLineLattice))
        ->group("Line table");
    command
        .add_option(
            "--line-bits", options.lines.depth_bits,
            "Bits of a chord's last hit, for receivers within the sphere and bounded distances (0: none)")
        ->capture_default_str()
        ->check(CLI::IsMember({0u, 4u, 8u}))
        ->group("Line table");
    command.add_option("--line-depth-size", options.lines.depth_lattice, "As --line-size, of the last hits")
        ->capture_default_str()
        ->check(CLI::Range(kMinLineLattice, kMaxLineLattice))
        ->group("Line table");
    const auto lookup = [&options](const std::string& name) {
        options.lines.pivot = name == "pivot";
        options.lines.filtered = name == "filtered";
    };
    command
        .add_option_function<std::string>("--line-lookup", lookup,
                                          "Which chords stand for a line: nearest; pivot, the one from the "
                                          "nearest start through the line's "
                                          "middle; filtered, the majority of those around")
        ->default_str(lookup_name(options.lines))
        ->transform(CLI::IsMember({"nearest", "pivot", "filtered"}, CLI::ignore_case))
        ->group("Line table");
    const auto space = [&options](const std::string& name) { options.lines.ellipsoid = name == "ellipsoid"; };
    command.add_option_function<std::string>("--line-space", space, "What the chords' points lie on")
        ->default_str(options.lines.ellipsoid ? "ellipsoid" : "sphere")
        ->transform(CLI::IsMember({"ellipsoid", "sphere"}, CLI::ignore_case))
        ->group("Line table");
    command
        .add_option("--volume-size", options.volume_size,
                    "Samples along the longest side of the occlusion volume's grid around the object")
        ->default_str(std::to_string(VolumeParameters{}.size))
        ->check(CLI::Range(kSmallestVolume, kMaxVolumeSize))
        ->group("Occlusion volume");
}

}  // namespace dfield::cli
