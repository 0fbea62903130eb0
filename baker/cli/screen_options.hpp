// The flags of screen-space occlusion, and what they mean to the runtime and to the rays that it is judged
// by.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "baker/cli/app_fwd.hpp"
#include "baker/screen/fuzzy_measure.hpp"
#include "dfield/dfield.hpp"
#include "dfield/screen.h"

namespace dfield::cli {

// --radius --measure --sigma and the group "Estimator"
struct ScreenOptions {
    dfield_screen_desc desc;
    std::optional<float> radius;
    bool no_filter = false;
    std::array<float, 3> ambient{0.3f, 0.33f, 0.38f};
    ScreenOptions() { dfield_screen_desc_init(&desc); }
};
// Without `choice`, what compare tries in turn is left out: estimator, samples, interleaving, filter.
void add_screen_options(CLI::App& command, ScreenOptions& options, bool choice);
// The desc, with this radius where none was given. Call after parsing.
dfield_screen_desc screen_desc(const ScreenOptions& options, float default_radius);

// As --estimator and --measure spell them.
const char* name_of(dfield_screen_estimator estimator);
const char* name_of(dfield_fuzzy_measure measure);
inline constexpr dfield_screen_estimator kScreenEstimators[] = {
    DFIELD_ESTIMATOR_SPHERE,  DFIELD_ESTIMATOR_HEMISPHERE, DFIELD_ESTIMATOR_IMPORTANCE,
    DFIELD_ESTIMATOR_TANGENT, DFIELD_ESTIMATOR_DISK,       DFIELD_ESTIMATOR_MARCH};

// The desc's measure for rays in world space. R is above 0.
FuzzyMeasure measure_of(const dfield_screen_desc& desc);

}  // namespace dfield::cli
