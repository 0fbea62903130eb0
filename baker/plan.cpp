#include "baker/plan.hpp"

#include <algorithm>

#include "baker/bake_directions.hpp"
#include "baker/bake_lines.hpp"
#include "baker/bounding_sphere.hpp"
#include "baker/error.hpp"
#include "baker/provenance.hpp"
#include "format/contents.hpp"

namespace dfield {

FieldPlan default_plan() {
    return {FieldParameters{}, std::nullopt, {DirectionParameters{}}};
}

FieldPlan plan_of(const DisplacementField& field) {
    FieldPlan plan;
    if (has_maps(field.parameters)) plan.maps = field.parameters;
    if (field.lines) plan.lines = field.lines->parameters;
    for (const DirectionMaps& level : field.directions) plan.directions.push_back(level.parameters);
    if (field.volume) {
        const auto& dims = field.volume->dims;
        plan.volume = VolumeParameters{*std::max_element(dims.begin(), dims.end())};
    }
    return plan;
}

std::string plan_error(const FieldPlan& plan) {
    if (!plan.maps && !plan.lines && plan.directions.empty() && !plan.volume)
        return "nothing to bake: neither displacement maps nor a line table nor direction maps nor an "
               "occlusion volume";
    if (plan.maps)
        if (std::string error = parameters_error(*plan.maps); !error.empty()) return error;
    if (plan.lines)
        if (std::string error = line_parameters_error(*plan.lines); !error.empty()) return error;
    if (plan.volume)
        if (std::string error = volume_parameters_error(*plan.volume); !error.empty()) return error;
    if (plan.directions.size() > kMaxDirectionLevels)
        return std::to_string(plan.directions.size()) + " levels of direction maps, at most " +
               std::to_string(kMaxDirectionLevels) + " are possible";
    std::uint64_t bytes = 0;
    for (std::size_t level = 0; level < plan.directions.size(); ++level) {
        const DirectionParameters& parameters = plan.directions[level];
        if (std::string error = direction_parameters_error(parameters); !error.empty()) return error;
        if (level > 0 && !finer_level(plan.directions[level - 1], parameters))
            return "levels of direction maps must come coarse first, each with at least the directions and "
                   "the map "
                   "size of the one before";
        bytes += direction_maps_bytes(parameters);
    }
    if (bytes > kMaxDirectionBytes)
        return "the direction maps would take " + std::to_string(bytes) + " bytes, more than the format's " +
               std::to_string(kMaxDirectionBytes) + "; lower the count of directions or the map size";
    return {};
}

std::uint64_t plan_bytes(const FieldPlan& plan) {
    std::uint64_t bytes = 0;
    if (plan.maps) {
        bytes += texel_bytes(*plan.maps);
        if (plan.maps->bits == 1) bytes += 2 * position_count(*plan.maps);
    }
    if (plan.lines) bytes += 4 * (line_hit_words(*plan.lines) + line_depth_words(*plan.lines));
    for (const DirectionParameters& level : plan.directions) bytes += direction_maps_bytes(level);
    if (plan.volume) bytes += volume_parameters_bytes(*plan.volume);
    return bytes;
}

DisplacementField bake_plan(const TriangleMesh& mesh, const FieldPlan& plan, const BakeOptions& options,
                            BakeReport* report) {
    if (const std::string error = plan_error(plan); !error.empty()) throw InputError(error);
    BakeOptions of_maps = options;
    of_maps.parameters = plan.maps.value_or(kNoMaps);
    BakeReport result;
    DisplacementField field = bake_field(mesh, of_maps, &result);
    const BoundingSphere sphere{field.centre, field.radius};
    const auto add = [&](const auto& part) {
        result.rays += part.rays;
        result.build_seconds += part.build_seconds;
        result.trace_seconds += part.trace_seconds;
    };
    if (plan.lines) {
        LineBakeReport part;
        field.lines = bake_lines(mesh, sphere, {*plan.lines, options.threads, options.cancel}, &part);
        add(part);
    }
    for (const DirectionParameters& level : plan.directions) {
        DirectionBakeReport part;
        field.directions.push_back(
            bake_directions(mesh, sphere, {level, options.threads, options.cancel}, &part));
        add(part);
    }
    if (plan.volume) {
        VolumeBakeReport part;
        field.volume = bake_volume(mesh, sphere, {*plan.volume, options.threads, options.cancel}, &part);
        add(part);
    }
    field.provenance = provenance_json(mesh, plan, options, result.instruction_set);
    if (report) *report = result;
    return field;
}

}  // namespace dfield
