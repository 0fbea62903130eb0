// What is defined where there is nothing, little or too much to see.
#include <catch2/catch.hpp>
#include <limits>

#include "tests/screen/scenes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInfinity = std::numeric_limits<float>::infinity();
constexpr dfield_simd kBoth[] = {DFIELD_SIMD_BEST, DFIELD_SIMD_SCALAR};
constexpr std::uint32_t kLast = DFIELD_ESTIMATOR_MARCH;

const dfield_screen_camera kLens = perspective(0.5, 0.375);

// A depth of the device that stands for a distance.
float device_depth(double distance, double near, double far, bool perspective) {
    const auto end = [&](double plane) { return perspective ? 1 / plane : plane; };
    return static_cast<float>((end(distance) - end(near)) / (end(far) - end(near)));
}

}  // namespace

TEST_CASE("Sky is open, gives no light and hides nothing", "[screen][edges]") {
    for (const dfield_simd level : kBoth)
        for (std::uint32_t estimator = 0; estimator <= kLast; ++estimator) {
            Picture picture = take(plane({0, 0, 1}, -3), 24, 18, kLens);
            const float skies[] = {kNan, kInfinity, 0, -1, -kInfinity};
            for (std::size_t i = 0; i < picture.size(); i += 2) picture.depth[i] = skies[i / 2 % 5];
            const Shot shot = shade(picture, desc_of(estimator, 0.4f), context_of(level), true);
            // What is not sky is an open plane.
            for (const float visibility : shot.visibility) CHECK(visibility == 1.0f);
            for (const float light : shot.indirect) CHECK(light == 0.0f);
            const Shot truth = integral(picture, desc_of(estimator, 0.4f), {0, 1, 2, 3}, true);
            for (const float visibility : truth.visibility) CHECK(visibility == 1.0f);
        }
}

TEST_CASE("A neighbourhood of no size is open, and so is one within a pixel", "[screen][edges]") {
    for (const dfield_simd level : kBoth)
        for (std::uint32_t estimator = 0; estimator <= kLast; ++estimator)
            for (const float radius : {0.0f, 1e-18f, 1e-3f}) {
                const Picture picture = take(room(), 24, 18, kLens);
                const Shot shot = shade(picture, desc_of(estimator, radius), context_of(level), true);
                for (const float visibility : shot.visibility) CHECK(visibility == 1.0f);
                for (const float light : shot.indirect) CHECK(light == 0.0f);
            }
}

TEST_CASE("A neighbourhood of the whole scene, or far more", "[screen][edges]") {
    for (const dfield_simd level : kBoth)
        for (std::uint32_t estimator = 0; estimator <= kLast; ++estimator) {
            const Picture picture = take(room(), 24, 18, kLens);
            const Shot near = shade(picture, desc_of(estimator, 2), context_of(level), true);
            const Shot all = shade(picture, desc_of(estimator, 1e18f), context_of(level), true);
            float lowest = 1;
            for (std::size_t i = 0; i < picture.size(); ++i) {
                CHECK((near.visibility[i] >= 0 && near.visibility[i] <= 1));
                CHECK((all.visibility[i] >= 0 && all.visibility[i] <= 1));
                lowest = std::min(lowest, near.visibility[i]);
            }
            CHECK(lowest < 0.9f);
        }
}

TEST_CASE("Neighbourhoods far wider than the picture, and pixels that are far from square",
          "[screen][edges]") {
    for (const double half_height : {0.375, 1e-6, 1e6})
        for (const std::uint32_t interleave : {1u, 4u})
            for (std::uint32_t estimator = 0; estimator <= kLast; ++estimator) {
                Picture picture = take(room(), 300, 200, kLens);
                picture.camera.half_height = static_cast<float>(half_height);
                dfield_screen_desc desc = desc_of(estimator, 1e6f);
                desc.interleave = interleave;
                desc.samples = 4;
                const Shot best = shade(picture, desc, Context()),
                           scalar = shade(picture, desc, context_of(DFIELD_SIMD_SCALAR));
                float most = 0;
                for (std::size_t i = 0; i < picture.size(); ++i)
                    most = std::max(most, std::abs(best.visibility[i] - scalar.visibility[i]));
                CHECK(most < 1e-4f);
            }
}

TEST_CASE("Cameras at the ends of floats do no harm", "[screen][edges]") {
    constexpr float kTiny = std::numeric_limits<float>::denorm_min(),
                    kHuge = std::numeric_limits<float>::max();
    for (const dfield_simd level : kBoth)
        for (std::uint32_t estimator = 0; estimator <= kLast; ++estimator)
            for (const float extent : {kTiny, kHuge})
                for (const float depth : {kTiny, kHuge})
                    for (const float radius : {1e-18f, 1e18f}) {
                        Picture picture = take(room(), 20, 10, kLens);
                        picture.camera.half_width = extent;
                        for (std::size_t i = 0; i < picture.size(); i += 3) picture.depth[i] = depth;
                        dfield_screen_desc desc = desc_of(estimator, radius);
                        desc.samples = 4;
                        for (const float visibility :
                             shade(picture, desc, context_of(level), true).visibility)
                            CHECK((visibility >= 0 && visibility <= 1));
                    }
}

TEST_CASE("Beyond the picture all is open", "[screen][edges]") {
    // A wall that rises out of the picture on the right: a ridge seen in full hides more than one cut off.
    const World world = nearest({plane({0, 0, 1}, -4), plane({-1, 0, 0.2}, -0.98)});
    const dfield_screen_camera wide = perspective(0.75, 0.375);
    dfield_screen_camera cut = perspective(0.375, 0.375);
    cut.offset_x = -0.375f;  // the left half of it
    for (const dfield_simd level : kBoth) {
        dfield_screen_desc desc = plain_desc(DFIELD_ESTIMATOR_DISK, 0.8f, 64);
        const Shot whole = shade(take(world, 60, 30, wide), desc, context_of(level));
        float most = 0;
        const Shot half = shade(take(world, 30, 30, cut), desc, context_of(level));
        for (std::uint32_t row = 0; row < 30; ++row)
            for (std::uint32_t column = 0; column < 30; ++column) {
                const float a = whole.visibility[60 * row + column], b = half.visibility[30 * row + column];
                CHECK(b >= a - 1e-5f);
                most = std::max(most, b - a);
                if (column < 10) CHECK(b == Approx(a).margin(1e-4));  // R is about 9 pixels
            }
        CHECK(most > 0.05f);
    }
}

TEST_CASE("Normals that look away, that are missing and that are not unit", "[screen][edges]") {
    const Context context;
    Picture picture = take(corner(), 40, 30, kLens);
    const dfield_screen_desc desc = desc_of(DFIELD_ESTIMATOR_DISK, 0.5f);
    const Shot given = shade(picture, desc, context);
    Picture scaled = picture;
    for (float& n : scaled.normals) n *= 7;
    const Shot same = shade(scaled, desc, context);
    for (std::size_t i = 0; i < picture.size(); ++i)
        CHECK(same.visibility[i] == Approx(given.visibility[i]).margin(1e-5));
    // Derived ones are those of the planes, but on the edges between them.
    Picture without = picture;
    without.with_normals = false;
    const Shot derived = shade(without, desc, context);
    std::vector<float> normals(3 * picture.size());
    dfield_screen_target target{};
    target.data = normals.data();
    const dfield_screen_buffers buffers = without.buffers();
    REQUIRE(dfield_screen_normals(context.get(), &buffers, &target) == DFIELD_OK);
    std::size_t wrong = 0, different = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
        float cosine = 0;
        for (std::size_t k = 0; k < 3; ++k) cosine += normals[3 * i + k] * picture.normals[3 * i + k];
        wrong += cosine < 0.999f;
        different += std::abs(derived.visibility[i] - given.visibility[i]) > 0.02f;
    }
    CHECK(wrong < picture.size() / 15);
    CHECK(different < picture.size() / 20);
    // Away from the viewer, and of no use at all.
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const float strange[4][3] = {{0, 0, -1}, {kNan, 0, 1}, {0, 0, 0}, {kInfinity, 0, 0}};
        std::copy_n(strange[i % 4], 3, picture.normals.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
    for (const dfield_simd level : kBoth)
        for (std::uint32_t estimator = 0; estimator <= kLast; ++estimator)
            for (const float visibility :
                 shade(picture, desc_of(estimator, 0.5f), context_of(level)).visibility)
                CHECK((visibility >= 0 && visibility <= 1));
}

TEST_CASE("A single pixel", "[screen][edges]") {
    for (const dfield_simd level : kBoth)
        for (const bool with_normals : {false, true}) {
            Picture picture = take(plane({0, 0, 1}, -3), 1, 1, kLens);
            picture.with_normals = with_normals;
            CHECK(shade(picture, desc_of(DFIELD_ESTIMATOR_DISK, 2), context_of(level)).visibility[0] == 1.0f);
        }
}

TEST_CASE("Depths of the device, reversed or not, are those in world units", "[screen][edges]") {
    const Context context;
    for (const bool lens : {true, false}) {
        const Picture picture = take(room(), 40, 30, lens ? kLens : orthographic(1.2, 0.9));
        const dfield_screen_desc desc = desc_of(DFIELD_ESTIMATOR_DISK, 0.5f);
        const Shot truth = shade(picture, desc, context);
        std::vector<std::array<double, 2>> planes = {{0.5, 20}, {20, 0.5}};
        if (lens) {
            planes.push_back({0.5, std::numeric_limits<double>::infinity()});
            planes.push_back({std::numeric_limits<double>::infinity(), 0.5});
        }
        for (const auto& [near, far] : planes) {
            Picture device = picture;
            device.camera.near_plane = static_cast<float>(near);
            device.camera.far_plane = static_cast<float>(far);
            for (float& depth : device.depth)
                depth = device_depth(static_cast<double>(depth), near, far, lens);
            device.depth[5] = near < far ? 1.0f : 0.0f;  // sky
            device.depth[6] = 2;
            dfield_screen_buffers buffers = device.buffers();
            buffers.depth_encoding = DFIELD_DEPTH_DEVICE;
            std::vector<float> visibility(picture.size());
            dfield_screen_outputs outputs = no_screen_outputs();
            outputs.visibility.data = visibility.data();
            Screen(context, desc).shade(buffers, outputs);
            CHECK(visibility[5] == 1.0f);
            CHECK(visibility[6] == 1.0f);
            for (std::size_t i = 10 * 40; i < picture.size(); ++i)  // far from these two
                CHECK(visibility[i] == Approx(truth.visibility[i]).margin(2e-3));
        }
    }
}

TEST_CASE("Strides, also upwards, read and write the same picture", "[screen][edges]") {
    const Picture picture = take(room(), 37, 21, kLens);
    const std::size_t width = 37, height = 21, row = 7 * width + 3;
    for (const dfield_simd level : kBoth) {
        const dfield_screen_desc desc = desc_of(DFIELD_ESTIMATOR_DISK, 0.5f);
        const Context context = context_of(level);
        const Shot truth = shade(picture, desc, context, true);
        // Depth, normal and radiance of a pixel next to each other, the picture's last row first.
        std::vector<float> all(row * height, -7.0f), out(5 * width * height, -7.0f);
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                float* const to = &all[(height - 1 - y) * row + 7 * x];
                const std::size_t i = y * width + x;
                to[0] = picture.depth[i];
                std::copy_n(&picture.normals[3 * i], 3, to + 1);
                std::copy_n(&picture.radiance[3 * i], 3, to + 4);
            }
        float* const top = &all[(height - 1) * row];
        const auto up = -static_cast<std::ptrdiff_t>(4 * row);
        dfield_screen_buffers buffers = picture.buffers();
        buffers.depth = {top, 28, up};
        buffers.normals = {top + 1, 28, up};
        buffers.radiance = {top + 4, 28, up};
        dfield_screen_outputs outputs = no_screen_outputs();
        outputs.visibility = {&out[5 * width * (height - 1)], 20, -static_cast<std::ptrdiff_t>(20 * width)};
        outputs.indirect = {outputs.visibility.data + 1, 20, -static_cast<std::ptrdiff_t>(20 * width)};
        Screen(context, desc).shade(buffers, outputs);
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                const float* const from = &out[5 * (width * (height - 1 - y) + x)];
                CHECK(from[0] == truth.visibility[y * width + x]);
                CHECK(std::equal(from + 1, from + 4, &truth.indirect[3 * (y * width + x)]));
                CHECK(from[4] == -7.0f);  // nobody's
            }
    }
}
