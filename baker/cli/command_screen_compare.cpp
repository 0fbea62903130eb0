// `dfield screen compare`: every estimator at several numbers of samples, with and without interleaving.
#include <array>

#include "baker/cli/arguments.hpp"
#include "baker/cli/command_screen.hpp"
#include "baker/cli/screen_options.hpp"
#include "baker/error.hpp"
#include "baker/parallel.hpp"

namespace dfield::cli {
namespace {

constexpr std::array<std::uint32_t, 5> kSamples{4, 8, 16, 32, 64};

struct ScreenCompareCommand {
    ScreenInput input;
    ScreenOptions options;
    ReferenceOptions reference;
    int repetitions = 3;
    CommonOptions common;
};

void run(const ScreenCompareCommand& command) {
    const std::string& target = command.common.json;
    const ScreenSubject subject = load_screen_subject(command.input, command.common);
    const ScreenRunner runner(subject, command.common.threads, command.reference);
    const dfield_screen_desc base = screen_desc(command.options, subject.default_radius());
    const RayReference world = runner.by_rays(base, false, false);

    say(target, text("%s: %u x %u pixels, R %.4g, %s; errors in grey levels", command.input.file.c_str(),
                     runner.buffer().width, runner.buffer().height, static_cast<double>(base.radius),
                     name_of(static_cast<dfield_fuzzy_measure>(base.measure))));
    say(target, text("%-11s %7s %11s %10s %10s %9s %11s", "estimator", "samples", "interleaved", "to screen",
                     "to world", "ms", "M pixels/s"));
    Json rows = Json::array();
    for (const dfield_screen_estimator estimator : kScreenEstimators) {
        dfield_screen_desc desc = base;
        desc.estimator = estimator;
        const std::vector<float> integral = runner.integral(desc);
        for (const std::uint32_t samples : kSamples)
            for (const bool interleaved : {false, true}) {
                desc.samples = samples;
                desc.interleave = interleaved ? 4 : 1;
                desc.filter = interleaved;
                const ScreenShading shading = runner.shade(desc, false, command.repetitions);
                const std::vector<float> at = runner.at_pixels(shading.visibility);
                const double to_screen = rms_grey(at, integral);
                Json row{{"estimator", name_of(estimator)},
                         {"samples", samples},
                         {"interleave", desc.interleave},
                         {"filter", interleaved},
                         {"rms_grey_screen", significant(to_screen)},
                         {"rms_grey_world", nullptr},
                         {"ms", significant(shading.ms)},
                         {"mpixels_per_s", significant(mpixels_per_s(runner.buffer(), shading.ms))}};
                std::string to_world = "-";
                if (subject.lit) {
                    const double error = rms_grey(at, world.visibility);
                    row["rms_grey_world"] = significant(error);
                    to_world = text("%.2f", error);
                }
                if (estimator == DFIELD_ESTIMATOR_MARCH) row["march_steps"] = desc.march_steps;
                say(target, text("%-11s %7u %11s %10.2f %10s %9.2f %11.1f", name_of(estimator), samples,
                                 interleaved ? "4 x 4" : "no", to_screen, to_world.c_str(), shading.ms,
                                 mpixels_per_s(runner.buffer(), shading.ms)));
                rows.push_back(std::move(row));
            }
    }
    Json json = screen_json(command.input, subject, base);
    for (const char* varied : {"estimator", "samples", "interleave", "filter"}) json.erase(varied);
    json["threads"] = thread_count_of(command.common);
    json["reference_pixels"] = runner.pixels().size();
    json["estimators"] = std::move(rows);
    write_json_report(target, json);
}

}  // namespace

int thread_count_of(const CommonOptions& common) {
    return thread_count(common.threads);
}

void add_reference_options(CLI::App& command, ReferenceOptions& options) {
    command
        .add_option("--reference-pixels", options.pixels,
                    "Pixels at which errors are measured, evenly chosen")
        ->capture_default_str()
        ->check(CLI::Range(1, 1 << 28));
    command.add_option("--reference-rays", options.rays, "Rays through the scene at each of them")
        ->capture_default_str()
        ->check(CLI::Range(1, 65536));
}

Json screen_json(const ScreenInput& input, const ScreenSubject& subject, const dfield_screen_desc& desc) {
    const GBuffer& buffer = subject.buffer;
    Json json{{"input", input.file},
              {"width", buffer.width},
              {"height", buffer.height},
              {"camera", subject.camera},
              {"projection", buffer.camera.orthographic ? "orthographic" : "perspective"},
              {"surface_pixels", surface_pixels(buffer, buffer.pixels()).size()},
              {"estimator", name_of(static_cast<dfield_screen_estimator>(desc.estimator))},
              {"samples", desc.samples},
              {"interleave", desc.interleave},
              {"filter", desc.filter != 0},
              {"measure", name_of(static_cast<dfield_fuzzy_measure>(desc.measure))},
              {"radius", significant(static_cast<double>(desc.radius), 7)}};
    if (subject.trace_seconds > 0) json["trace_seconds"] = significant(subject.trace_seconds);
    return json;
}

CLI::App* add_screen_compare_command(CLI::App& screen) {
    auto command = std::make_shared<ScreenCompareCommand>();
    command->common.threads = 1;
    CLI::App* compare = screen.add_subcommand(
        "compare", "Every estimator at 4 to 64 samples, with and without interleaving: errors and speed");
    add_screen_input(*compare, command->input);
    add_screen_options(*compare, command->options, false);
    add_reference_options(*compare, command->reference);
    compare->add_option("--repetitions", command->repetitions, "Timed runs of each; the fastest counts")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    add_common_options(*compare, command->common, "1");
    compare->footer(
        "Errors and times are those of dfield screen. march takes --march-steps points for each sample.");
    compare->callback([command] { run(*command); });
    return compare;
}

}  // namespace dfield::cli
