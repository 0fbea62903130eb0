// Local ambient occlusion with rays that are turned at random, other ones at every voxel: no two voxels share
// their trilinear weights, so this is plain code at every level of SIMD.
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "volume/local.hpp"
#include "volume/random.hpp"

namespace dfield::runtime::volume {

void local_jittered(const LocalJob& job, const Tile& tile) {
    const LocalRays& rays = *job.plan->rays;
    const Grid& grid = job.opacity->grid();
    const auto samples = static_cast<float>(rays.samples);
    // Rays cover 4 pi / K each: this is half the side of a square as large.
    const float most = rays.jitter.most * std::sqrt(glm::pi<float>() / static_cast<float>(rays.count));
    for_voxels(grid, tile, [&](std::size_t x, std::size_t y, std::size_t z) {
        const std::size_t voxel = grid.index(x, y, z);
        const glm::vec3 origin(x, y, z), scale(rays.step);
        float factor = 0;
        for (std::size_t k = 0; k < rays.count; ++k) {
            const std::uint64_t bits = mixed(rays.jitter.seed + mixed(voxel * rays.count + k));
            glm::vec3 turn;
            for (int axis = 0; axis < 3; ++axis)
                turn[axis] = static_cast<float>(bits >> 21 * axis & 0x1fffff) * 0x1p-20f - 1;
            const glm::vec3 step = glm::normalize(glm::vec3(rays.directions[k]) + most * turn) * scale;
            float sum = 1, light = 1;
            for (std::size_t i = 1; i <= rays.kept(); ++i) {
                const glm::vec3 at = origin + static_cast<float>(i) * step, whole = glm::floor(at),
                                fraction = at - whole;
                light *= 1 - opacity_at(*job.opacity, static_cast<std::ptrdiff_t>(whole.x),
                                        static_cast<std::ptrdiff_t>(whole.y),
                                        static_cast<std::ptrdiff_t>(whole.z), &fraction.x);
                if (light < kOpaque) break;
                sum += light;
            }
            factor += rays.weights[k] * (sum / samples);
        }
        job.visibility[voxel] = factor;
    });
}

}  // namespace dfield::runtime::volume
