#include "baker/cli/volume_sweep.hpp"

#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numeric>

#include "baker/cli/arguments.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/report.hpp"
#include "baker/error.hpp"

namespace dfield::cli {
namespace {

constexpr const char* kGroup = "Sweep";

// "0,3,7"
template<class Number>
std::vector<Number> parse_list(const std::string& flag, const std::string& list) {
    std::vector<Number> values;
    const char* at = list.data();
    const char* const end = at + list.size();
    for (;;) {
        Number value{};
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc() || (next != end && *next != ','))
            throw Error(ExitCode::kUsage, flag + ": '" + list + "' is no list of numbers such as 0,1,3");
        values.push_back(value);
        if (next == end) return values;
        at = next + 1;
    }
}

// The name, where the volume has a surface of this isovalue.
std::string checked(std::string name, const Volume& volume, float isovalue) {
    const ValueRange range = value_range(volume);
    if (!(isovalue > static_cast<float>(range.min) && isovalue <= static_cast<float>(range.max)))
        throw Error(ExitCode::kUsage,
                    text("--iso %g: %s has no surface there: its values go from %g to %g, and what is "
                         "inside has the isovalue or more",
                         isovalue, name.c_str(), range.min, range.max));
    return name;
}

}  // namespace

void add_isovalue_option(CLI::App& command, float& isovalue) {
    command.add_option("--iso", isovalue, "Isovalue: matter is where values are this or more")
        ->required()
        ->check(finite_number());
}

void add_sweep_options(CLI::App& command, SweepOptions& options) {
    std::vector<std::string> names;
    for (const SweepForm& form : kSweepForms) names.emplace_back(form.name);
    command
        .add_option("--form", options.form,
                    "improved (24 ordinates), improved-48 (closer to the truth, slower), paper (equations 3 "
                    "to 7 as published), combined (the paper's without the geometry term)")
        ->capture_default_str()
        ->transform(CLI::IsMember(names, CLI::ignore_case))
        ->group(kGroup);
    command
        .add_option(
            "--octants", options.octants,
            "Octants of the sky that shine: all, a list such as 4,5,6,7, or combined (--form combined)")
        ->default_str("all")
        ->group(kGroup);
    command
        .add_option("--intensity", options.intensity,
                    "One for all octants that shine, or a list with one for each, in their order")
        ->default_str("1")
        ->group(kGroup);
    command
        .add_option("--gamma", options.gamma, "Visibility is raised to 1/gamma; the paper's pictures have 2")
        ->capture_default_str()
        ->check(number_above_zero())
        ->group(kGroup);
    command
        .add_option("--alpha", options.alpha,
                    "Opacity of the matter; below 1 light shines through it and arrives from behind too "
                    "(equation 8)")
        ->capture_default_str()
        ->check(number_between(0, 1))
        ->group(kGroup);
}

void set_form(dfield_sweep_desc& desc, const SweepForm& form) {
    desc.form = form.form;
    desc.ordinates = form.ordinates;
}

dfield_sweep_desc sweep_desc(SweepOptions& options, float isovalue) {
    dfield_sweep_desc desc = sweep_defaults();
    desc.isovalue = isovalue;
    desc.gamma = options.gamma;
    desc.alpha = options.alpha;
    desc.through = options.alpha < 1;
    if (options.octants == "combined") {
        if (options.form != SweepOptions{}.form && options.form != "combined")
            throw Error(ExitCode::kUsage, "--octants combined is --form combined, not " + options.form);
        options.form = "combined";
    }
    for (const SweepForm& form : kSweepForms)
        if (options.form == form.name) set_form(desc, form);

    std::vector<int> octants(DFIELD_OCTANT_COUNT);
    std::iota(octants.begin(), octants.end(), 0);
    if (!options.octants.empty() && options.octants != "all" && options.octants != "combined") {
        octants = parse_list<int>("--octants", options.octants);
        desc.octants = 0;
        for (const int octant : octants) {
            if (octant < 0 || octant >= DFIELD_OCTANT_COUNT || (desc.octants >> octant & 1))
                throw Error(ExitCode::kUsage,
                            "--octants: '" + options.octants + "': octants are 0 to 7, each named once");
            desc.octants |= 1u << octant;
        }
    }
    if (options.intensity.empty()) return desc;
    std::vector<float> intensities = parse_list<float>("--intensity", options.intensity);
    if (intensities.size() == 1) intensities.resize(octants.size(), intensities[0]);
    if (intensities.size() != octants.size())
        throw Error(ExitCode::kUsage, text("--intensity: '%s' are %zu, but %zu octants shine",
                                           options.intensity.c_str(), intensities.size(), octants.size()));
    for (std::size_t i = 0; i < octants.size(); ++i) {
        if (!std::isfinite(intensities[i]) || !(intensities[i] >= 0))
            throw Error(ExitCode::kUsage,
                        "--intensity: '" + options.intensity + "': intensities are 0 or above");
        desc.intensities[octants[i]] = intensities[i];
    }
    return desc;
}

glm::vec3 to_sweep_frame(const VolumeGrid& grid, const glm::vec3& direction) {
    return glm::vec3(grid.spacing() * (glm::inverse(grid.directions) * glm::dvec3(direction)));
}

VolumeSweeper::VolumeSweeper(std::string name, const Volume& volume, float isovalue, int threads,
                             dfield_context_desc hooks)
    : volume_(checked(std::move(name), volume, isovalue), volume, threads, hooks) {
    warn_of_oblique_axes(volume_.name(), volume.grid);
}

double VolumeSweeper::sweep(const dfield_sweep_desc& desc, const dfield_sweep_outputs& outputs) const {
    return volume_.timed([&] { sweep_volume(volume_.context(), volume_.samples(), desc, outputs); });
}

}  // namespace dfield::cli
