// Diagrams for reports: points and lines over logarithmic or linear axes.
#pragma once

#include <cstdint>
#include <glm/ext/vector_uint3_sized.hpp>
#include <string>
#include <vector>

#include "baker/picture/image.hpp"

namespace dfield {

struct PlotAxis {
    std::string title;
    bool logarithmic = false;
    // The range shown; equal ends stand for that of the points, with a margin.
    double from = 0, to = 0;
    // How a tick's value is written; null: the shortest decimal with k, M or G.
    std::string (*label)(double value) = nullptr;
};

enum class Marker { kDisc, kSquare, kDiamond, kTriangle, kCross, kRing };

struct PlotPoint {
    double x = 0, y = 0;
    std::string label;  // beside the marker; may be empty
};

struct PlotSeries {
    std::string name;  // in the legend
    glm::u8vec3 colour{0};
    Marker marker = Marker::kDisc;
    bool joined = true;  // a line through the points in their order
    std::vector<PlotPoint> points;
};

struct Plot {
    std::string title;
    PlotAxis x, y;
    std::vector<PlotSeries> series;
    std::uint32_t width = 820, height = 560;
};

// Ticks are at 1, 2 and 5 times powers of ten on logarithmic axes (and between, where they span less than
// ten), at even round steps on linear ones. The legend is beside the diagram. Labels give way to markers and
// to each other, and one that finds no room is left out; those of points come in the order of the series.
// Throws std::invalid_argument for a plot without points, and for a value that is not finite or, on a
// logarithmic axis, not above zero.
Image draw_plot(const Plot& plot);

}  // namespace dfield
