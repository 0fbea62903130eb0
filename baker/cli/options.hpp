// Flags that several subcommands share.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "dfield/dfield.hpp"
#include "format/field.hpp"

namespace dfield::cli {

// Checks of numbers; all of them refuse NaN and infinity.
CLI::Validator number_between(double low, double high);
CLI::Validator number_above_zero();
CLI::Validator number_from_zero();
CLI::Validator finite_number();

// A name out of a few, spelt in any case; the first is the default, which `value` holds.
template<class Value>
CLI::Option* add_choice(CLI::App& command, const std::string& flag, Value& value,
                        const std::vector<std::pair<std::string, Value>>& choices,
                        const std::string& description) {
    std::vector<std::string> names;
    for (const auto& [name, meaning] : choices) names.push_back(name);
    const auto set = [&value, choices](const std::string& chosen) {
        for (const auto& [name, meaning] : choices)
            if (name == chosen) value = meaning;
    };
    return command.add_option_function<std::string>(flag, set, description)
        ->default_str(names.front())
        ->transform(CLI::IsMember(names, CLI::ignore_case));
}

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
