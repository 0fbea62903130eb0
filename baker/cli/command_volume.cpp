#include "baker/cli/command_volume.hpp"

#include "baker/cli/arguments.hpp"
#include "baker/cli/commands.hpp"

namespace dfield::cli {

void add_volume_command(CLI::App& app, ExitCode&) {
    CLI::App* volume = app.add_subcommand("volume", "Volumes: densities on a grid, such as CT scans");
    volume->require_subcommand(1);
    add_volume_info_command(*volume);
    add_volume_sweep_command(*volume);
    add_volume_compare_command(*volume);
    add_volume_lao_command(*volume);
    add_volume_cao_command(*volume);
    add_volume_render_command(*volume);
}

}  // namespace dfield::cli
