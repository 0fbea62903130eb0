#include "baker/volume/transfer_function.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <locale>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "baker/error.hpp"
#include "baker/file_io.hpp"

namespace dfield {
namespace {

template<class Point>
void check_values(const std::vector<Point>& points, const char* name) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!std::isfinite(points[i].value))
            throw std::invalid_argument(std::string(name) + " " + std::to_string(i) +
                                        " has a value that is not finite");
        if (i > 0 && points[i].value < points[i - 1].value)
            throw std::invalid_argument(std::string(name) + " " + std::to_string(i) +
                                        " has a smaller value than the one before; sort them by value");
    }
}

bool is_fraction(float x) {
    return x >= 0 && x <= 1;
}

// Calls blend(a, b, t) for the points on either side of the value.
template<class Point, class Blend>
auto interpolate(const std::vector<Point>& points, double value, const Blend& blend) {
    const auto after = std::upper_bound(points.begin(), points.end(), value,
                                        [](double v, const Point& point) { return v < point.value; });
    if (after == points.begin()) return blend(points.front(), points.front(), 0.0f);
    if (after == points.end()) return blend(points.back(), points.back(), 0.0f);
    const Point& before = *(after - 1);
    return blend(before, *after, static_cast<float>((value - before.value) / (after->value - before.value)));
}

// `count` numbers out of an entry of the list `name`.
std::vector<double> numbers(const nlohmann::json& entry, std::size_t count, const std::string& where,
                            const char* expected) {
    const bool good = entry.is_array() && entry.size() == count &&
                      std::all_of(entry.begin(), entry.end(), [](const auto& n) { return n.is_number(); });
    if (!good) throw InputError(where + " is not " + expected);
    return entry.get<std::vector<double>>();
}

}  // namespace

TransferFunction::TransferFunction(std::vector<Opacity> points, std::vector<Colour> colours)
    : points_(std::move(points)), colours_(std::move(colours)) {
    if (points_.empty()) throw std::invalid_argument("there are no points");
    check_values(points_, "point");
    check_values(colours_, "color");
    for (std::size_t i = 0; i < points_.size(); ++i)
        if (!is_fraction(points_[i].opacity))
            throw std::invalid_argument("point " + std::to_string(i) + " has an opacity outside 0..1");
    for (std::size_t i = 0; i < colours_.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (!is_fraction(colours_[i].rgb[c]))
                throw std::invalid_argument("color " + std::to_string(i) + " has a component outside 0..1");
}

float TransferFunction::opacity(double value) const {
    return interpolate(points_, value, [](const Opacity& a, const Opacity& b, float t) {
        return a.opacity + t * (b.opacity - a.opacity);
    });
}

glm::vec3 TransferFunction::colour(double value) const {
    if (colours_.empty()) return glm::vec3(1);
    return interpolate(colours_, value,
                       [](const Colour& a, const Colour& b, float t) { return a.rgb + t * (b.rgb - a.rgb); });
}

namespace {

// Lines of numbers, separated by spaces, tabs, commas or semicolons: value and opacity, or value, red, green,
// blue and opacity; # begins a comment.
TransferFunction parse_table(std::string_view text, const std::string& name) {
    std::vector<TransferFunction::Opacity> points;
    std::vector<TransferFunction::Colour> colours;
    std::size_t line_number = 0, columns = 0;
    while (!text.empty()) {
        const std::size_t length = std::min(text.find('\n'), text.size());
        std::string line(text.substr(0, std::min(length, text.find('#'))));
        text.remove_prefix(std::min(length + 1, text.size()));
        ++line_number;
        for (char& c : line)
            if (c == ',' || c == ';' || c == '\t' || c == '\r') c = ' ';
        std::vector<double> n;
        std::istringstream words(line);
        words.imbue(std::locale::classic());
        for (double value; words >> value;) n.push_back(value);
        const std::string where = name + ": line " + std::to_string(line_number);
        if (!words.eof()) throw InputError(where + " holds something other than numbers");
        if (n.empty()) continue;
        if ((n.size() != 2 && n.size() != 5) || (columns != 0 && n.size() != columns))
            throw InputError(
                where + " has " + std::to_string(n.size()) +
                " numbers; expected are value and opacity, or value, red, green, blue and opacity, in "
                "every line");
        columns = n.size();
        points.push_back({n[0], static_cast<float>(n.back())});
        if (columns == 5) colours.push_back({n[0], glm::vec3(n[1], n[2], n[3])});
    }
    try {
        return TransferFunction(std::move(points), std::move(colours));
    } catch (const std::invalid_argument& error) {
        throw InputError(name + ": " + error.what());
    }
}

}  // namespace

TransferFunction parse_transfer_function(std::string_view text, const std::string& name) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    if (first != std::string_view::npos && (std::strchr("+-.#0123456789", text[first]) != nullptr))
        return parse_table(text, name);
    const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
    constexpr const char* kForm =
        R"({"points": [[value, opacity], ...], "colors": [[value, red, green, blue], ...]})";
    if (!json.is_object() || !json.contains("points") || !json["points"].is_array())
        throw InputError(name + ": is no transfer function, which is JSON: " + kForm +
                         ", or lines of text: value opacity");
    std::vector<TransferFunction::Opacity> points;
    for (const auto& entry : json["points"]) {
        const auto n =
            numbers(entry, 2, name + ": point " + std::to_string(points.size()), "[value, opacity]");
        points.push_back({n[0], static_cast<float>(n[1])});
    }
    std::vector<TransferFunction::Colour> colours;
    if (json.contains("colors")) {
        if (!json["colors"].is_array()) throw InputError(name + ": 'colors' is no list; expected " + kForm);
        for (const auto& entry : json["colors"]) {
            const auto n = numbers(entry, 4, name + ": color " + std::to_string(colours.size()),
                                   "[value, red, green, blue]");
            colours.push_back({n[0], glm::vec3(n[1], n[2], n[3])});
        }
    }
    try {
        return TransferFunction(std::move(points), std::move(colours));
    } catch (const std::invalid_argument& error) {
        throw InputError(name + ": " + error.what());
    }
}

TransferFunction read_transfer_function(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = read_file(path);
    return parse_transfer_function({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                                   path.string());
}

}  // namespace dfield
