#include "bench/cutting/ray_sets.hpp"

#include <cmath>
#include <dfield/dfield.hpp>

namespace dfield::cutting {
namespace {

// Solid angle of the rectangle [0, x] x [0, y] at distance 1 from the eye, with signs.
double solid_angle(double x, double y) {
    return std::atan(x * y / std::sqrt(1 + x * x + y * y));
}

}  // namespace

cli::LocalOptions options_of(const Scene& scene, std::uint32_t rays) {
    cli::LocalOptions options;
    options.rays = rays;
    options.samples = scene.samples;
    return options;
}

double rms(std::span<const float> a, std::span<const float> b) {
    double squares = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double miss = static_cast<double>(a[i]) - static_cast<double>(b[i]);
        squares += miss * miss;
    }
    return std::sqrt(squares / static_cast<double>(a.size()));
}

std::vector<float> better_weights(std::uint32_t rays) {
    dfield_local_desc desc = local_defaults();
    desc.ray_count = rays;
    std::vector<float> directions(3 * std::size_t{rays}), weights;
    check(dfield_local_get_directions(&desc, directions.data()));
    for (std::size_t k = 0; k < rays; ++k) {
        const float* const d = &directions[3 * k];
        const double least = 1e-3;
        const int axes = (std::abs(d[0]) > least) + (std::abs(d[1]) > least) + (std::abs(d[2]) > least);
        double weight = 1;
        if (rays == 14) weight = 14 * (axes == 1 ? 1.0 / 15 : 3.0 / 40);  // V. Lebedev 1976: degree 5
        if (rays == 26)                                                   // degree 7
            weight = 26 * (axes == 1 ? 1.0 / 21 : axes == 2 ? 4.0 / 105 : 9.0 / 280);
        if (rays == 54) {
            constexpr double kEdge = 1.0 / 3;
            const double middle = 4 * solid_angle(kEdge, kEdge),
                         side = 2 * (solid_angle(1, kEdge) - solid_angle(kEdge, kEdge)),
                         corner = solid_angle(1, 1) - 2 * solid_angle(1, kEdge) + solid_angle(kEdge, kEdge);
            const double angle = axes == 1 ? middle : axes == 2 ? side : corner;
            weight = 54 * angle / (4 * std::acos(-1.0));
        }
        weights.push_back(static_cast<float>(weight));
    }
    return weights;
}

}  // namespace dfield::cutting
