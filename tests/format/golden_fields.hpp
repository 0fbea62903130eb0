// The fields in tests/golden.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/format/kinds.hpp"

namespace dfield::test {

// What tests/golden holds, by file name. A released version's list never changes; a new version adds names.
struct GoldenField {
    std::string name;
    DisplacementField field;
};

inline std::vector<GoldenField> golden_fields() {
    std::vector<GoldenField> fields;
    const auto add = [&](const char* name, const FieldParameters& p, Pattern pattern,
                         bool optional_sections) {
        fields.push_back({name, make_field(p, pattern, 7)});
        if (optional_sections) add_optional_sections(fields.back().field);
    };
    add("v1.0-1bit.dfield", {Positions::kSlater, 2, Mapping::kConcentric, 5, 1}, Pattern::kSmooth, true);
    add("v1.0-8bit.dfield", {Positions::kSlater, 2, Mapping::kConcentric, 8, 8}, Pattern::kSmooth, true);
    add("v1.0-8bit-noise.dfield", {Positions::kLatlong, 2, Mapping::kRejection, 6, 8}, Pattern::kNoise,
        false);
    add("v1.0-16bit.dfield", {Positions::kSlater, 2, Mapping::kPolar, 4, 16}, Pattern::kSmooth, false);
    add("v1.0-32bit.dfield", {Positions::kSlater, 2, Mapping::kConcentric, 4, 32}, Pattern::kSmooth, true);

    const auto add_kinds = [&](const char* name, DisplacementField field) {
        fields.push_back({name, std::move(field)});
    };
    DisplacementField lines = make_empty_field(), depths = make_empty_field(), noise = make_empty_field(),
                      directions = make_empty_field();
    lines.lines = make_line_table(line_parameters(9), Pattern::kSmooth);
    depths.lines = make_line_table(line_parameters(6, 8, 5, true), Pattern::kSmooth);
    for (const DirectionParameters& p : {DirectionParameters{1, 16, 0}, {2, 32, 8}, {3, 64, 0}})
        directions.directions.push_back(make_direction_maps(p, Pattern::kSmooth));
    // Stored plain.
    noise.lines = make_line_table(line_parameters(5, 4, 3), Pattern::kNoise, 7);
    noise.directions.push_back(make_direction_maps({1, 16, 8}, Pattern::kNoise, 7));
    add_kinds("v1.1-lines.dfield", std::move(lines));
    add_kinds("v1.1-line-depths.dfield", std::move(depths));
    add_kinds("v1.1-directions.dfield", std::move(directions));
    add_kinds("v1.1-noise.dfield", std::move(noise));
    add_kinds("v1.1-all-kinds.dfield", make_all_kinds(1));

    DisplacementField volume = make_empty_field(), volume_noise = make_empty_field();
    volume.volume = make_volume({9, 7, 8}, 5, Pattern::kSmooth);
    volume_noise.volume = make_volume({4, 5, 4}, 3, Pattern::kNoise, 7);
    add_kinds("v1.2-volume.dfield", std::move(volume));
    add_kinds("v1.2-volume-noise.dfield", std::move(volume_noise));
    add_kinds("v1.2-all-kinds.dfield", make_all_kinds_and_volume(1));
    return fields;
}

}  // namespace dfield::test
