// Every estimator converges to the integral that it claims, and that integral is equation 2.
#include <catch2/catch.hpp>
#include <numbers>

#include "tests/screen/scenes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

constexpr std::uint32_t kEstimators[] = {DFIELD_ESTIMATOR_SPHERE,     DFIELD_ESTIMATOR_HEMISPHERE,
                                         DFIELD_ESTIMATOR_IMPORTANCE, DFIELD_ESTIMATOR_TANGENT,
                                         DFIELD_ESTIMATOR_DISK,       DFIELD_ESTIMATOR_MARCH};

std::vector<Picture> pictures() {
    const dfield_screen_camera lens = perspective(0.5, 0.375), lines = orthographic(1.2, 0.9);
    std::vector<Picture> result;
    for (const World& world : {open_plane(), corner(), step(), ball()}) {
        result.push_back(take(world, 12, 9, lens));
        result.push_back(take(world, 12, 9, lines));
    }
    result.push_back(height_field(12, 9, lens, 1));
    result.push_back(height_field(12, 9, lines, 2));
    return result;
}

std::vector<std::uint32_t> every(const Picture& picture, std::uint32_t step) {
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t i = 0; i < picture.size(); i += step) pixels.push_back(i);
    return pixels;
}

// Of one sample, measured with random ones: what a Monte Carlo estimate of n has, times sqrt(n).
std::vector<double> deviation(const Picture& picture, dfield_screen_desc desc, const Context& context) {
    constexpr int kTries = 64;
    desc.samples = 1;
    desc.weights = DFIELD_WEIGHTS_PLAIN;
    std::vector<double> sum(picture.size()), squares(picture.size());
    for (int i = 0; i < kTries; ++i) {
        desc.seed = static_cast<std::uint64_t>(1000 + i);
        const Shot shot = shade(picture, desc, context);
        for (std::size_t k = 0; k < picture.size(); ++k) {
            const auto value = static_cast<double>(shot.visibility[k]);
            sum[k] += value;
            squares[k] += value * value;
        }
    }
    for (std::size_t k = 0; k < picture.size(); ++k)
        squares[k] = std::sqrt(std::max(0.0, squares[k] - sum[k] * sum[k] / kTries) / (kTries - 1));
    return squares;
}

// Equation 2 on a grid of cubes, in doubles, with a look-up of its own: DFIELD_SIGHT_AXIS, orthographic or
// not.
double by_cubes(const Picture& picture, std::uint32_t pixel, double radius, bool quartic) {
    constexpr int kCells = 96;
    const std::uint32_t column = pixel % picture.width, row = pixel / picture.width;
    const auto depth = static_cast<double>(picture.depth[pixel]);
    const double scale = picture.camera.projection == DFIELD_PROJECTION_PERSPECTIVE ? depth : 1;
    const double to_columns = picture.width / (2 * static_cast<double>(picture.camera.half_width) * scale),
                 to_rows = picture.height / (2 * static_cast<double>(picture.camera.half_height) * scale);
    const glm::dvec3 n(static_cast<double>(picture.normals[3 * pixel]),
                       static_cast<double>(picture.normals[3 * pixel + 1]),
                       static_cast<double>(picture.normals[3 * pixel + 2]));
    double sum = 0;
    for (int k = 0; k < kCells * kCells * kCells; ++k) {
        const glm::dvec3 p =
            (2.0 * glm::dvec3(k % kCells, k / kCells % kCells, k / (kCells * kCells)) + 1.0) /
                static_cast<double>(kCells) -
            1.0;
        const double r2 = glm::dot(p, p), cosine = glm::dot(n, p);
        if (r2 > 1 || cosine <= 0) continue;
        const double x = std::floor(column + 0.5 + p.x * radius * to_columns),
                     y = std::floor(row + 0.5 - p.y * radius * to_rows);
        const bool outside = x < 0 || y < 0 || x >= picture.width || y >= picture.height;
        if (!outside &&
            depth - p.z * radius >=
                static_cast<double>(picture.depth[static_cast<std::size_t>(y * picture.width + x)]))
            continue;
        // mu'(r) / r^2 (N.w): 4 r or 2 / r, times cosine / r.
        sum += quartic ? 4 * cosine : 2 * cosine / r2;
    }
    return sum * std::pow(2.0 / kCells, 3) / std::numbers::pi;
}

}  // namespace

TEST_CASE("Estimators converge to what they claim", "[screen]") {
    const Context context;
    int index = 0;
    for (const Picture& picture : pictures()) {
        const std::vector<std::uint32_t> pixels = every(picture, 11);
        for (const std::uint32_t measure : {DFIELD_MEASURE_QUARTIC, DFIELD_MEASURE_QUADRATIC})
            for (const std::uint32_t estimator : kEstimators) {
                dfield_screen_desc desc = plain_desc(estimator, 0.7f, 4096);
                desc.measure = measure;
                desc.march_steps = 8;
                desc.weights = index++ % 2 == 0 ? DFIELD_WEIGHTS_RATIO : DFIELD_WEIGHTS_PLAIN;
                const std::vector<double> sigma = deviation(picture, desc, context);
                const Shot shot = shade(picture, desc, context), truth = integral(picture, desc, pixels);
                for (std::size_t i = 0; i < pixels.size(); ++i) {
                    const std::uint32_t at = pixels[i];
                    INFO("estimator " << estimator << " measure " << measure << " weights " << desc.weights
                                      << " pixel " << at);
                    const double error =
                        std::abs(static_cast<double>(shot.visibility[at] - truth.visibility[i]));
                    // The integral's own grid: 0.003.
                    CHECK(error <= 3 * sigma[at] / std::sqrt(4096.0) + 0.003);
                }
            }
    }
}

TEST_CASE("The integral is equation 2", "[screen]") {
    for (const bool flat : {false, true}) {
        const dfield_screen_camera camera = flat ? orthographic(1.2, 0.9) : perspective(0.5, 0.375);
        for (const World& world : {corner(), ball()}) {
            const Picture picture = take(world, 80, 60, camera);
            const std::vector<std::uint32_t> pixels = {80 * 31 + 43, 80 * 45 + 20, 80 * 50 + 70};
            for (const std::uint32_t measure : {DFIELD_MEASURE_QUARTIC, DFIELD_MEASURE_QUADRATIC})
                for (const std::uint32_t estimator : {DFIELD_ESTIMATOR_IMPORTANCE, DFIELD_ESTIMATOR_DISK}) {
                    dfield_screen_desc desc = desc_of(estimator, 0.7f);
                    desc.sight = DFIELD_SIGHT_AXIS;
                    desc.measure = measure;
                    const Shot shot = integral(picture, desc, pixels);
                    for (std::size_t i = 0; i < pixels.size(); ++i) {
                        INFO("flat " << flat << " measure " << measure << " estimator " << estimator
                                     << " pixel " << pixels[i]);
                        // DISK has its pipes at the pixels' centres.
                        CHECK(static_cast<double>(shot.visibility[i]) ==
                              Approx(by_cubes(picture, pixels[i], 0.7, measure == DFIELD_MEASURE_QUARTIC))
                                  .margin(estimator == DFIELD_ESTIMATOR_DISK ? 0.01 : 0.006));
                    }
                }
        }
    }
}

TEST_CASE("An open plane", "[screen]") {
    const Context context;
    const Picture picture = take(plane({0, 0, 1}, -3), 48, 36, perspective(0.5, 0.375));
    const auto middle = [&](const dfield_screen_desc& desc) {
        return shade(picture, desc, context).visibility[48 * 18 + 24];
    };
    for (const std::uint32_t estimator : kEstimators) {
        dfield_screen_desc desc = plain_desc(estimator, 0.5f, 16);
        INFO("estimator " << estimator);
        CHECK(middle(desc) == 1.0f);  // RATIO: without noise
        desc.weights = DFIELD_WEIGHTS_PLAIN;
        desc.samples = 1024;
        CHECK(middle(desc) == Approx(1).margin(0.01));
    }
    // 2 integral_0^1 mu(c) dc
    dfield_screen_desc desc = plain_desc(DFIELD_ESTIMATOR_TANGENT, 0.5f, 1024);
    desc.weights = DFIELD_WEIGHTS_PLAIN;
    desc.tangent_as_printed = 1;
    const auto printed = [&](std::uint32_t measure) {
        desc.measure = measure;
        return middle(desc);
    };
    CHECK(printed(DFIELD_MEASURE_QUARTIC) == Approx(0.4).margin(0.005));
    CHECK(printed(DFIELD_MEASURE_QUADRATIC) == Approx(2.0 / 3).margin(0.01));
}

TEST_CASE("The pipe through a pixel's own middle stands for the pixel", "[screen]") {
    // An open plane's O is 1 by each measure, but for what so few pipes make of it: R is five pixels.
    const Picture picture = take(plane({0, 0, 1}, -3), 41, 41, orthographic(2.05, 2.05));
    for (std::uint32_t measure = 0; measure <= DFIELD_MEASURE_EXPONENTIAL; ++measure) {
        dfield_screen_desc desc = plain_desc(DFIELD_ESTIMATOR_DISK, 0.5f, 16);
        desc.weights = DFIELD_WEIGHTS_PLAIN;
        desc.measure = measure;
        desc.sigma = 4;
        INFO("measure " << measure);
        CHECK(integral(picture, desc, {41 * 20 + 20}).visibility[0] == Approx(1).margin(0.06));
    }
}

TEST_CASE("Fuzzy measures", "[screen]") {
    dfield_screen_desc desc = screen_defaults();
    desc.radius = 2;
    desc.sigma = 1.5f;
    for (std::uint32_t measure = 0; measure <= DFIELD_MEASURE_EXPONENTIAL; ++measure) {
        desc.measure = measure;
        CHECK(dfield_screen_measure(&desc, 0) == 0);
        CHECK(dfield_screen_measure(&desc, 2) == 1);
        CHECK(dfield_screen_measure(&desc, 5) == 1);
        float last = 0;
        for (float r = 0.1f; r < 2; r += 0.1f) {
            CHECK(dfield_screen_measure(&desc, r) > last);
            last = dfield_screen_measure(&desc, r);
        }
    }
    CHECK(dfield_screen_measure(&desc, 1) == Approx((1 - std::exp(-1.5)) / (1 - std::exp(-3.0))));
    desc.measure = DFIELD_MEASURE_QUARTIC;
    CHECK(dfield_screen_measure(&desc, 1) == 1.0f / 16);
    CHECK(std::isnan(dfield_screen_measure(&desc, -1)));
    desc.measure = 9;
    CHECK(std::isnan(dfield_screen_measure(&desc, 1)));
    CHECK(std::isnan(dfield_screen_measure(nullptr, 1)));
}
