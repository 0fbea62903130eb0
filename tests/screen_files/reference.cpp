// Obscurance by rays against closed forms.
#include "baker/screen/ray_reference.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <set>

#include "tests/screen_files/scenes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

// 1 - O on the ground at a distance of q R from a wall: directions of the cosine-weighted hemisphere are
// uniform on the unit disk, a wall that a direction (x, y) of the disk meets lies at the distance q R / x.
double occlusion_by_wall(double q, const std::function<double(double)>& measure) {
    constexpr int kSteps = 200'000;
    if (q >= 1) return 0;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double x = q + (1 - q) * (i + 0.5) / kSteps;
        sum += 2 * std::sqrt(1 - x * x) * (1 - measure(q / x));
    }
    return sum * (1 - q) / kSteps / glm::pi<double>();
}

// The camera over the ground beside the wall, and a buffer of it.
struct Beside {
    ImportedScene imported = ground_and_wall(true);
    LitScene scene{imported};
    GBuffer buffer;

    Beside() {
        scene.set_sun({{1, 0, 0}, {1, 1, 1}});  // on the wall alone
        buffer = trace_gbuffer(scene, look_at({3, 6, 0}, {3, 0, 0}, {0, 0, -1}, 53, 1), 24, 24, {}, 2);
    }
};

}  // namespace

TEST_CASE("quartic: the integral has a closed form") {
    for (const double q : {0.05, 0.4, 0.9}) {
        const double s = std::sqrt(1 - q * q);
        const double exact = (std::acos(q) - q * s - 2.0 / 3 * q * s * s * s) / glm::pi<double>();
        CHECK(occlusion_by_wall(q, [](double r) { return r * r * r * r; }) == Approx(exact).epsilon(1e-4));
    }
}

TEST_CASE("the ground beside a wall, by rays") {
    const Beside beside;
    const std::vector<std::uint32_t> pixels = surface_pixels(beside.buffer, 60);
    REQUIRE(pixels.size() == 60);
    RayReferenceOptions options;
    options.rays = 2500;
    options.indirect = options.unbounded = true;
    for (const MeasureShape shape : {MeasureShape::kQuartic, MeasureShape::kQuadratic, MeasureShape::kLinear,
                                     MeasureShape::kExponential}) {
        options.measure = {shape, 4, 0.7};
        const RayReference reference = trace_reference(beside.scene, beside.buffer, pixels, options);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const ScreenPoint point = world_point(beside.buffer, pixels[i]);
            INFO(static_cast<int>(shape) << " at " << point.position.x);
            if (point.normal.y < 0.5f) continue;  // on the wall
            const double q = static_cast<double>(point.position.x) / 4;
            const double occlusion = occlusion_by_wall(q, [&](double r) { return options.measure(4 * r); });
            CHECK(1 - static_cast<double>(reference.visibility[i]) == Approx(occlusion).margin(0.004));
            // The wall reflects its albedo.
            CHECK(static_cast<double>(reference.indirect[i].x) == Approx(0.9 * occlusion).margin(0.004));
            CHECK(static_cast<double>(reference.indirect[i].y) == Approx(0.2 * occlusion).margin(0.002));
            // A wall of any height hides less than half of the sky, this one almost that.
            CHECK(static_cast<double>(reference.sky[i]) == Approx(0.5).margin(0.08));
        }
    }
}

TEST_CASE("an open plane is open; a radius of 0 and sky are too; threads do not matter") {
    const ImportedScene imported = ground_and_wall(false);
    const LitScene scene(imported);
    const GBuffer buffer =
        trace_gbuffer(scene, look_at({0, 2, 6}, {0, 2, 0}, {0, 1, 0}, 60, 1), 16, 16, {}, 1);
    std::vector<std::uint32_t> all(buffer.pixels());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    RayReferenceOptions options;
    options.rays = 64;
    CHECK(trace_reference(scene, buffer, all, options).visibility == std::vector<float>(all.size(), 1.0f));

    const Beside beside;
    options.measure.radius = 0;
    std::vector<std::uint32_t> some = surface_pixels(beside.buffer, 40);
    CHECK(trace_reference(beside.scene, beside.buffer, some, options).visibility ==
          std::vector<float>(some.size(), 1.0f));
    options.measure.radius = 100;
    options.threads = 1;
    const RayReference one = trace_reference(beside.scene, beside.buffer, some, options);
    options.threads = 3;
    CHECK(trace_reference(beside.scene, beside.buffer, some, options).visibility == one.visibility);
}

TEST_CASE("pixels for references: surfaces, once each, evenly") {
    GBuffer buffer;
    buffer.width = buffer.height = 64;
    buffer.depth.assign(buffer.pixels(), 1.0f);
    for (std::size_t i = 0; i < buffer.pixels(); i += 2) buffer.depth[i] = 0;
    const std::vector<std::uint32_t> some = surface_pixels(buffer, 256);
    CHECK(some.size() == 256);
    CHECK(std::set<std::uint32_t>(some.begin(), some.end()).size() == 256);
    std::array<int, 16> sets{};
    for (const std::uint32_t pixel : some) {
        REQUIRE(pixel % 2 == 1);
        ++sets[pixel % 4 + 4 * (pixel / 64 % 4)];
    }
    for (std::size_t i = 0; i < sets.size(); ++i) CHECK(sets[i] >= (i % 2 ? 16 : 0));
    CHECK(surface_pixels(buffer, 1 << 20).size() == buffer.pixels() / 2);
}
