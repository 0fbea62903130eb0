#include "baker/cli/arguments.hpp"
#include "baker/cli/command_volume.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/volume_input.hpp"

namespace dfield::cli {
namespace {

std::string vector_text(const glm::dvec3& v) {
    return text("%g %g %g", v.x, v.y, v.z);
}

void print_info(const std::string& target, const Json& json, const Volume& volume) {
    const VolumeGrid& grid = volume.grid;
    const auto line = [&](const char* label, const std::string& value) {
        say(target, text("%-12s %s", label, value.c_str()));
    };
    line("file", json["file"].get<std::string>() + ", " + json["format"].get<std::string>());
    line("voxels", size_text(grid.size) + ", " + name_of(volume.type));
    line("range", text("%g to %g", json["range"][0].get<double>(), json["range"][1].get<double>()));
    line("spacing", vector_text(grid.spacing()) + (grid.unit.empty() ? "" : " " + grid.unit));
    line("origin", vector_text(grid.origin));
    for (int axis = 0; axis < 3; ++axis)
        line(axis == 0 ? "directions" : "", vector_text(grid.directions[axis]));
    line("space", (grid.space.empty() ? std::string("not said") : grid.space) +
                      (grid.right_handed() ? "" : ", axes left-handed"));
}

}  // namespace

void add_volume_info_command(CLI::App& volume) {
    struct InfoCommand {
        VolumeInput input;
        std::string json;
    };
    auto command = std::make_shared<InfoCommand>();
    CLI::App* info = volume.add_subcommand("info", "Show what a volume holds and where it lies");
    add_volume_input(*info, command->input);
    add_json_option(*info, command->json, "it");
    info->footer(
        "Directions are the steps from a voxel to the next along x, y and z in world units, the origin is "
        "the\n"
        "first voxel's place. Slope and intercept of NIfTI files are applied.");
    info->callback([command] {
        const Volume volume = read_volume_input(command->input);
        Json json = volume_json(command->input, volume);
        const ValueRange range = value_range(volume);
        json["range"] = {range.min, range.max};
        print_info(command->json, json, volume);
        write_json_report(command->json, json);
    });
}

}  // namespace dfield::cli
