// Indirect and reflected light by the words of screen.h.
#include <catch2/catch.hpp>

#include "tests/screen/scenes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

constexpr std::uint32_t kLast = DFIELD_ESTIMATOR_MARCH;
constexpr dfield_simd kBoth[] = {DFIELD_SIMD_BEST, DFIELD_SIMD_SCALAR};

// Squares of colours, so that it matters which surfaces count how much.
Picture coloured(Picture picture) {
    constexpr std::uint32_t kSide = 5;
    for (std::uint32_t i = 0; i < picture.size(); ++i) {
        Random random(i % picture.width / kSide + 1000 * (i / picture.width / kSide));
        for (std::size_t k = 0; k < 3; ++k)
            picture.radiance[3 * i + k] = static_cast<float>(std::pow(random.uniform(0, 1), 4));
    }
    return picture;
}

// L~ of the disk's samples at a pixel, orthographic: the mean over all pixels within R by 1 - (r/R)^4 and the
// two tests, each with a darkness of 1e-4; `ratio`: by the density of the samples too, 1 - (distance / R)^2.
glm::dvec3 radiance_around(const Picture& picture, std::size_t pixel, double radius, bool ratio) {
    const auto vector = [&](const std::vector<float>& from, std::size_t i) {
        return glm::dvec3(static_cast<double>(from[3 * i]), static_cast<double>(from[3 * i + 1]),
                          static_cast<double>(from[3 * i + 2]));
    };
    const double step = 2 * static_cast<double>(picture.camera.half_width) / picture.width;
    const auto column = static_cast<double>(pixel % picture.width),
               row = static_cast<double>(pixel / picture.width);
    glm::dvec3 sum(0);
    double total = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const glm::dvec3 to(step * (static_cast<double>(i % picture.width) - column) / radius,
                            step * (row - static_cast<double>(i / picture.width)) / radius,
                            static_cast<double>(picture.depth[pixel] - picture.depth[i]) / radius);
        const double q2 = to.x * to.x + to.y * to.y, r2 = glm::dot(to, to);
        if (q2 > 1) continue;
        const double density = ratio ? 1 - q2 : 1;
        const double ahead = std::clamp(16 * glm::dot(vector(picture.normals, pixel), to), 0.0, 1.0),
                     turned = std::clamp(-16 * glm::dot(vector(picture.normals, i), to), 0.0, 1.0);
        const double weight = r2 < 1 ? (1 - r2 * r2) * ahead * turned : 0;
        sum += density * weight * vector(picture.radiance, i);
        total += density * (weight + 1e-4);
    }
    return sum / total;
}

// Pixels with more visibility have little light, and what is measured of it is rounding.
constexpr float kOpen = 0.98f;

// L~ = I / (1 - O).
glm::dvec3 radiance_in(const Shot& shot, std::size_t i) {
    const auto hidden = static_cast<double>(1 - shot.visibility[i]);
    return glm::dvec3(static_cast<double>(shot.indirect[3 * i]),
                      static_cast<double>(shot.indirect[3 * i + 1]),
                      static_cast<double>(shot.indirect[3 * i + 2])) /
           hidden;
}

}  // namespace

TEST_CASE("Indirect light of the disk is that of all pixels around", "[screen][light]") {
    std::vector<std::uint32_t> pixels;  // R is 16 pixels, a size that patterns have, and within the picture
    for (std::uint32_t row = 17; row < 79; row += 9)
        for (std::uint32_t column = 17; column < 111; column += 7) pixels.push_back(128 * row + column);
    // In a flat valley surfaces are hardly turned towards each other.
    const World valley = nearest({plane({0.5, 0, 1}, -3), plane({-0.5, 0, 1}, -3)});
    for (const World& world : {room(), valley})
        for (const dfield_screen_weights weights : {DFIELD_WEIGHTS_RATIO, DFIELD_WEIGHTS_PLAIN}) {
            const Picture picture = coloured(take(world, 128, 96, orthographic(2, 1.5)));
            dfield_screen_desc desc = plain_desc(DFIELD_ESTIMATOR_DISK, 0.5f, 2048);
            desc.weights = static_cast<std::uint32_t>(weights);
            const Shot truth = integral(picture, desc, pixels, true);
            const Shot shot = shade(picture, desc, Context(), true);
            double squares = 0;
            std::size_t count = 0;
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                if (truth.visibility[i] > kOpen) continue;
                ++count;
                const glm::dvec3 expected =
                    radiance_around(picture, pixels[i], 0.5, weights == DFIELD_WEIGHTS_RATIO);
                INFO("weights " << weights << " pixel " << pixels[i]);
                CHECK(glm::length(radiance_in(truth, i) - expected) < 0.001);
                const glm::dvec3 off = radiance_in(shot, pixels[i]) - expected;
                squares += glm::dot(off, off) / 3;
            }
            CHECK(count > 10);
            CHECK(std::sqrt(squares / static_cast<double>(count)) < 0.012);
        }
}

TEST_CASE("Indirect light converges to its integral", "[screen][light]") {
    const Context context;
    for (const bool flat : {false, true}) {
        const Picture picture =
            coloured(take(room(), 48, 36, flat ? orthographic(1.2, 0.9) : perspective(0.5, 0.375)));
        std::vector<std::uint32_t> pixels;
        for (std::uint32_t i = 0; i < picture.size(); i += 31) pixels.push_back(i);
        for (std::uint32_t estimator = 0; estimator <= kLast; ++estimator) {
            dfield_screen_desc desc = plain_desc(estimator, 0.6f, 4096);
            desc.march_steps = 8;
            const Shot shot = shade(picture, desc, context, true),
                       truth = integral(picture, desc, pixels, true);
            double squares = 0;
            std::size_t count = 0;
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                if (truth.visibility[i] > kOpen) continue;
                ++count;
                const glm::dvec3 off = radiance_in(shot, pixels[i]) - radiance_in(truth, i);
                squares += glm::dot(off, off) / 3;
            }
            INFO("flat " << flat << " estimator " << estimator);
            CHECK(count > 10);
            CHECK(std::sqrt(squares / static_cast<double>(count)) < 0.012);
        }
    }
}

TEST_CASE("What is turned away gives no light", "[screen][light]") {
    // The box's front looks where the wall looks.
    const Picture picture = take(step(), 48, 36, perspective(0.5, 0.375));
    for (const dfield_simd level : kBoth)
        for (std::uint32_t estimator = 0; estimator <= kLast; ++estimator) {
            const Shot shot = shade(picture, desc_of(estimator, 0.9f), context_of(level), true);
            CHECK(*std::min_element(shot.visibility.begin(), shot.visibility.end()) < 0.9f);
            for (const float light : shot.indirect) CHECK(light == 0);
        }
}

TEST_CASE("Reflected light is a (La O + I), of nothing where there is sky", "[screen][light]") {
    Picture picture = take(room(), 40, 30, perspective(0.5, 0.375));
    for (std::size_t i = 0; i < picture.size(); i += 7) picture.depth[i] = 0;
    std::vector<float> albedo(3 * picture.size()), visibility(picture.size()), indirect(3 * picture.size()),
        reflected(3 * picture.size());
    for (std::size_t i = 0; i < albedo.size(); ++i) albedo[i] = static_cast<float>(i % 11) / 10;
    dfield_screen_desc desc = desc_of(DFIELD_ESTIMATOR_DISK, 0.5f);
    const float ambient[3] = {0.5f, 2, 3};
    std::copy_n(ambient, 3, desc.ambient);
    for (const bool lit : {false, true})
        for (const bool coloured : {false, true}) {
            dfield_screen_buffers buffers = picture.buffers();
            if (!lit) buffers.radiance.data = nullptr;
            if (coloured) buffers.albedo.data = albedo.data();
            dfield_screen_outputs outputs = no_screen_outputs();
            outputs.visibility.data = visibility.data();
            outputs.indirect.data = lit ? indirect.data() : nullptr;
            outputs.reflected.data = reflected.data();
            Screen(Context(), desc).shade(buffers, outputs);
            for (std::size_t i = 0; i < picture.size(); ++i)
                for (std::size_t k = 0; k < 3; ++k) {
                    const float light = ambient[k] * visibility[i] + (lit ? indirect[3 * i + k] : 0);
                    const float expected = i % 7 == 0 ? 0 : (coloured ? albedo[3 * i + k] : 1) * light;
                    CHECK(reflected[3 * i + k] == Approx(expected).margin(1e-6));
                }
        }
}
