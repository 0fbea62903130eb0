// What is baked of an object: any of the four kinds, in one field.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "baker/bake.hpp"
#include "baker/bake_volume.hpp"
#include "format/field.hpp"

namespace dfield {

struct FieldPlan {
    std::optional<FieldParameters> maps = {};          // displacement maps
    std::optional<LineParameters> lines = {};          // line table
    std::vector<DirectionParameters> directions = {};  // levels of direction maps, coarse first
    std::optional<VolumeParameters> volume = {};       // occlusion volume

    bool operator==(const FieldPlan&) const = default;
};

// The kinds of the plan that `dfield bake` follows when nothing is said: displacement maps for any ray,
// direction maps for batches of receivers.
FieldPlan default_plan();

// The plan that a field was baked to.
FieldPlan plan_of(const DisplacementField& field);

// Empty when the plan can be baked, otherwise what is wrong and what is allowed.
std::string plan_error(const FieldPlan& plan);

// Bytes that the kinds take in memory once loaded, without sphere, self visibilities and provenance. Of an
// occlusion volume, which depends on the object's proportions, the most that it can be.
std::uint64_t plan_bytes(const FieldPlan& plan);

// A field of all that the plan names, provenance filled in. options.parameters are not read. Throws
// InputError for a mesh without extent and for plans that cannot be baked. In the report, rays and seconds
// are those of all kinds.
DisplacementField bake_plan(const TriangleMesh& mesh, const FieldPlan& plan, const BakeOptions& options,
                            BakeReport* report = nullptr);

}  // namespace dfield
