// Equations 2 and 3 as they stand, every sample taken: what the vectorised form is held against, and what
// contexts capped at DFIELD_SIMD_SCALAR run. Approximate rays by what their steps say.
#include <cmath>

#include "volume/local_air.hpp"

namespace dfield::runtime::volume {
namespace {

float factor_at(const LocalJob& job, std::size_t x, std::size_t y, std::size_t z) {
    const LocalRays& rays = *job.plan->rays;
    const auto samples = static_cast<float>(rays.samples);
    const auto at = [&](const RayStep& step) {
        return opacity_at(*job.opacity, static_cast<std::ptrdiff_t>(x) + step.offset[0],
                          static_cast<std::ptrdiff_t>(y) + step.offset[1],
                          static_cast<std::ptrdiff_t>(z) + step.offset[2], step.fraction.data());
    };
    const std::size_t ones = rays.groups.ones, twos = ones + rays.groups.twos;
    float factor = 0;
    for (std::size_t k = 0; k < rays.count; ++k) {
        if (rays.approximate) {
            float lost = 0, light = 1;
            for (std::size_t i = 0; i < rays.per_ray; ++i) {
                const RayStep& step = rays.ray(k)[i];
                const float clear = 1 - at(step),
                            pass = i < ones ? clear : std::pow(clear, i < twos ? 2.0f : 4.0f);
                lost += light * (1 - pass) * (step.weight - step.slope * pass);
                light *= pass;
                if ((i + 1) % kNearlyCheck == 0 && i + 1 < rays.per_ray && light < kNearlyOpaque) {
                    lost += light * rays.ray(k)[i + 1].weight;
                    break;
                }
            }
            factor += rays.weights[k] - lost;
            continue;
        }
        float sum = 1, product = 1;  // equation 2 for m = 1
        for (const RayStep& step : rays.ray(k)) {
            product *= 1 - at(step);
            sum += product;
        }
        factor += rays.weights[k] * (sum / samples);  // equation 3
    }
    return factor;
}

}  // namespace

void local_reference(const LocalJob& job, const Tile& tile) {
    const Grid& grid = job.opacity->grid();
    for_voxels(grid, tile, [&](std::size_t x, std::size_t y, std::size_t z) {
        job.visibility[grid.index(x, y, z)] = factor_at(job, x, y, z);
    });
}

void local_air_reference(const LocalJob& job, const Tile& tile) {
    const Grid& grid = job.opacity->grid();
    for_voxels(grid, tile, [&](std::size_t x, std::size_t y, std::size_t z) {
        if (y % 2 == 0 && z % 2 == 0) job.visibility[grid.index(x, y, z)] = factor_at(job, x, y, z);
    });
}

}  // namespace dfield::runtime::volume
