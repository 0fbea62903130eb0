// One function a subcommand: adds itself to the parser; its callback runs the command and returns through an
// exception (dfield::Error) or sets `exit_code`.
#pragma once

#include "baker/cli/app_fwd.hpp"
#include "baker/error.hpp"

namespace dfield::cli {

void add_bake_command(CLI::App& app, ExitCode& exit_code);
void add_info_command(CLI::App& app, ExitCode& exit_code);
void add_validate_command(CLI::App& app, ExitCode& exit_code);
void add_ao_command(CLI::App& app, ExitCode& exit_code);
void add_compare_command(CLI::App& app, ExitCode& exit_code);
void add_screen_command(CLI::App& app, ExitCode& exit_code);
void add_volume_command(CLI::App& app, ExitCode& exit_code);

}  // namespace dfield::cli
