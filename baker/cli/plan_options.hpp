// Flags that say what is baked of an object: which kinds, and how fine.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "baker/cli/app_fwd.hpp"
#include "baker/plan.hpp"
#include "dfield/dfield.h"

namespace dfield::cli {

// --kind, the displacement maps' flags (options.hpp), --direction-count --direction-levels --direction-size
// --direction-depth, --line-size --line-bits --line-depth-size --line-lookup --line-space, --volume-size
struct PlanOptions {
    // maps, lines, directions, volume, all; auto: what serves most, default_plan()'s kinds.
    std::string kind = "auto";
    FieldParameters maps;
    LineParameters lines;
    DirectionParameters directions;
    std::optional<std::uint32_t> direction_count;  // as given; directions.subdivision follows from it
    std::optional<std::uint32_t> direction_size;   // as given; --map-size where --kind directions
    std::optional<std::uint32_t> direction_depth;  // as given; otherwise none, or
    bool depths_by_default = false;                // as fine as the maps
    std::uint32_t direction_levels = 1;
    std::optional<std::uint32_t> volume_size;  // as given

    bool has_kind(const std::string& name) const;

    // For lookups: what --kind names, AUTO for auto and all.
    dfield_kind forced_kind() const;

    // What the flags mean. Call after parsing. Throws Error(kUsage) for what cannot be baked.
    FieldPlan plan() const;

    // What the flags were taken to mean where they cannot be met exactly: lines for people.
    std::vector<std::string> notes() const;
};
void add_plan_options(CLI::App& command, PlanOptions& options);

}  // namespace dfield::cli
