#include "baker/cli/report.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "baker/file_io.hpp"

namespace dfield::cli {

void write_json_report(const std::string& target, const Json& json) {
    if (target.empty()) return;
    const std::string dump = json.dump(2) + "\n";
    if (target == "-")
        std::fputs(dump.c_str(), stdout);
    else
        write_file_atomic(target, dump);
}

void say(const std::string& json_target, const std::string& line) {
    std::fprintf(json_target == "-" ? stderr : stdout, "%s\n", line.c_str());
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
