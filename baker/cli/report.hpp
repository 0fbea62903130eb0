// Reports: lines for people on stdout, and the same as JSON where asked for.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace dfield::cli {

using Json = nlohmann::ordered_json;

// Writes `json` to the file that --json named ("-" = stdout, "" = nowhere). Throws OutputError.
void write_json_report(const std::string& target, const Json& json);

// A line for people; goes to stdout unless --json - claims that, then to stderr.
void say(const std::string& json_target, const std::string& line);

// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...);

// Rounded to `digits` significant digits, so that reports do not pretend to more than was measured.
double significant(double value, int digits = 5);

}  // namespace dfield::cli
