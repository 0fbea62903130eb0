// The parts of `dfield screen`.
#pragma once

#include "baker/cli/app_fwd.hpp"
#include "baker/cli/report.hpp"
#include "baker/cli/screen_input.hpp"
#include "baker/cli/screen_runner.hpp"

namespace dfield::cli {

CLI::App* add_screen_compare_command(CLI::App& screen);

// --reference-pixels --reference-rays
void add_reference_options(CLI::App& command, ReferenceOptions& options);
// What reports say of their subject and settings.
Json screen_json(const ScreenInput& input, const ScreenSubject& subject, const dfield_screen_desc& desc);
int thread_count_of(const CommonOptions& common);

}  // namespace dfield::cli
