// Reports: lines for people on stdout, and the same as JSON where asked for.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "baker/scene.hpp"

namespace dfield::cli {

using Json = nlohmann::ordered_json;

// Writes `json` to the file that --json named ("-" = stdout, "" = nowhere). Throws OutputError.
void write_json_report(const std::string& target, const Json& json);

// A line for people; goes to stdout unless --json - claims that, then to stderr.
void say(const std::string& json_target, const std::string& line);

// On stderr: what the import of `path` warned of and what it left out.
void warn_of(const std::filesystem::path& path, const ImportReport& report);

// A PNG output's ending and folder, before the work begins; an empty path means no picture. Throws Error.
void check_picture(const std::filesystem::path& path);

// The ending of a file's name in lower case, with its dot.
std::string extension_of(const std::filesystem::path& path);

// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...);

// Rounded to `digits` significant digits, so that reports do not pretend to more than was measured.
double significant(double value, int digits = 5);

}  // namespace dfield::cli
