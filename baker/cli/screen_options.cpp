#include "baker/cli/screen_options.hpp"

#include <algorithm>

#include "baker/cli/arguments.hpp"
#include "baker/cli/options.hpp"

namespace dfield::cli {
namespace {

template<class Value>
std::vector<std::pair<std::string, std::uint32_t>> names_of(std::initializer_list<Value> values) {
    std::vector<std::pair<std::string, std::uint32_t>> names;
    for (const Value value : values) names.emplace_back(name_of(value), static_cast<std::uint32_t>(value));
    return names;
}

void add_estimator(CLI::App& command, ScreenOptions& options) {
    add_choice<std::uint32_t>(
        command, "--estimator", options.desc.estimator,
        names_of({DFIELD_ESTIMATOR_DISK, DFIELD_ESTIMATOR_SPHERE, DFIELD_ESTIMATOR_HEMISPHERE,
                  DFIELD_ESTIMATOR_IMPORTANCE, DFIELD_ESTIMATOR_TANGENT, DFIELD_ESTIMATOR_MARCH}),
        "Where samples are put: sphere, hemisphere (both of infinite variance where --measure starts "
        "linearly), "
        "importance, tangent (another integral, close by), disk, or march (rays of --march-steps points)")
        ->group("Estimator");
    command.add_option("--samples", options.desc.samples, "Samples a pixel")
        ->capture_default_str()
        ->check(CLI::Range(1u, DFIELD_MAX_SCREEN_SAMPLES))
        ->group("Estimator");
    command
        .add_option("--interleave", options.desc.interleave,
                    "Pixels of N x N squares use sets of samples of their own; 1: all use the same")
        ->capture_default_str()
        ->check(CLI::Range(1, 8))
        ->group("Estimator");
    command.add_flag("--no-filter", options.no_filter, "Do not average over the squares")->group("Estimator");
}

}  // namespace

const char* name_of(dfield_screen_estimator estimator) {
    switch (estimator) {
        case DFIELD_ESTIMATOR_SPHERE:
            return "sphere";
        case DFIELD_ESTIMATOR_HEMISPHERE:
            return "hemisphere";
        case DFIELD_ESTIMATOR_IMPORTANCE:
            return "importance";
        case DFIELD_ESTIMATOR_TANGENT:
            return "tangent";
        case DFIELD_ESTIMATOR_DISK:
            return "disk";
        case DFIELD_ESTIMATOR_MARCH:
            return "march";
    }
    return "unknown";
}

const char* name_of(dfield_fuzzy_measure measure) {
    switch (measure) {
        case DFIELD_MEASURE_QUARTIC:
            return "quartic";
        case DFIELD_MEASURE_QUADRATIC:
            return "quadratic";
        case DFIELD_MEASURE_LINEAR:
            return "linear";
        case DFIELD_MEASURE_EXPONENTIAL:
            return "exponential";
    }
    return "unknown";
}

void add_screen_options(CLI::App& command, ScreenOptions& options, bool choice) {
    command
        .add_option(
            "--radius", options.radius,
            "R: surfaces further than this do not occlude, world units; default: a tenth of the scene's "
            "longest side")
        ->check(number_from_zero());
    add_choice<std::uint32_t>(
        command, "--measure", options.desc.measure,
        names_of({DFIELD_MEASURE_QUARTIC, DFIELD_MEASURE_QUADRATIC, DFIELD_MEASURE_LINEAR,
                  DFIELD_MEASURE_EXPONENTIAL}),
        "The fuzzy measure mu(r): (r/R)^4, (r/R)^2, r/R, or extinction by --sigma, cut off at R");
    command.add_option("--sigma", options.desc.sigma, "--measure exponential: extinction a world unit")
        ->capture_default_str()
        ->check(number_above_zero());
    if (choice) add_estimator(command, options);
    command.add_option("--march-steps", options.desc.march_steps, "march: points a ray")
        ->capture_default_str()
        ->check(CLI::Range(1u, DFIELD_MAX_SCREEN_SAMPLES))
        ->group("Estimator");
    command
        .add_option("--filter-limit", options.desc.filter_limit,
                    "Pixels further than this share of R off the tangent plane are not averaged")
        ->capture_default_str()
        ->check(number_above_zero())
        ->group("Estimator");
    add_choice<std::uint32_t>(
        command, "--weights", options.desc.weights,
        {{"ratio", DFIELD_WEIGHTS_RATIO}, {"plain", DFIELD_WEIGHTS_PLAIN}},
        "ratio: divided by the same samples' sum where all is open; plain: the paper's sums")
        ->group("Estimator");
    command
        .add_flag("--tangent-as-printed", options.desc.tangent_as_printed,
                  "tangent, plain: not normalised, 0.4 on an open plane with quartic")
        ->group("Estimator");
    add_choice<std::uint32_t>(
        command, "--sight", options.desc.sight, {{"view", DFIELD_SIGHT_VIEW}, {"axis", DFIELD_SIGHT_AXIS}},
        "Rays of sight around a point are parallel to the one through it, or, as in the "
        "paper, to the camera's axis")
        ->group("Estimator");
    command.add_option("--seed", options.desc.seed, "Another choice of samples")
        ->capture_default_str()
        ->group("Estimator");
    command.add_option("--ambient", options.ambient, "Light from all around; default 0.3 0.33 0.38")
        ->type_name("R G B")
        ->delimiter(',')
        ->check(number_between(0, 1e6))
        ->group("Light");
}

dfield_screen_desc screen_desc(const ScreenOptions& options, float default_radius) {
    dfield_screen_desc desc = options.desc;
    desc.radius = options.radius.value_or(default_radius);
    desc.filter = !options.no_filter;
    std::copy(options.ambient.begin(), options.ambient.end(), desc.ambient);
    return desc;
}

FuzzyMeasure measure_of(const dfield_screen_desc& desc) {
    FuzzyMeasure measure;
    measure.radius = static_cast<double>(desc.radius);
    measure.sigma = static_cast<double>(desc.sigma);
    switch (static_cast<dfield_fuzzy_measure>(desc.measure)) {
        case DFIELD_MEASURE_QUARTIC:
            measure.shape = MeasureShape::kQuartic;
            break;
        case DFIELD_MEASURE_QUADRATIC:
            measure.shape = MeasureShape::kQuadratic;
            break;
        case DFIELD_MEASURE_LINEAR:
            measure.shape = MeasureShape::kLinear;
            break;
        case DFIELD_MEASURE_EXPONENTIAL:
            measure.shape = MeasureShape::kExponential;
            break;
    }
    return measure;
}

}  // namespace dfield::cli
