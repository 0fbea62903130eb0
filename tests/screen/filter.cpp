// What the filter averages, and the sets of samples that it averages over.
#include <array>
#include <catch2/catch.hpp>
#include <set>

#include "screen/samples.hpp"
#include "tests/screen/scenes.hpp"

using namespace dfield;
using namespace dfield::test;
using runtime::screen::block_of;
using runtime::screen::sobol_point;

namespace {

// Without light, by the words of screen.h, from what is left without the filter. Orthographic, so that depths
// of a plane are linear in the pixel.
double filtered(const Picture& picture, const dfield_screen_desc& desc, const std::vector<float>& raw,
                std::int32_t column, std::int32_t row) {
    const auto width = static_cast<std::int32_t>(picture.width),
               height = static_cast<std::int32_t>(picture.height);
    const auto at = [&](std::int32_t x, std::int32_t y) { return static_cast<std::size_t>(y * width + x); };
    const std::size_t here = at(column, row);
    const float* const n = &picture.normals[3 * here];
    const double step_x = 2 * static_cast<double>(picture.camera.half_width) / width,
                 step_y = 2 * static_cast<double>(picture.camera.half_height) / height;
    const auto side = static_cast<std::int32_t>(desc.interleave);
    double sum = 0, total = 0;
    for (std::int32_t y = -side / 2; y <= side / 2; ++y)
        for (std::int32_t x = -side / 2; x <= side / 2; ++x) {
            if (column + x < 0 || column + x >= width || row + y < 0 || row + y >= height) continue;
            const std::size_t there = at(column + x, row + y);
            if (!(picture.depth[there] < 1e30f)) continue;
            const double right = x * step_x, up = -y * step_y;
            const double rise = -(static_cast<double>(n[0]) * right + static_cast<double>(n[1]) * up) /
                                static_cast<double>(n[2]);
            const double off = static_cast<double>(picture.depth[here] - picture.depth[there]) - rise;
            if (std::abs(off) > static_cast<double>(desc.filter_limit * desc.radius)) continue;
            const auto weight = [&](std::int32_t by) { return 2 * std::abs(by) == side ? 0.5 : 1.0; };
            sum += weight(x) * weight(y) * static_cast<double>(raw[there]);
            total += weight(x) * weight(y);
        }
    return sum / total;
}

}  // namespace

TEST_CASE("The filter is the mean over the sets around a pixel that lie in its tangent plane",
          "[screen][filter]") {
    Picture picture = take(room(), 90, 60, orthographic(1.2, 0.8));
    for (std::size_t i = 0; i < picture.size(); i += 37)
        picture.depth[i] = std::numeric_limits<float>::infinity();
    for (const dfield_simd level : {DFIELD_SIMD_BEST, DFIELD_SIMD_SCALAR})
        for (std::uint32_t side = 2; side <= 8; ++side) {
            // A limit above what rounding makes of a plane, and below a pixel's way on a slanted one.
            dfield_screen_desc desc = plain_desc(DFIELD_ESTIMATOR_DISK, 0.4f, 4);
            desc.interleave = side;
            desc.filter_limit = 0.01f;
            desc.filter = 0;
            const Shot raw = shade(picture, desc, context_of(level));
            desc.filter = 1;
            const Shot shot = shade(picture, desc, context_of(level));
            std::size_t different = 0, changed = 0;
            for (std::int32_t row = 0; row < 60; ++row)
                for (std::int32_t column = 0; column < 90; ++column) {
                    const auto i = static_cast<std::size_t>(row * 90 + column);
                    if (!(picture.depth[i] < 1e30f)) continue;
                    const double expected = filtered(picture, desc, raw.visibility, column, row);
                    different += std::abs(static_cast<double>(shot.visibility[i]) - expected) > 1e-4;
                    changed += std::abs(shot.visibility[i] - raw.visibility[i]) > 0.01f;
                }
            INFO("level " << level << " side " << side);
            CHECK(different <= 3);  // depths that lie at the limit
            CHECK(changed > picture.size() / 3);
        }
}

TEST_CASE("Sets of samples are nets, and so are those of neighbours together", "[screen][filter]") {
    constexpr std::uint32_t kSide = 4, kCount = 16;
    // A power of two of points: one in every rectangle of sides 2^-i and 2^(i - k), one in every slice of
    // the third coordinate.
    const auto check_net = [](const std::vector<std::array<float, 3>>& points) {
        const auto count = static_cast<std::uint32_t>(points.size());
        for (std::uint32_t columns = 1; columns <= count; columns *= 2) {
            std::set<std::pair<std::uint32_t, std::uint32_t>> taken;
            for (const auto& point : points)
                taken.emplace(static_cast<std::uint32_t>(point[0] * static_cast<float>(columns)),
                              static_cast<std::uint32_t>(point[1] * static_cast<float>(count / columns)));
            CHECK(taken.size() == count);
        }
        std::set<std::uint32_t> slices;
        for (const auto& point : points)
            slices.insert(static_cast<std::uint32_t>(point[2] * static_cast<float>(count)));
        CHECK(slices.size() == count);
    };
    for (const std::uint64_t seed : {0u, 1u, 77u})
        for (std::uint32_t size = 1; size <= kSide; size *= 2)
            for (std::uint32_t y = 0; y < kSide; y += size)
                for (std::uint32_t x = 0; x < kSide; x += size) {
                    std::vector<std::array<float, 3>> points;
                    for (std::uint32_t i = 0; i < size * size; ++i)
                        for (std::uint32_t k = 0; k < kCount; ++k)
                            points.push_back(
                                sobol_point(block_of(x + i % size, y + i / size, kSide) * kCount + k, seed));
                    INFO("seed " << seed << " squares of " << size << " at " << x << ", " << y);
                    check_net(points);
                }
    for (std::uint32_t side = 1; side <= 8; ++side) {  // each block once
        std::set<std::uint32_t> blocks;
        for (std::uint32_t i = 0; i < side * side; ++i) blocks.insert(block_of(i % side, i / side, side));
        CHECK(blocks.size() == side * side);
        CHECK(*blocks.rbegin() == side * side - 1);
    }
}
