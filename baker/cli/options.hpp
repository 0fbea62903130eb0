// Flags that several subcommands share.
#pragma once

#include <string>
#include <vector>

#include "baker/cli/app_fwd.hpp"
#include "dfield/dfield.hpp"
#include "format/field.hpp"

namespace dfield::cli {

// --subdivision --map-size --mapping --positions --bits
void add_field_options(CLI::App& command, FieldParameters& parameters);

// --json: `what` as it stands in the help. Throws OutputError in parsing where no file can be written.
void add_json_option(CLI::App& command, std::string& target, const std::string& what);

// --repetitions, 1..1000: `what` as it stands in the help.
void add_repetitions_option(CLI::App& command, int& repetitions, const std::string& what);

// --threads, --json, --quiet
struct CommonOptions {
    int threads = 0;
    std::string json;
    bool quiet = false;
};
void add_common_options(CLI::App& command, CommonOptions& options, const std::string& threads_default);

// --rays --max-distance --falloff --falloff-rate --falloff-table --bias
struct AoOptions {
    dfield_ao_desc desc;
    std::vector<float> table;  // what desc.falloff_table points at
    std::string table_file;
    AoOptions() { dfield_ao_desc_init(&desc); }
};
void add_ao_options(CLI::App& command, AoOptions& options);
// Reads the table file, checks that the options fit together. Call after parsing.
void finish_ao_options(AoOptions& options);

}  // namespace dfield::cli
