#include "baker/picture/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <stdexcept>

#include "baker/picture/font.hpp"

namespace dfield {
namespace {

using glm::dvec2;

constexpr std::uint32_t kScale = 2;  // of letters
constexpr double kLetter = kScale * kFontAdvance, kLine = kScale * kFontLine, kGap = 8;
constexpr double kLetterHeight = kScale * 7;    // of capitals
constexpr double kMarker = 6.5, kStroke = 1.1;  // radius and half width, pixels
constexpr glm::u8vec3 kFrame{90, 90, 90}, kGrid{222, 222, 222};

struct Rectangle {
    dvec2 low{0}, high{0};
    bool meets(const Rectangle& other) const {
        return low.x < other.high.x && other.low.x < high.x && low.y < other.high.y && other.low.y < high.y;
    }
    bool holds(const Rectangle& other) const {
        return low.x <= other.low.x && low.y <= other.low.y && other.high.x <= high.x &&
               other.high.y <= high.y;
    }
};

double text_width(const std::string& text) {
    return kLetter * static_cast<double>(text.size());
}

std::string short_number(double value) {
    const char* const kSuffixes[] = {"", "k", "M", "G", "T"};
    std::size_t suffix = 0;
    while (std::fabs(value) >= 999.5 && suffix + 1 < std::size(kSuffixes)) value /= 1000, ++suffix;
    std::array<char, 32> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "%.3g", value);
    return buffer.data() + std::string(kSuffixes[suffix]);
}

// Fills what `inside` says (its value is the coverage of a pixel's middle, beyond 0 and 1 cut off) within a
// box.
template<class Inside>
void fill(Image& image, const dvec2& low, const dvec2& high, const glm::u8vec3& colour,
          const Inside& inside) {
    const auto first_x = static_cast<std::int64_t>(std::max(0.0, std::floor(low.x)));
    const auto first_y = static_cast<std::int64_t>(std::max(0.0, std::floor(low.y)));
    const auto last_x = std::min<std::int64_t>(image.width - 1, static_cast<std::int64_t>(std::ceil(high.x)));
    const auto last_y =
        std::min<std::int64_t>(image.height - 1, static_cast<std::int64_t>(std::ceil(high.y)));
    for (std::int64_t y = first_y; y <= last_y; ++y)
        for (std::int64_t x = first_x; x <= last_x; ++x) {
            const double cover = std::clamp(inside(dvec2(x, y) + 0.5), 0.0, 1.0);
            if (cover == 0) continue;
            std::uint8_t* pixel = image.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
            for (int channel = 0; channel < 3; ++channel)
                pixel[channel] = static_cast<std::uint8_t>(std::lround(glm::mix(
                    static_cast<double>(pixel[channel]), static_cast<double>(colour[channel]), cover)));
        }
}

void draw_segment(Image& image, const dvec2& a, const dvec2& b, double half_width,
                  const glm::u8vec3& colour) {
    const dvec2 along = b - a, margin(half_width + 1);
    const double squared = glm::dot(along, along);
    fill(image, glm::min(a, b) - margin, glm::max(a, b) + margin, colour, [&](const dvec2& p) {
        const double t = squared > 0 ? std::clamp(glm::dot(p - a, along) / squared, 0.0, 1.0) : 0;
        return half_width + 0.5 - glm::distance(p, a + t * along);
    });
}

// Signed distance to the marker's edge, about; positive inside.
double inside_marker(Marker marker, const dvec2& p) {
    const dvec2 q = glm::abs(p);
    switch (marker) {
        case Marker::kSquare:
            return 0.85 * kMarker - std::max(q.x, q.y);
        case Marker::kDiamond:
            return (1.25 * kMarker - q.x - q.y) * 0.7071;
        case Marker::kTriangle:
            return std::min(0.7 * kMarker - p.y, (1.1 * kMarker + p.y - 1.9 * q.x) * 0.466);
        case Marker::kCross:
            return std::min(0.3 * kMarker - std::min(std::fabs(p.x - p.y), std::fabs(p.x + p.y)) * 0.7071,
                            kMarker - std::max(q.x, q.y));
        case Marker::kRing:
            return 0.33 * kMarker - std::fabs(glm::length(p) - 0.75 * kMarker);
        default:
            return kMarker * 0.95 - glm::length(p);
    }
}

void draw_marker(Image& image, const dvec2& at, Marker marker, const glm::u8vec3& colour) {
    const dvec2 reach(1.4 * kMarker + 2);
    // A white rim keeps it apart from lines and other markers.
    fill(image, at - reach, at + reach, {255, 255, 255},
         [&](const dvec2& p) { return inside_marker(marker, p - at) + 2; });
    fill(image, at - reach, at + reach, colour,
         [&](const dvec2& p) { return inside_marker(marker, p - at) + 0.5; });
}

void write(Image& image, const dvec2& corner, const std::string& text) {
    if (corner.x < 0 || corner.y < 0) return;
    draw_text(image, static_cast<std::uint32_t>(corner.x), static_cast<std::uint32_t>(corner.y), text,
              kScale);
}

// An axis with its range fixed: values to 0 .. 1.
class Scale {
  public:
    Scale(const PlotAxis& axis, double least, double greatest) : axis_(axis), from_(least), to_(greatest) {
        if (axis.from != axis.to) {
            from_ = axis.from, to_ = axis.to;
        } else if (axis.logarithmic) {
            const double margin = std::max(std::pow(to_ / from_, 0.06), 1.15);
            from_ /= margin, to_ *= margin;
        } else {
            from_ = std::min(0.0, from_), to_ += 0.06 * (to_ - from_);
            if (to_ == from_) to_ += 1;
        }
    }

    double place(double value) const {
        return axis_.logarithmic ? std::log(value / from_) / std::log(to_ / from_)
                                 : (value - from_) / (to_ - from_);
    }

    // Those within the range, ascending.
    std::vector<double> ticks() const {
        std::vector<double> result;
        const auto add = [&](double value) {
            if (place(value) > -1e-9 && place(value) < 1 + 1e-9) result.push_back(value);
        };
        if (axis_.logarithmic) {
            const auto digits =
                to_ > 10 * from_ ? std::vector<double>{1, 2, 5} : std::vector<double>{1, 1.5, 2, 3, 5, 7};
            for (int power = static_cast<int>(std::floor(std::log10(from_))); std::pow(10.0, power) <= to_;
                 ++power)
                for (const double digit : digits) add(digit * std::pow(10.0, power));
        } else {
            const double rough = (to_ - from_) / 7, power = std::pow(10, std::floor(std::log10(rough)));
            const double step = power * (rough > 5 * power   ? 10
                                         : rough > 2 * power ? 5
                                         : rough > power     ? 2
                                                             : 1);
            for (double i = std::ceil(from_ / step); i * step <= to_; ++i) add(i * step);
        }
        return result;
    }

    std::string label(double value) const { return axis_.label ? axis_.label(value) : short_number(value); }

  private:
    const PlotAxis& axis_;
    double from_, to_;
};

void check_value(const PlotAxis& axis, double value) {
    if (!std::isfinite(value) || (axis.logarithmic && value <= 0))
        throw std::invalid_argument("draw_plot: a value that axis '" + axis.title + "' cannot show");
}

Scale scale_of(const PlotAxis& axis, const Plot& plot, double PlotPoint::*coordinate) {
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (const PlotSeries& series : plot.series)
        for (const PlotPoint& point : series.points) {
            check_value(axis, point.*coordinate);
            least = std::min(least, point.*coordinate);
            greatest = std::max(greatest, point.*coordinate);
        }
    if (least > greatest) throw std::invalid_argument("draw_plot: no points");
    return {axis, least, greatest};
}

class Drawing {
  public:
    explicit Drawing(const Plot& plot)
        : plot_(plot),
          x_(scale_of(plot.x, plot, &PlotPoint::x)),
          y_(scale_of(plot.y, plot, &PlotPoint::y)),
          image_(plot.width, plot.height) {
        double names = 0, ticks = 0;
        for (const PlotSeries& series : plot.series) names = std::max(names, text_width(series.name));
        for (const double tick : y_.ticks()) ticks = std::max(ticks, text_width(y_.label(tick)));
        const double legend = names + 4 * kMarker + 2 * kGap;
        // The y axis' title stands above it, beside the plot's own: letters cannot be turned.
        frame_ = {{ticks + 2 * kGap, 2 * kLine + 2 * kGap},
                  {plot.width - legend - kGap, plot.height - 2 * kLine - 2 * kGap}};
    }

    Image draw() {
        draw_axes();
        for (const PlotSeries& series : plot_.series) draw_lines(series);
        for (const PlotSeries& series : plot_.series)
            for (const PlotPoint& point : series.points) {
                const dvec2 at = place(point);
                draw_marker(image_, at, series.marker, series.colour);
                taken_.push_back({at - kMarker, at + kMarker});
            }
        for (const PlotSeries& series : plot_.series)
            for (const PlotPoint& point : series.points) draw_label(point);
        draw_legend();
        return std::move(image_);
    }

  private:
    dvec2 place(const PlotPoint& point) const {
        return {glm::mix(frame_.low.x, frame_.high.x, x_.place(point.x)),
                glm::mix(frame_.high.y, frame_.low.y, y_.place(point.y))};
    }

    void draw_axes() {
        const dvec2 low = frame_.low, high = frame_.high;
        double free_from = 0;
        for (const double tick : x_.ticks()) {
            const double x = glm::mix(low.x, high.x, x_.place(tick));
            draw_segment(image_, {x, low.y}, {x, high.y}, 0.5, kGrid);
            const std::string label = x_.label(tick);
            const double left = x - 0.5 * text_width(label);
            if (left < free_from) continue;
            write(image_, {left, high.y + kGap}, label);
            free_from = left + text_width(label) + kLetter;
        }
        double free_below = plot_.height;
        for (const double tick : y_.ticks()) {
            const double y = glm::mix(high.y, low.y, y_.place(tick));
            draw_segment(image_, {low.x, y}, {high.x, y}, 0.5, kGrid);
            const std::string label = y_.label(tick);
            if (y + 0.5 * kLine > free_below) continue;
            write(image_, {low.x - kGap - text_width(label), y - 0.5 * kLetterHeight}, label);
            free_below = y - 0.5 * kLine;
        }
        draw_segment(image_, {low.x, low.y}, {low.x, high.y}, 1, kFrame);
        draw_segment(image_, {low.x, high.y}, {high.x, high.y}, 1, kFrame);
        write(image_, {kGap, kGap}, plot_.title);
        write(image_, {kGap, kGap + kLine}, plot_.y.title);
        write(image_, {0.5 * (low.x + high.x - text_width(plot_.x.title)), high.y + kGap + kLine},
              plot_.x.title);
    }

    void draw_lines(const PlotSeries& series) {
        for (std::size_t i = 1; series.joined && i < series.points.size(); ++i)
            draw_segment(image_, place(series.points[i - 1]), place(series.points[i]), kStroke,
                         series.colour);
    }

    // In the first place around the marker that is free.
    void draw_label(const PlotPoint& point) {
        if (point.label.empty()) return;
        const dvec2 at = place(point), size(text_width(point.label) - kScale, kLetterHeight);
        const double away = 1.6 * kMarker, beside = -0.5 * size.y;
        const dvec2 corners[] = {{away, beside},
                                 {-0.5 * size.x, -away - size.y},
                                 {-0.5 * size.x, away},
                                 {-away - size.x, beside},
                                 {0.6 * away, -0.6 * away - size.y},
                                 {0.6 * away, 0.6 * away},
                                 {-0.6 * away - size.x, -0.6 * away - size.y},
                                 {-0.6 * away - size.x, 0.6 * away}};
        for (const dvec2& corner : corners) {
            const Rectangle room{at + corner - 1.0, at + corner + size + 1.0};
            if (!frame_.holds(room) || std::any_of(taken_.begin(), taken_.end(),
                                                   [&](const Rectangle& other) { return other.meets(room); }))
                continue;
            write(image_, at + corner, point.label);
            taken_.push_back(room);
            return;
        }
    }

    void draw_legend() {
        const double left = frame_.high.x + kGap + 2 * kMarker;
        double y = frame_.low.y + kMarker;
        for (const PlotSeries& series : plot_.series) {
            const dvec2 at(left, y);
            if (series.joined)
                draw_segment(image_, at - dvec2(2 * kMarker, 0), at + dvec2(2 * kMarker, 0), kStroke,
                             series.colour);
            draw_marker(image_, at, series.marker, series.colour);
            write(image_, at + dvec2(2 * kMarker + kGap, -0.5 * kLetterHeight), series.name);
            y += 1.2 * kLine;
        }
    }

    const Plot& plot_;
    Scale x_, y_;
    Image image_;
    Rectangle frame_;               // between the axes
    std::vector<Rectangle> taken_;  // by markers and labels
};

}  // namespace

Image draw_plot(const Plot& plot) {
    return Drawing(plot).draw();
}

}  // namespace dfield
