// Every level of SIMD, any number of threads, any size and strides against the scalar reference.
#include <catch2/catch.hpp>
#include <limits>

#include "dfield/threads.hpp"
#include "tests/screen/scenes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

constexpr dfield_simd kLevels[] = {DFIELD_SIMD_SSE4, DFIELD_SIMD_AVX2, DFIELD_SIMD_AVX512, DFIELD_SIMD_NEON};

struct Case {
    Picture picture;
    dfield_screen_desc desc;
};

std::vector<Case> cases() {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                    kInfinity = std::numeric_limits<float>::infinity();
    const std::uint32_t sizes[][2] = {{1, 1}, {2, 3}, {5, 70}, {64, 16}, {65, 17}, {131, 40}, {200, 9}};
    std::vector<Case> result;
    std::uint64_t seed = 0;
    for (const auto& [width, height] : sizes)
        for (int variant = 0; variant < 12; ++variant) {
            Random random(++seed);
            const dfield_screen_camera lens = perspective(0.9, 0.9 * height / width),
                                       lines = orthographic(1.2, 0.9);
            Case c;
            c.picture = variant % 3 == 0 ? height_field(width, height, variant % 2 ? lines : lens, seed)
                                         : take(room(), width, height, variant % 2 ? lines : lens);
            // Every other one the disk, each with all measures in turn.
            constexpr dfield_screen_estimator kPoints[] = {
                DFIELD_ESTIMATOR_SPHERE, DFIELD_ESTIMATOR_HEMISPHERE, DFIELD_ESTIMATOR_IMPORTANCE,
                DFIELD_ESTIMATOR_TANGENT, DFIELD_ESTIMATOR_MARCH};
            c.desc = desc_of(variant % 2 ? DFIELD_ESTIMATOR_DISK : kPoints[random.below(5)],
                             static_cast<float>(random.uniform(0.05, 1.5)));
            c.desc.measure = static_cast<std::uint32_t>(seed / 2 % 4);
            c.desc.sigma = static_cast<float>(std::pow(10, random.uniform(-2, 2)));
            c.desc.march_steps = 1 + random.below(12);
            c.desc.tangent_as_printed = random.below(2);
            c.desc.samples = 1 + random.below(40);
            c.desc.interleave = 1 + random.below(8);
            c.desc.filter = random.below(4) != 0;
            c.desc.sight = random.below(2);
            c.desc.weights = random.below(4) == 0;
            c.picture.with_normals = random.below(3) != 0;
            for (std::size_t i = 0; i < c.picture.size(); ++i) {
                if (random.below(20) == 0)
                    c.picture.depth[i] = std::array{kNan, kInfinity, 0.0f, -1.0f}[random.below(4)];
                if (random.below(30) == 0) c.picture.normals[3 * i] = kNan;
                if (random.below(30) == 0) c.picture.radiance[3 * i + 1] = kNan;
            }
            result.push_back(std::move(c));
        }
    return result;
}

}  // namespace

TEST_CASE("Every level of SIMD agrees with the reference", "[screen][levels]") {
    const Context scalar = context_of(DFIELD_SIMD_SCALAR);
    for (const Case& c : cases()) {
        const Shot reference = shade(c.picture, c.desc, scalar, true);
        for (const dfield_simd level : kLevels) {
            INFO(c.picture.width << "x" << c.picture.height << " level " << level << " estimator "
                                 << c.desc.estimator << " measure " << c.desc.measure << " interleave "
                                 << c.desc.interleave << " samples " << c.desc.samples << " radius "
                                 << c.desc.radius << " weights " << c.desc.weights << " sigma "
                                 << c.desc.sigma);
            const Shot shot = shade(c.picture, c.desc, context_of(level), true);
            float visibility = 0, indirect = 0;
            for (std::size_t i = 0; i < shot.visibility.size(); ++i) {
                REQUIRE(std::isfinite(shot.visibility[i]));
                // Without normalisation some pixels are far above 1.
                visibility = std::max(visibility, std::abs(shot.visibility[i] - reference.visibility[i]) /
                                                      std::max(1.0f, reference.visibility[i]));
            }
            for (std::size_t i = 0; i < shot.indirect.size(); ++i) {
                REQUIRE(std::isfinite(shot.indirect[i]));
                indirect = std::max(indirect, std::abs(shot.indirect[i] - reference.indirect[i]));
            }
            // The brightest radiance is about 1.
            CHECK(visibility < 1e-4f);
            CHECK(indirect < 1e-3f);
        }
    }
}

TEST_CASE("Results are the same at any number of threads", "[screen][levels]") {
    const Picture picture = take(room(), 131, 77, perspective(0.5, 0.3));
    for (const dfield_simd level : {DFIELD_SIMD_BEST, DFIELD_SIMD_SCALAR})
        for (const std::uint32_t estimator : {DFIELD_ESTIMATOR_DISK, DFIELD_ESTIMATOR_TANGENT}) {
            const dfield_screen_desc desc = desc_of(estimator, 0.5f);
            const Shot alone = shade(picture, desc, context_of(level), true);
            for (const unsigned count : {2u, 5u}) {
                Threads threads(count);
                dfield_context_desc how{};
                how.struct_size = sizeof how;
                how.simd = level;
                threads.install(how);
                const Shot together = shade(picture, desc, Context(&how), true);
                CHECK(together.visibility == alone.visibility);
                CHECK(together.indirect == alone.indirect);
            }
        }
}
