// Displacement fields for what is far, screen space for what is near, each occluder counted once.
//
// A ray whose first surface lies at distance D is blocked whatever D is; with the fuzzy measure mu of the
// radius R, 1 = (1 - mu(D)) + mu(D). Screen space integrates the first part, which ends at R; fields are
// asked for the second, an occlusion that grows from 0 at no distance to 1 at R and stays there. So
//     visibility = 1 - (1 - O) - F,   O in screen space, F = 1/pi integral mu(D) [a surface at D] cos,
// counts every occluder with a whole weight, divided between the two by its distance.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "baker/cli/app_fwd.hpp"
#include "baker/cli/screen_runner.hpp"
#include "format/field.hpp"

namespace dfield::cli {

// --field --field-rays --field-others --cache --no-cache
struct FarOptions {
    std::string field;  // empty: none; auto: of each mesh where its nodes stand; a .dfield of the whole scene
    std::uint32_t rays = 256;
    FieldParameters parameters;  // auto: of the fields that are baked
    bool others = false;         // an object's own field is not asked from its surface
    std::filesystem::path cache;
    bool no_cache = false;
};
void add_far_options(CLI::App& command, FarOptions& options);

// At every pixel, 1 where there is no surface.
struct FarVisibility {
    std::vector<float> beyond;  // 1 - F
    std::vector<float> all;     // occluders at any distance, what fields alone say
    double ms = 0;              // of the lookup of `beyond`
};

// Looks the fields up from the pixels' surfaces. Throws Error.
FarVisibility far_visibility(const FarOptions& options, const ScreenSubject& subject,
                             const ScreenRunner& runner, const dfield_screen_desc& desc,
                             const CommonOptions& common);

// max(0, O - F) at every pixel.
std::vector<float> combined(const std::vector<float>& near, const std::vector<float>& beyond);

}  // namespace dfield::cli
