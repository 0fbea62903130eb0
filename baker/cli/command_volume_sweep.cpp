#include <filesystem>

#include "baker/cli/arguments.hpp"
#include "baker/cli/command_volume.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/cli/volume_input.hpp"
#include "baker/cli/volume_sweep.hpp"
#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/volume/write_nrrd.hpp"

namespace dfield::cli {
namespace {

namespace fs = std::filesystem;

struct SweepCommand {
    VolumeInput input;
    fs::path output, distance_file, octants_file;
    float isovalue = 0;
    std::array<float, 3> light{};
    std::optional<float> band;
    bool gzip = false;
    int repetitions = 3;
    SweepOptions options;
    CommonOptions common;
};

void check_outputs(const SweepCommand& command) {
    const fs::path* const all[] = {&command.output, &command.distance_file, &command.octants_file};
    for (const fs::path* path : all) {
        if (path->empty()) continue;
        if (extension_of(*path) != ".nrrd")
            throw Error(ExitCode::kUsage, path->string() +
                                              ": volumes are written as NRRD: the name must end "
                                              "in .nrrd");
        check_output(*path);
        for (const fs::path* other : all)
            if (other != path && *other == *path)
                throw Error(ExitCode::kUsage, path->string() + ": two outputs cannot be one file");
    }
}

dfield_sweep_desc described(SweepCommand& command, const VolumeGrid& grid) {
    dfield_sweep_desc desc = sweep_desc(command.options, command.isovalue);
    if (command.band) desc.band = *command.band;
    const glm::vec3 light(command.light[0], command.light[1], command.light[2]);
    if (light == glm::vec3(0)) return desc;
    if (!command.options.octants.empty() || !command.options.intensity.empty())
        throw Error(ExitCode::kUsage,
                    "--light is one octant turned to the light; --octants and --intensity are of the sky");
    const glm::vec3 turned = to_sweep_frame(grid, light);
    for (int axis = 0; axis < 3; ++axis) desc.light[axis] = turned[axis];
    return desc;
}

// Octants one after the other, out of two volumes of four channels.
std::vector<std::byte> unwoven(const std::vector<std::uint8_t>& octants, std::size_t voxels) {
    std::vector<std::byte> planes(octants.size());
    for (std::size_t octant = 0; octant < DFIELD_OCTANT_COUNT; ++octant) {
        const std::uint8_t* from = octants.data() + octant / 4 * 4 * voxels + octant % 4;
        std::byte* const to = planes.data() + octant * voxels;
        for (std::size_t i = 0; i < voxels; ++i) to[i] = std::byte{from[4 * i]};
    }
    return planes;
}

void write_floats(const fs::path& path, const VolumeGrid& grid, const std::vector<float>& values,
                  const NrrdOptions& options) {
    const std::span<const std::byte> bytes = std::as_bytes(std::span(values));
    write_nrrd(path, grid, VoxelType::kF32, std::span(&bytes, 1), options);
}

void write_octants(const SweepCommand& command, const VolumeGrid& grid,
                   const std::vector<std::uint8_t>& octants) {
    const std::vector<std::byte> planes = unwoven(octants, grid.voxels());
    std::vector<std::span<const std::byte>> components;
    for (std::size_t octant = 0; octant < DFIELD_OCTANT_COUNT; ++octant)
        components.push_back(std::span(planes).subspan(octant * grid.voxels(), grid.voxels()));
    write_nrrd(command.octants_file, grid, VoxelType::kU8, components,
               {.gzip = command.gzip,
                .content = "visibility of octants 0 to 7, 255 = open",
                .labels = {"x", "y", "z", "octant"}});
}

void run(SweepCommand& command) {
    check_outputs(command);
    const Volume volume = read_volume_input(command.input);
    const VolumeGrid& grid = volume.grid;
    const dfield_sweep_desc desc = described(command, grid);
    const bool lit = command.light != std::array<float, 3>{};
    if (!command.octants_file.empty() && (lit || desc.form == DFIELD_FORM_COMBINED))
        throw Error(ExitCode::kUsage,
                    "--octant-volume: with --light and with --form combined the octants are not kept apart");
    const VolumeSweeper sweeper(command.input.file, volume, command.isovalue, command.common.threads);

    std::vector<float> distance(grid.voxels()), visibility(grid.voxels());
    // The paper's form needs them in any case; here, runs share the memory.
    const bool octants_swept = !command.octants_file.empty() || (desc.form == DFIELD_FORM_PAPER && !lit);
    std::vector<std::uint8_t> octants(octants_swept ? 8 * grid.voxels() : 0);
    dfield_sweep_outputs alone = no_sweep_outputs();
    alone.distance = distance.data();
    dfield_sweep_outputs all = alone;
    all.visibility = visibility.data();
    if (octants_swept) all.octants = octants.data();
    double seconds = sweeper.sweep(desc, all), seconds_distance = 0;
    if (!command.common.json.empty()) {
        seconds_distance = sweeper.sweep(desc, alone);
        for (int i = 1; i < command.repetitions; ++i) {
            seconds = std::min(seconds, sweeper.sweep(desc, all));
            seconds_distance = std::min(seconds_distance, sweeper.sweep(desc, alone));
        }
    }

    write_floats(command.output, grid, visibility, {.gzip = command.gzip, .content = "visibility, 1 = open"});
    if (!command.distance_file.empty())
        write_floats(command.distance_file, grid, distance,
                     {.gzip = command.gzip, .content = "distance to the isosurface, below 0 inside"});
    if (!command.octants_file.empty()) write_octants(command, grid, octants);

    const double rate = static_cast<double>(grid.voxels()) / seconds;
    say(command.common.json, text("%s: %s voxels, %.3g s, %svoxel/s on %d thread%s", command.output.c_str(),
                                  size_text(grid.size).c_str(), seconds, with_prefix(rate).c_str(),
                                  sweeper.threads(), sweeper.threads() == 1 ? "" : "s"));
    if (command.common.json.empty()) return;
    const double occlusion = seconds - seconds_distance;
    say(command.common.json, text("distance alone %.3g s, occlusion %.3g s (%+.0f%%)", seconds_distance,
                                  occlusion, 100 * occlusion / seconds_distance));
    Json json = volume_json(command.input, volume);
    json["iso"] = significant(command.isovalue, 7);
    json["form"] = command.options.form;
    json["threads"] = sweeper.threads();
    json["seconds_sdf"] = significant(seconds_distance);
    json["seconds_occlusion"] = significant(occlusion);
    json["mvoxels_per_s"] = significant(rate / 1e6);
    json["overhead_fraction"] = significant(occlusion / seconds_distance);
    json["output"] = command.output.string();
    if (!command.distance_file.empty()) json["sdf"] = command.distance_file.string();
    if (!command.octants_file.empty()) json["octant_volume"] = command.octants_file.string();
    write_json_report(command.common.json, json);
}

}  // namespace

void add_volume_sweep_command(CLI::App& volume) {
    auto command = std::make_shared<SweepCommand>();
    CLI::App* sweep =
        volume.add_subcommand("sweep", "Ambient occlusion of an isosurface, at every voxel, by sweeping");
    add_volume_input(*sweep, command->input);
    sweep->add_option("-o,--output", command->output, "Visibility, 1 = open: a float NRRD on FILE's grid")
        ->required();
    add_isovalue_option(*sweep, command->isovalue);
    add_sweep_options(*sweep, command->options);
    sweep
        ->add_option("--light", command->light,
                     "Low-frequency shadows of a light in this direction of the world instead of the sky")
        ->type_name("X,Y,Z")
        ->delimiter(',')
        ->check(finite_number())
        ->group("Sweep");
    sweep
        ->add_option("--band", command->band,
                     "Distances farther than this, in world units, are cut off at it; default: none are")
        ->check(number_above_zero())
        ->group("Sweep");
    sweep->add_option("--sdf", command->distance_file,
                      "Also write the distance to the isosurface, in world units, below 0 inside");
    sweep->add_option("--octant-volume", command->octants_file,
                      "Also write the visibility of each octant, 255 = open: 8 u8 components");
    sweep->add_flag("--gzip", command->gzip, "Compress what is written; ParaView reads raw voxels only");
    add_repetitions_option(*sweep, command->repetitions,
                           "--json: runs with and without occlusion; the fastest count");
    add_common_options(*sweep, command->common, "all cores");
    sweep->footer(
        "Octant 0..7 is the sky in the directions whose x along the grid's own axes is positive if bit 0 is "
        "set\n"
        "and negative otherwise, likewise y and bit 1, z and bit 2; 4,5,6,7 is a sky above. Which way these "
        "axes\n"
        "point in the world, the file's directions say (dfield volume info). --light is of the world, as the "
        "file\n"
        "tells it (LPS, RAS), and is carried into the grid, rotated, mirrored or oblique.");
    sweep->callback([command, sweep] {
        if (sweep->count("--light") > 0 && command->light == std::array<float, 3>{})
            throw Error(ExitCode::kUsage, "--light: 0,0,0 is no direction");
        run(*command);
    });
}

}  // namespace dfield::cli
