#include <chrono>

#include "baker/cli/arguments.hpp"
#include "baker/cli/command_volume.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/volume_clip_pictures.hpp"
#include "baker/cli/volume_input.hpp"
#include "baker/cli/volume_sweep.hpp"
#include "baker/error.hpp"
#include "baker/volume/render_volume.hpp"

namespace dfield::cli {
namespace {

struct RenderCommand {
    VolumeInput input;
    std::string output, transfer_file, visibility_file;
    bool surface = false, unshaded = false;
    std::optional<float> isovalue, gain;
    std::string shading;  // empty: the default
    SweepOptions sweep;
    std::array<float, 3> view{0.6f, -1, 0.45f}, up{0, 0, 1}, light{}, background{1, 1, 1};
    float fov = 35, visibility_offset = 0;
    double step = 0, reference_length = 0;
    RenderOptions picture{.samples = 2};
    ClipPictureOptions clipping;
    CommonOptions common;
};

glm::vec3 vector_of(const std::array<float, 3>& v) {
    return {v[0], v[1], v[2]};
}

// A volume of visibility on the grid of the other: floats as they are, unsigned integers from 0 to their
// type's largest.
std::vector<float> read_visibility(const std::string& file, const Volume& volume) {
    const Volume visibility = read_volume(file);
    if (visibility.grid.size != volume.grid.size)
        throw InputError(file + ": has " + size_text(visibility.grid.size) + " voxels, the volume " +
                         size_text(volume.grid.size) + "; visibility belongs to a volume of its own size");
    float scale = 1;
    switch (visibility.type) {
        case VoxelType::kU8:
            scale = 1.0f / 255;
            break;
        case VoxelType::kU16:
            scale = 1.0f / 65535;
            break;
        case VoxelType::kF32:
        case VoxelType::kF64:
            break;
        default:
            throw InputError(file + ": visibility is u8, u16, f32 or f64, not " + name_of(visibility.type));
    }
    std::vector<float> values = float_values(visibility);
    for (float& value : values) value *= scale;
    return values;
}

// What is drawn: the volume's values or an isosurface's distances, and visibility where it darkens them.
struct Shown {
    std::vector<float> values, visibility;
};

Shown swept(RenderCommand& command, const Volume& volume) {
    const dfield_sweep_desc desc = sweep_desc(command.sweep, *command.isovalue);
    const VolumeSweeper sweeper(command.input.file, volume, *command.isovalue, command.common.threads);
    Shown shown{std::vector<float>(volume.grid.voxels()), {}};
    dfield_sweep_outputs outputs = no_sweep_outputs();
    outputs.distance = shown.values.data();
    if (command.shading != "local") {
        shown.visibility.resize(volume.grid.voxels());
        outputs.visibility = shown.visibility.data();
    }
    sweeper.sweep(desc, outputs);
    // Intensities above 1 may lead above 1.
    for (float& value : shown.visibility) value = std::min(value, 1.0f);
    return shown;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void run(RenderCommand& command) {
    check_picture(command.output);
    const std::optional<float>& isovalue = command.isovalue;
    if (int{command.surface} + int{!command.transfer_file.empty()} + int{isovalue.has_value()} != 1)
        throw Error(ExitCode::kUsage, "give one of --iso VALUE, --tf FILE or --surface");
    if (vector_of(command.view) == glm::vec3(0) || vector_of(command.up) == glm::vec3(0))
        throw Error(ExitCode::kUsage, "--view and --up: 0 0 0 is no direction");
    if (command.clipping.used() && (command.transfer_file.empty() || !command.visibility_file.empty()))
        throw Error(ExitCode::kUsage, "--clip and --probe go with --tf, and compute --visibility themselves");
    if (command.gain && command.transfer_file.empty()) throw Error(ExitCode::kUsage, "--gain goes with --tf");
    if (!command.shading.empty() && !isovalue && !command.clipping.used())
        throw Error(ExitCode::kUsage, "--shading goes with --iso, --clip and --probe; otherwise --unshaded");
    if (command.shading == "local" && command.clipping.used()) command.clipping.ao = "none";
    // Where matter is cut its gradients are noise.
    if (command.shading.empty()) command.shading = command.clipping.used() ? "ao" : "both";
    std::optional<TransferFunction> transfer;
    if (!command.transfer_file.empty()) transfer = read_transfer_function(command.transfer_file);
    const Volume volume = read_volume_input(command.input);
    const auto sweeping = std::chrono::steady_clock::now();
    Shown shown = isovalue ? swept(command, volume) : Shown{float_values(volume), {}};
    const double seconds_sweep = seconds_since(sweeping);
    if (!command.visibility_file.empty()) shown.visibility = read_visibility(command.visibility_file, volume);

    command.picture.threads = command.common.threads;
    command.picture.background = vector_of(command.background);
    const Camera camera =
        frame_volume(volume.grid, vector_of(command.view), vector_of(command.up), command.fov,
                     static_cast<float>(command.picture.width) / static_cast<float>(command.picture.height));
    const ScalarField field{volume.grid, shown.values};
    const bool local = !command.unshaded && command.shading != "ao";
    const auto drawing = std::chrono::steady_clock::now();
    std::vector<std::string> images{command.output};
    Image image;
    VolumeStyle style{.reference_length = command.reference_length,
                      .step = command.step,
                      .local = local,
                      .light = vector_of(command.light),
                      .visibility = shown.visibility,
                      .visibility_gain = command.gain.value_or(command.clipping.used() ? 2.0f : 1.0f)};
    if (command.clipping.used())
        images =
            draw_clipped(command.clipping, command.input.file, volume, *transfer, command.common.threads,
                         command.output, [&](const auto& clipped, auto visibility, const std::string& file) {
                             style.clipped = clipped;
                             style.visibility = visibility;
                             image = render_volume(field, *transfer, camera, style, command.picture);
                             write_png(file, image);
                         });
    else if (transfer)
        image = render_volume(field, *transfer, camera, style, command.picture);
    else
        image = render_isosurface(field, camera,
                                  {.local = local,
                                   .light = vector_of(command.light),
                                   .visibility = shown.visibility,
                                   .visibility_offset = command.visibility_offset},
                                  command.picture);
    const double seconds = seconds_since(drawing);
    if (!command.clipping.used()) write_png(command.output, image);
    say(command.common.json,
        text("%s: %u x %u pixels, %.2f s", command.output.c_str(), image.width, image.height, seconds) +
            (isovalue ? text(" and %.2f s to sweep", seconds_sweep) : ""));
    Json json = volume_json(command.input, volume);
    json["image"] = images.front();
    if (command.clipping.used()) json["images"] = images;
    json["width"] = image.width;
    json["height"] = image.height;
    json["seconds"] = significant(seconds);
    if (isovalue) {
        json["iso"] = significant(*isovalue, 7);
        json["shading"] = command.shading;
        json["seconds_sweep"] = significant(seconds_sweep);
    }
    write_json_report(command.common.json, json);
}

CLI::Option* add_vector(CLI::App& app, const std::string& name, std::array<float, 3>& value,
                        const std::string& description) {
    return app.add_option(name, value, description)
        ->type_name("X Y Z")
        ->delimiter(',')
        ->check(finite_number())
        ->group("Picture");
}

}  // namespace

void add_volume_render_command(CLI::App& volume) {
    auto command = std::make_shared<RenderCommand>();
    CLI::App* render =
        volume.add_subcommand("render", "A picture of a volume, of its isosurface, or of a distance field's");
    add_volume_input(*render, command->input);
    render->add_option("-o,--output", command->output, "The picture, a PNG")->required();
    CLI::Option* iso =
        render->add_option("--iso", command->isovalue, "Draw the surface of this isovalue, swept beforehand")
            ->check(finite_number());
    CLI::Option* shading =
        render
            ->add_option(
                "--shading", command->shading,
                "--iso, --clip, --probe: local (Lambert), ao (ambient occlusion) or both, multiplied. "
                "Default: both with --iso; ao with clips, since gradients are noise where matter is cut")
            ->transform(CLI::IsMember({"local", "ao", "both"}, CLI::ignore_case));
    add_sweep_options(*render, command->sweep);
    for (const char* flag : {"--form", "--octants", "--intensity", "--gamma", "--alpha"})
        render->get_option(flag)->needs(iso);
    render->add_option(
        "--tf", command->transfer_file,
        "Transfer function: JSON {\"points\": [[value, opacity], ...], \"colors\": [[value, red, "
        "green, blue], ...]}, piecewise linear; opacities are of layers --reference-length thick");
    render->add_flag("--surface", command->surface,
                     "FILE is a signed distance field (positive outside, world units): draw where it is 0");
    render
        ->add_option("--visibility", command->visibility_file,
                     "A volume of the same size, 0 to 1 (u8 and u16: to 255 and 65535), that darkens FILE's")
        ->excludes(iso);
    render
        ->add_option("--visibility-offset", command->visibility_offset,
                     "--surface, --iso: voxels along the normal at which visibility is read")
        ->capture_default_str()
        ->check(number_between(-8, 8));
    render
        ->add_option(
            "--gain", command->gain,
            "--tf: visibility is multiplied by it, up to 1. Default: 2 with --clip and --probe, since "
            "half of a plane's rays go into it; else 1")
        ->check(number_above_zero());
    render->add_flag("--unshaded", command->unshaded, "No shading by the gradient")
        ->excludes(iso)
        ->excludes(shading);
    render
        ->add_option("--reference-length", command->reference_length,
                     "World units that opacities are of; default: the smallest spacing")
        ->check(number_above_zero());
    render
        ->add_option("--step", command->step,
                     "World units between samples; default: half the smallest spacing")
        ->check(number_above_zero());
    add_vector(*render, "--view", command->view, "From the volume towards the eye; default 0.6 -1 0.45");
    add_vector(*render, "--up", command->up, "What is up in the picture; default 0 0 1");
    add_vector(*render, "--light", command->light, "Towards the light; default: from the eye");
    add_vector(*render, "--background", command->background, "Red, green, blue, 0 to 1; default 1 1 1")
        ->check(number_between(0, 1));
    render->add_option("--fov", command->fov, "Vertical field of view, degrees")
        ->capture_default_str()
        ->check(number_between(1, 120))
        ->group("Picture");
    for (const auto& [name, value] :
         {std::pair<const char*, std::uint32_t*>{"--width", &command->picture.width},
          {"--height", &command->picture.height}})
        render->add_option(name, *value, "Pixels")
            ->capture_default_str()
            ->check(CLI::Range(1, 16384))
            ->group("Picture");
    render->add_option("--samples", command->picture.samples, "Rays a pixel and axis")
        ->capture_default_str()
        ->check(CLI::Range(1, 16))
        ->group("Picture");
    add_clip_picture_options(*render, command->clipping);
    add_common_options(*render, command->common, "all cores");
    render->footer(
        "The whole volume is in the picture. Colours are written as they are, without a transfer curve.");
    render->callback([command] { run(*command); });
}

}  // namespace dfield::cli
