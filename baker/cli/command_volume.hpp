// The commands below `dfield volume`, one function each; they work as those of commands.hpp do.
#pragma once

#include "baker/cli/app_fwd.hpp"

namespace dfield::cli {

void add_volume_info_command(CLI::App& volume);
void add_volume_render_command(CLI::App& volume);
void add_volume_sweep_command(CLI::App& volume);
void add_volume_compare_command(CLI::App& volume);
void add_volume_lao_command(CLI::App& volume);
void add_volume_cao_command(CLI::App& volume);

}  // namespace dfield::cli
