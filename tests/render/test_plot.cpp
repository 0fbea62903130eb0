#include "baker/picture/plot.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <stdexcept>

namespace {

using namespace dfield;

constexpr glm::u8vec3 kRed{200, 10, 20};

Plot one_point(double x, double y) {
    Plot plot;
    plot.title = "title";
    plot.x = {"x", true, 1, 1000, nullptr};
    plot.y = {"y", false, 0, 10, nullptr};
    plot.series = {{"series", kRed, Marker::kSquare, true, {{x, y, "label"}}}};
    return plot;
}

struct Place {
    double x = 0, y = 0;
    int pixels = 0;
};

// Middle of the pixels of the colour left of the legend.
Place place_of(const Image& image, const glm::u8vec3& colour) {
    Place place;
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width * 3 / 4; ++x)
            if (std::equal(&colour[0], &colour[0] + 3, image.at(x, y)))
                place.x += x, place.y += y, ++place.pixels;
    place.x /= place.pixels, place.y /= place.pixels;
    return place;
}

}  // namespace

TEST_CASE("A logarithmic axis is even in factors, a linear one in differences") {
    const Place a = place_of(draw_plot(one_point(3, 2)), kRed),
                b = place_of(draw_plot(one_point(30, 5)), kRed),
                c = place_of(draw_plot(one_point(300, 8)), kRed);
    REQUIRE(a.pixels > 30);
    CHECK(b.x - a.x > 100);
    CHECK(c.x - b.x == Approx(b.x - a.x).margin(1));
    CHECK(a.y - b.y > 80);  // greater values are higher up
    CHECK(b.y - c.y == Approx(a.y - b.y).margin(1));
}

TEST_CASE("Lines join the points of a series") {
    Plot plot = one_point(10, 5);
    plot.series[0].points.push_back({100, 5, ""});
    const int joined = place_of(draw_plot(plot), kRed).pixels;
    plot.series[0].joined = false;
    CHECK(joined > place_of(draw_plot(plot), kRed).pixels + 50);
}

TEST_CASE("Plots of what cannot be shown are refused") {
    CHECK_THROWS_AS(draw_plot(one_point(0, 1)), std::invalid_argument);
    CHECK_THROWS_AS(draw_plot(one_point(-1, 1)), std::invalid_argument);
    CHECK_THROWS_AS(draw_plot(one_point(std::numeric_limits<double>::quiet_NaN(), 1)), std::invalid_argument);
    CHECK_THROWS_AS(draw_plot(one_point(1, std::numeric_limits<double>::infinity())), std::invalid_argument);
    Plot empty = one_point(1, 1);
    empty.series[0].points.clear();
    CHECK_THROWS_AS(draw_plot(empty), std::invalid_argument);
}

TEST_CASE("A range of one point is widened to one that shows it") {
    Plot plot = one_point(7, 7);
    plot.x.from = plot.x.to = plot.y.from = plot.y.to = 0;
    CHECK(place_of(draw_plot(plot), kRed).pixels > 30);
}
