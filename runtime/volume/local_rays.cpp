#include "volume/local_rays.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <numeric>

namespace dfield::runtime::volume {

std::vector<glm::dvec3> neighbour_directions(std::size_t count) {
    std::vector<glm::dvec3> directions;
    if (count == 54) {
        for (int axis = 0; axis < 3; ++axis)
            for (const int side : {-1, 1})
                for (int u = -1; u <= 1; ++u)
                    for (int v = -1; v <= 1; ++v) {
                        glm::dvec3 sticker;
                        sticker[axis] = side;
                        sticker[(axis + 1) % 3] = u * 2.0 / 3;
                        sticker[(axis + 2) % 3] = v * 2.0 / 3;
                        directions.push_back(glm::normalize(sticker));
                    }
        return directions;
    }
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                const int manhattan = std::abs(x) + std::abs(y) + std::abs(z);
                if (manhattan == 1 || (manhattan == 3 && count >= 14) || (manhattan == 2 && count == 26))
                    directions.push_back(glm::normalize(glm::dvec3(x, y, z)));
            }
    return directions;
}

std::vector<glm::dvec3> fibonacci_directions(std::size_t count) {
    std::vector<glm::dvec3> directions;
    const double turn = 2 * glm::pi<double>() / glm::golden_ratio<double>();
    for (std::size_t i = 0; i < count; ++i) {
        const auto at = static_cast<double>(i);
        const double z = 1 - (2 * at + 1) / static_cast<double>(count), r = std::sqrt(1 - z * z);
        directions.emplace_back(r * std::cos(at * turn), r * std::sin(at * turn), z);
    }
    return directions;
}

namespace {

// Approximate rays: so many samples are exact, all others are taken three at a time. What an error costs
// falls with the number of samples and with the distance.
std::size_t near_samples(std::size_t kept) {
    const std::size_t near = std::max<std::size_t>(5, (250 + kept) / (kept + 1));
    return kept <= near ? kept : near + (kept - near) % 3;
}

// Of three samples of one opacity the first takes the most: of the light b that they take together, on the
// average at the second but s b, where s grows from 0.22 to 0.52 with b up to 0.9.
constexpr double kSooner = 0.38;

}  // namespace

LocalRays make_local_rays(std::pmr::memory_resource* memory, const Grid& grid, const RayOptions& options) {
    LocalRays rays{options.directions.size(),
                   options.samples,
                   1,
                   options.jitter,
                   glm::dvec3(options.step),
                   std::pmr::vector<glm::dvec3>(options.directions.begin(), options.directions.end(), memory),
                   std::pmr::vector<float>(memory),
                   std::pmr::vector<RayStep>(memory)};
    const std::size_t kept = rays.kept(), near = options.approximate ? near_samples(kept) : kept;
    rays.approximate = options.approximate;
    rays.per_ray = near + (kept - near) / 3;
    rays.steps.reserve(rays.count * rays.per_ray);
    const glm::dvec3 spacing(grid.hx, grid.hy, grid.hz);
    if (options.world) rays.step /= spacing;
    double open = 0;
    for (std::size_t k = 0; k < rays.count; ++k) {
        const double weight = options.weights.empty() ? 1.0 : static_cast<double>(options.weights[k]);
        const double share = weight / static_cast<double>(rays.count);
        rays.weights.push_back(static_cast<float>(share));
        open += share;
        const glm::dvec3 voxels = options.directions[k] * rays.step;
        for (std::size_t n = 1; n <= rays.per_ray; ++n) {
            const std::size_t i = n <= near ? n : 3 * n - 2 * near - 1;
            RayStep step{};
            step.far = n > near;
            for (int axis = 0; axis < 3; ++axis) {
                const auto a = static_cast<std::size_t>(axis);
                double at = voxels[axis] * static_cast<double>(i);
                // A direction's rounding error must not make a sample on a plane of voxels lie beside it.
                constexpr double kOnPlane = 1e-6;
                if (std::abs(at - std::round(at)) < kOnPlane) at = std::round(at);
                const double whole = std::floor(at);
                step.offset[a] = static_cast<std::int32_t>(whole);
                step.fraction[a] = static_cast<float>(at - whole);
                rays.low[a] = std::min(rays.low[a], step.offset[a]);
                rays.high[a] = std::max(rays.high[a], step.offset[a] + (step.fraction[a] > 0 ? 1 : 0));
            }
            step.weight = static_cast<float>(share * static_cast<double>(rays.samples - i) /
                                             static_cast<double>(rays.samples));
            if (step.far)
                step.slope = static_cast<float>(share * kSooner / static_cast<double>(rays.samples));
            rays.steps.push_back(step);
        }
    }
    if (options.jitter.most > 0)
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            rays.high[a] = static_cast<std::int32_t>(rays.step[axis] * static_cast<double>(kept)) + 2;
            rays.low[a] = -rays.high[a];
        }
    const glm::dvec3 farthest = rays.step * spacing;
    rays.reach =
        static_cast<float>(std::max({farthest.x, farthest.y, farthest.z}) * static_cast<double>(kept));
    rays.open = static_cast<float>(open);
    return rays;
}

}  // namespace dfield::runtime::volume
