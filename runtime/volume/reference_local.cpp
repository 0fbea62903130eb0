// Equations 2 and 3 as they stand, every sample taken: what the vectorised form is held against, and what
// contexts capped at DFIELD_SIMD_SCALAR run. Approximate rays by what their steps say.
#include "volume/local.hpp"

namespace dfield::runtime::volume {

void local_reference(const LocalJob& job, const Tile& tile) {
    const LocalRays& rays = *job.plan->rays;
    const Grid& grid = job.opacity->grid();
    const auto samples = static_cast<float>(rays.samples);
    for_voxels(grid, tile, [&](std::size_t x, std::size_t y, std::size_t z) {
        const auto at = [&](const RayStep& step) {
            return opacity_at(*job.opacity, static_cast<std::ptrdiff_t>(x) + step.offset[0],
                              static_cast<std::ptrdiff_t>(y) + step.offset[1],
                              static_cast<std::ptrdiff_t>(z) + step.offset[2], step.fraction.data(),
                              step.far ? job.opacity->triples() : 0);
        };
        float factor = 0;
        for (std::size_t k = 0; k < rays.count; ++k) {
            if (rays.approximate) {
                float lost = 0, light = 1;
                for (const RayStep& step : rays.ray(k)) {
                    const float opacity = at(step), taken = light * opacity;
                    lost += taken * (step.weight + step.slope * opacity);
                    light -= taken;
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
        job.visibility[grid.index(x, y, z)] = factor;
    });
}

}  // namespace dfield::runtime::volume
