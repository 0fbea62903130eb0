// What commands say of their arguments: CLI11, and checks that several of them share. Slow to compile: for
// the files that add options, not for headers, which get by with CLI::App by name.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

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

}  // namespace dfield::cli
