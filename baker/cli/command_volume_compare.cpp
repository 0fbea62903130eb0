#include <chrono>
#include <cmath>

#include "baker/cli/arguments.hpp"
#include "baker/cli/command_volume.hpp"
#include "baker/cli/form_runner.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/surface_points.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/cli/volume_input.hpp"
#include "baker/cli/volume_sweep.hpp"
#include "baker/error.hpp"

namespace dfield::cli {
namespace {

struct CompareVolumeCommand {
    VolumeInput input;
    float isovalue = 0;
    std::uint32_t rays = 512;
    std::size_t points = 5000;
    int repetitions = 3;
    CommonOptions common;
};

// Visibility by rays, some points at a time for the progress and for Ctrl-C; the same as in one call.
std::vector<float> cast(const CompareVolumeCommand& command, const VolumeField& field,
                        const std::vector<float>& positions) {
    constexpr std::size_t kPiece = 256;
    ProgressBar progress("casting rays", "ray", command.common.quiet);
    const dfield_volume_points all = points_at(positions);
    std::vector<float> visibility(all.count);
    for (std::size_t first = 0; first < all.count; first += kPiece) {
        if (interrupted) throw Error(ExitCode::kInterrupted, "interrupted");
        dfield_volume_points piece = all;
        piece.positions = all.positions + 3 * first;
        piece.count = std::min(kPiece, all.count - first);
        field.visibility_by_rays(piece, command.rays, first, visibility.data() + first);
        progress.update((first + piece.count) * command.rays, all.count * command.rays);
    }
    return visibility;
}

void run(const CompareVolumeCommand& command) {
    const Volume volume = read_volume_input(command.input);
    const VolumeSweeper sweeper(command.input.file, volume, command.isovalue, command.common.threads);
    FormRunner runner(sweeper, command.repetitions);
    const std::string& target = command.common.json;

    std::vector<float> positions, truth;
    std::size_t crossings = 0;
    double seconds_rays = 0;
    Json forms = Json::array();
    for (const SweepForm& form : kSweepForms) {
        dfield_sweep_desc desc = sweep_defaults();
        desc.isovalue = command.isovalue;
        set_form(desc, form);
        const double seconds = runner.sweep(desc);
        if (positions.empty()) {  // the distances are the same in all forms
            positions = surface_points(sweeper.grid(), runner.distance(), command.points, &crossings);
            if (positions.empty())
                throw InputError(command.input.file +
                                 text(": no surface at %g but in the %zu voxels along the border, where "
                                      "nothing is compared",
                                      command.isovalue, kSurfaceMargin));
            const auto start = std::chrono::steady_clock::now();
            truth = cast(command, sweeper.field(runner.distance().data()), positions);
            seconds_rays = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            say(target, text("%zu points of %zu, %u rays each in %.3g s", positions.size() / 3, crossings,
                             command.rays, seconds_rays));
            say(target, text("%-12s %8s %12s %8s %9s", "form", "RMS", "correlation", "bias", "seconds"));
        }
        const VisibilityError error = visibility_error(runner.at(desc, points_at(positions)), truth);
        const bool varies = std::isfinite(error.correlation);
        say(target, text("%-12s %8.4f %12s %+8.4f %9.3g", form.name, error.rms,
                         varies ? text("%.4f", error.correlation).c_str() : "-", error.bias, seconds));
        forms.push_back({{"form", form.name},
                         {"rms", significant(error.rms)},
                         {"correlation", varies ? Json(significant(error.correlation)) : Json()},
                         {"bias", significant(error.bias)},
                         {"seconds", significant(seconds)}});
    }
    Json json = volume_json(command.input, volume);
    json["iso"] = significant(command.isovalue, 7);
    json["rays"] = command.rays;
    json["crossings"] = crossings;
    json["points"] = positions.size() / 3;
    json["seconds_rays"] = significant(seconds_rays);
    json["threads"] = sweeper.threads();
    json["forms"] = forms;
    write_json_report(target, json);
}

}  // namespace

void add_volume_compare_command(CLI::App& volume) {
    auto command = std::make_shared<CompareVolumeCommand>();
    command->common.threads = 1;
    CLI::App* compare =
        volume.add_subcommand("compare", "Each form of sweeping against rays: error and speed");
    add_volume_input(*compare, command->input);
    add_isovalue_option(*compare, command->isovalue);
    compare->add_option("--rays", command->rays, "Cosine-weighted rays a point")
        ->capture_default_str()
        ->check(CLI::Range(1, 65536));
    compare
        ->add_option("--points", command->points,
                     "Points of the surface, evenly chosen among where it crosses the grid's edges")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000000000));
    add_repetitions_option(*compare, command->repetitions, "Timed runs of each form; the fastest counts");
    add_common_options(*compare, command->common, "1");
    compare->footer(
        "Errors are of visibility, 0 to 1, found minus truth. The truth is Monte Carlo: rays marched in the "
        "distance\n"
        "field, around its gradient. Seconds are of a whole sweep, distances included. The forms are those "
        "of\n"
        "dfield volume sweep.");
    compare->callback([command] { run(*command); });
}

}  // namespace dfield::cli
