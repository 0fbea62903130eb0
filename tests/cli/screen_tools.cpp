// What `dfield screen` is made of, from within.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "baker/cli/screen_far.hpp"
#include "baker/cli/screen_options.hpp"
#include "baker/cli/screen_picture.hpp"

using namespace dfield;
using namespace dfield::cli;

TEST_CASE("rays and screen space have the same measure") {
    for (const dfield_fuzzy_measure measure : {DFIELD_MEASURE_QUARTIC, DFIELD_MEASURE_QUADRATIC,
                                               DFIELD_MEASURE_LINEAR, DFIELD_MEASURE_EXPONENTIAL}) {
        INFO(name_of(measure));
        dfield_screen_desc desc;
        dfield_screen_desc_init(&desc);
        desc.measure = measure;
        desc.radius = 2.5f;
        desc.sigma = 0.8f;
        const FuzzyMeasure by_rays = measure_of(desc);
        for (const float r : {0.0f, 0.1f, 0.9f, 2.0f, 2.49f, 2.5f, 7.0f})
            CHECK(static_cast<double>(dfield_screen_measure(&desc, r)) ==
                  Approx(by_rays(static_cast<double>(r))).margin(1e-6));
        CHECK(by_rays(0) == 0);
        CHECK(by_rays(2.5) == 1);
    }
}

TEST_CASE("near and far occluders: once each, never below 0") {
    // One occluder over half of the hemisphere, at a distance where mu is 0.25: 0.75 of it is near.
    CHECK(combined({1 - 0.5f * 0.75f}, {1 - 0.5f * 0.25f})[0] == Approx(0.5));
    CHECK(combined({0.25f}, {0.5f})[0] == 0);
    CHECK(combined({1.0f}, {1.0f})[0] == 1);
}

TEST_CASE("pictures of a frame") {
    GBuffer buffer;
    buffer.width = 2;
    buffer.height = 1;
    buffer.depth = {1, std::numeric_limits<float>::infinity()};
    buffer.albedo = {{0.5f, 1, 1}, {}};
    buffer.radiance = {{0.1f, 0.2f, NAN}, {}};
    ScreenShading shading;
    shading.visibility = {0.5f, 1};
    shading.indirect = {{0.2f, 0.1f, 0}, {}};
    const ScreenLight light{{0.4f, 0.4f, 0.4f}, {0, 0, 1}};
    const auto first = [&](const char* what) {
        const Image image = screen_picture(what, buffer, shading, light);
        return std::array<std::uint8_t, 3>{image.rgb[0], image.rgb[1], image.rgb[2]};
    };
    CHECK(int{first("visibility")[0]} == 128);
    CHECK(int{first("indirect")[0]} == 51);
    CHECK(int{first("classic")[0]} == std::lround(255 * 0.3));
    CHECK(int{first("ambient")[0]} == 51);
    CHECK(int{first("lit")[1]} == std::lround(255 * 0.5));
    CHECK(int{first("lit")[2]} == 0);  // NaN
    CHECK(int{screen_picture("lit", buffer, shading, light).at(1, 0)[2]} == 255);
    CHECK(int{screen_picture("visibility", buffer, shading, light).at(1, 0)[0]} == 255);
}
