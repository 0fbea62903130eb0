// `dfield volume lao` and `dfield volume cao`.
#include <algorithm>
#include <cstring>
#include <limits>

#include "baker/cli/arguments.hpp"
#include "baker/cli/command_volume.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/volume_input.hpp"
#include "baker/cli/volume_local.hpp"
#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/volume/write_nrrd.hpp"

namespace dfield::cli {
namespace {

struct LocalCommand {
    VolumeInput input;
    std::string output, transfer_file;
    bool gzip = false, verify = false, dilated = false;
    int repetitions = 1;
    LocalOptions local;
    ClipOptions clip;
    CommonOptions common;
};

void check_output_volume(const std::string& output) {
    if (output.empty()) return;
    if (extension_of(output) != ".nrrd")
        throw Error(ExitCode::kUsage, output + ": volumes are written as NRRD: the name must end in .nrrd");
    check_output(output);
}

void write_visibility(const LocalCommand& command, const VolumeGrid& grid, const float* visibility) {
    if (command.output.empty()) return;
    const std::span<const std::byte> bytes = std::as_bytes(std::span(visibility, grid.voxels()));
    write_nrrd(command.output, grid, VoxelType::kF32, std::span(&bytes, 1),
               {.gzip = command.gzip, .content = "ambient occlusion factor, 1 = open"});
}

Json local_json(const LocalCommand& command, const Volume& volume, const RuntimeVolume& runtime) {
    Json json = volume_json(command.input, volume);
    json["tf"] = command.transfer_file;
    json["rays"] = command.local.rays;
    json["samples"] = command.local.samples;
    json["approximate"] = command.local.approximate;
    json["threads"] = runtime.threads();
    return json;
}

// The fastest of --repetitions.
double time_lao(const LocalCommand& command, const RuntimeVolume& runtime, const LocalSettings& settings,
                std::vector<float>& visibility) {
    double seconds = std::numeric_limits<double>::infinity();
    for (int i = 0; i < command.repetitions; ++i)
        seconds = std::min(seconds, runtime.timed([&] {
            local_ao_volume(runtime.context(), runtime.samples(), settings.opacity(), settings.local(),
                            visibility.data());
        }));
    return seconds;
}

void run_lao(const LocalCommand& command) {
    check_output_volume(command.output);
    const TransferFunction transfer = read_transfer_function(command.transfer_file);
    const LocalSettings settings(command.local, transfer);
    const Volume volume = read_volume_input(command.input);
    const RuntimeVolume runtime(command.input.file, volume, command.common.threads);
    std::vector<float> visibility(runtime.voxels());
    const double seconds = time_lao(command, runtime, settings, visibility);
    write_visibility(command, volume.grid, visibility.data());
    const double rate = settings.samples(runtime.voxels()) / seconds / 1e9;
    say(command.common.json,
        text("%s: %s voxels, %u rays of %u samples, %.3g s, %.3g G samples/s on %d thread%s",
             command.output.c_str(), size_text(volume.grid.size).c_str(), command.local.rays,
             command.local.samples, seconds, rate, runtime.threads(), runtime.threads() == 1 ? "" : "s"));
    Json json = local_json(command, volume, runtime);
    json["recomputed_fraction"] = 1;
    json["seconds"] = significant(seconds);
    json["gsamples_per_s"] = significant(rate);
    json["speedup_over_lao"] = 1;
    json["identical"] = nullptr;  // there is nothing to compare it with
    json["output"] = command.output;
    write_json_report(command.common.json, json);
}

std::size_t count_different(const float* a, const std::vector<float>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < b.size(); ++i) count += std::memcmp(a + i, &b[i], sizeof(float)) != 0;
    return count;
}

void run_cao(const LocalCommand& command) {
    check_output_volume(command.output);
    const TransferFunction transfer = read_transfer_function(command.transfer_file);
    const LocalSettings settings(command.local, transfer);
    const Volume volume = read_volume_input(command.input);
    const RuntimeVolume runtime(command.input.file, volume, command.common.threads);
    warn_of_oblique_axes(runtime.name(), volume.grid);
    const ClipScene scene(command.clip, runtime.context(), volume.grid);
    if (scene.meshes() == 0) throw Error(ExitCode::kUsage, "give a mesh to clip with: --clip or --probe");

    dfield_contextual_desc desc = contextual_defaults();
    desc.samples = runtime.samples();
    desc.opacity = settings.opacity();
    desc.local = settings.local();
    desc.clip_samples = command.clip.samples;
    desc.mask = command.dilated ? DFIELD_UPDATE_DILATED : DFIELD_UPDATE_CHANGED;
    std::optional<Contextual> session;
    runtime.timed([&] {
        session.emplace(runtime.context(), desc);
        session->update();  // unclipped, once
    });
    std::vector<float> whole(runtime.voxels());
    const double seconds_lao = time_lao(command, runtime, settings, whole);

    const auto voxels = static_cast<double>(runtime.voxels());
    std::vector<std::optional<std::uint32_t>> ids;
    Json frames = Json::array();
    double seconds = 0, recomputed = 0;
    bool identical = true;
    for (std::size_t frame = 0; frame < scene.frames(); ++frame) {
        dfield_update_result result{};
        runtime.timed([&] {
            show_frame(scene, frame, *session, ids);
            result = session->update();
        });
        Json json;
        json["seconds"] = significant(result.seconds);
        json["seconds_clipping"] = significant(result.clip_seconds);
        json["recomputed_fraction"] = significant(static_cast<double>(result.recomputed) / voxels);
        json["changed_fraction"] = significant(static_cast<double>(result.changed) / voxels);
        if (command.dilated)
            json["masked_fraction"] = significant(static_cast<double>(result.masked) / voxels);
        json["changed_box"] = {{result.low[0], result.low[1], result.low[2]},
                               {result.high[0], result.high[1], result.high[2]}};
        seconds += result.seconds;
        recomputed += static_cast<double>(result.recomputed) / voxels;
        if (command.verify) {
            const std::vector<dfield_clip> clips = scene.clips(frame);
            runtime.timed([&] {
                local_ao_volume_clipped(runtime.context(), runtime.samples(), settings.opacity(),
                                        settings.local(), clips.data(), clips.size(), command.clip.samples,
                                        whole.data());
            });
            const std::size_t different = count_different(session->visibility(), whole);
            json["different_voxels"] = different;
            identical = identical && different == 0;
        }
        frames.push_back(std::move(json));
    }
    write_visibility(command, volume.grid, session->visibility());

    const auto count = static_cast<double>(scene.frames());
    seconds /= count;
    recomputed /= count;
    say(command.common.json,
        text("%s: %s voxels, %zu frame%s, %.3g s each (LAO %.3g s, %.3g times), %.2f%% of the voxels "
             "computed anew%s",
             command.input.file.c_str(), size_text(volume.grid.size).c_str(), scene.frames(),
             scene.frames() == 1 ? "" : "s", seconds, seconds_lao, seconds_lao / seconds, 100 * recomputed,
             !command.verify ? ""
             : identical     ? ", identical to LAO of the clipped volume"
                             : ", NOT identical to LAO of the clipped volume"));
    Json json = local_json(command, volume, runtime);
    json["clip_samples"] = command.clip.samples;
    json["mask"] = command.dilated ? "dilated" : "changed";
    Json methods = Json::array();
    for (std::size_t i = 0; i < scene.meshes(); ++i)
        methods.push_back(scene.mesh(i).method() == DFIELD_CLIP_EXACT ? "exact" : "maps");
    json["clip_methods"] = methods;
    json["recomputed_fraction"] = significant(recomputed);
    json["seconds"] = significant(seconds);
    json["seconds_lao"] = significant(seconds_lao);
    json["gsamples_per_s"] = significant(recomputed * settings.samples(runtime.voxels()) / seconds / 1e9);
    json["speedup_over_lao"] = significant(seconds_lao / seconds);
    json["identical"] = command.verify ? Json(identical) : Json(nullptr);
    json["frames"] = frames;
    json["output"] = command.output;
    write_json_report(command.common.json, json);
    if (!identical) throw Error(ExitCode::kInternal, "contextual and local ambient occlusion differ");
}

void add_shared(CLI::App& app, LocalCommand& command) {
    add_volume_input(app, command.input);
    app.add_option(
           "--tf", command.transfer_file,
           "Transfer function: JSON {\"points\": [[value, opacity], ...]}, or lines of text: value opacity")
        ->required();
    app.add_flag("--gzip", command.gzip, "Compress what is written; ParaView reads raw voxels only");
    add_repetitions_option(app, command.repetitions, "Runs of LAO for its time; the fastest counts");
    add_local_options(app, command.local);
    app.add_option("--samples", command.local.samples, "The same as --ray-samples")
        ->check(CLI::Range(1u, DFIELD_MAX_LOCAL_SAMPLES))
        ->excludes(app.get_option("--ray-samples"))
        ->group("Local ambient occlusion");
    add_common_options(app, command.common, "all cores");
}

}  // namespace

void add_volume_lao_command(CLI::App& volume) {
    auto command = std::make_shared<LocalCommand>();
    CLI::App* lao = volume.add_subcommand("lao", "Local ambient occlusion of a volume, at every voxel");
    lao->add_option("-o,--output", command->output, "The factors, 1 = open: a float NRRD on FILE's grid")
        ->required();
    add_shared(*lao, *command);
    lao->add_flag("--approximate", command->local.approximate,
                  "Long rays faster and not exact: far samples are taken in pairs and fours, and air is "
                  "interpolated; 4e-4 to 1.3e-3 off (RMS)")
        ->group("Local ambient occlusion");
    lao->footer(
        "gsamples_per_s counts all samples whose opacity matters, taken or skipped: a ray's last does not.");
    lao->callback([command] { run_lao(*command); });
}

void add_volume_cao_command(CLI::App& volume) {
    auto command = std::make_shared<LocalCommand>();
    CLI::App* cao =
        volume.add_subcommand("cao", "Contextual ambient occlusion: the same while meshes clip the volume");
    cao->add_option("-o,--output", command->output, "The last frame's factors: a float NRRD on FILE's grid");
    cao->add_flag("--verify", command->verify,
                  "Compare each frame with LAO of the clipped volume, from scratch");
    cao->add_flag("--dilation-maps", command->dilated,
                  "Compute anew what is within the paper's dilation maps, not only what changes");
    add_shared(*cao, *command);
    add_clip_options(*cao, command->clip);
    cao->callback([command] { run_cao(*command); });
}

}  // namespace dfield::cli
