#include "baker/cli/report.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "baker/error.hpp"
#include "baker/file_io.hpp"

namespace dfield::cli {

void write_json_report(const std::string& target, const Json& json) {
    if (target.empty()) return;
    // Names of files need not be UTF-8, JSON must be.
    const std::string dump = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    if (target == "-")
        std::fputs(dump.c_str(), stdout);
    else
        write_file_atomic(target, dump);
}

void say(const std::string& json_target, const std::string& line) {
    std::fprintf(json_target == "-" ? stderr : stdout, "%s\n", line.c_str());
}

void warn_of(const std::filesystem::path& path, const ImportReport& report) {
    for (const std::string& warning : report.warnings)
        std::fprintf(stderr, "dfield: %s: %s\n", path.string().c_str(), warning.c_str());
    if (const std::string left_out = report.left_out(); !left_out.empty())
        std::fprintf(stderr, "dfield: %s: left out: %s\n", path.string().c_str(), left_out.c_str());
}

void check_picture(const std::filesystem::path& path) {
    if (path.empty()) return;
    if (extension_of(path) != ".png")
        throw Error(ExitCode::kUsage, path.string() + ": pictures are PNG: the name must end in .png");
    check_output(path);
}

std::string extension_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

std::string text(const char* format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    std::string result(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, arguments)), '\0');
    std::vsnprintf(result.data(), result.size() + 1, format, again);
    va_end(again);
    va_end(arguments);
    return result;
}

double significant(double value, int digits) {
    if (value == 0 || !std::isfinite(value)) return value;
    const double scale = std::pow(10.0, digits - 1 - std::floor(std::log10(std::fabs(value))));
    return std::round(value * scale) / scale;
}

}  // namespace dfield::cli
