#include "bench/common/asked.hpp"

#include <array>
#include <cstdio>

namespace dfield::bench {
namespace {

// The format is data of our own, with one double in each.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
#pragma GCC diagnostic ignored "-Wformat-security"
std::string formatted(const Bound& bound, double value) {
    std::array<char, 64> buffer{};
    std::snprintf(buffer.data(), buffer.size(), bound.format, value);
    return buffer.data();
}
#pragma GCC diagnostic pop

std::string bound_text(const Bound& bound, std::optional<double> value) {
    return value ? (bound.at_least ? "≥ " : "≤ ") + formatted(bound, *value) : "–";
}

}  // namespace

void AskedTable::row(const std::string& what, const Bound& bound, double measured) {
    table_.row({what, bound_text(bound, bound.limit), bound_text(bound, bound.aim),
                formatted(bound, measured),
                bound.aim && bound.holds(*bound.aim, measured) ? "aim"
                : bound.holds(bound.limit, measured)           ? "yes"
                                                               : "**no**"});
}

void AskedTable::missing(const std::string& what, const Bound& bound, const std::string& why) {
    table_.row({what, bound_text(bound, bound.limit), bound_text(bound, bound.aim), "**not measured**", why});
}

}  // namespace dfield::bench
