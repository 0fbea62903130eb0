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

// Approximate rays, `step` voxels from sample to sample. What an error costs falls with the number of samples
// and with the distance: the last samples are taken four at a time, those before by twos, the first ones
// singly. What is between samples farther apart says little of them: no group is longer than four voxels.
RayGroups approximate_groups(std::size_t kept, double step) {
    constexpr double kLongest = 4;
    std::size_t left = kept;
    const auto take = [&](std::size_t most, std::size_t size) {
        if (static_cast<double>(size) * step > kLongest) return std::size_t{0};
        const std::size_t taken = std::min(most, left / size);
        left -= taken * size;
        return taken;
    };
    RayGroups groups;
    groups.ones = std::min(left, std::max<std::size_t>(3, 150 / (kept + 1)));
    left -= groups.ones;
    groups.twos = take(4 * step > kLongest ? kept : 5, 2);
    groups.fours = take(kept, 4);
    groups.twos += take(1, 2);
    groups.ones += left;
    return groups;
}

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
    const std::size_t kept = rays.kept();
    const glm::dvec3 spacing(grid.hx, grid.hy, grid.hz);
    if (options.world) rays.step /= spacing;
    rays.groups = options.approximate
                      ? approximate_groups(kept, std::max({rays.step.x, rays.step.y, rays.step.z}))
                      : RayGroups{kept, 0, 0};
    rays.approximate = rays.groups.ones < kept;
    rays.per_ray = rays.groups.steps();
    rays.steps.reserve(rays.count * rays.per_ray);
    double open = 0;
    for (std::size_t k = 0; k < rays.count; ++k) {
        const double weight = options.weights.empty() ? 1.0 : static_cast<double>(options.weights[k]);
        const double share = weight / static_cast<double>(rays.count);
        rays.weights.push_back(static_cast<float>(share));
        open += share;
        const glm::dvec3 voxels = options.directions[k] * rays.step;
        double before = 0;  // samples
        for (std::size_t n = 0; n < rays.per_ray; ++n) {
            const double size = n < rays.groups.ones                      ? 1
                                : n < rays.groups.ones + rays.groups.twos ? 2
                                                                          : 4,
                         i = before + 0.5 * (1 + size);
            before += size;
            RayStep step{};
            for (int axis = 0; axis < 3; ++axis) {
                const auto a = static_cast<std::size_t>(axis);
                double at = voxels[axis] * i;
                // A direction's rounding error must not make a sample on a plane of voxels lie beside it.
                constexpr double kOnPlane = 1e-6;
                if (std::abs(at - std::round(at)) < kOnPlane) at = std::round(at);
                const double whole = std::floor(at);
                step.offset[a] = static_cast<std::int32_t>(whole);
                step.fraction[a] = static_cast<float>(at - whole);
                rays.low[a] = std::min(rays.low[a], step.offset[a]);
                rays.high[a] = std::max(rays.high[a], step.offset[a] + (step.fraction[a] > 0 ? 1 : 0));
            }
            // The light b that s samples of one opacity take is taken sooner than at their middle: the first
            // ones get more of it. On the average by b (s^2 - 1) / 12 s samples if they take little.
            const double each = share / static_cast<double>(rays.samples),
                         slope = (size * size - 1) / (12 * size) * each;
            step.weight = static_cast<float>((static_cast<double>(rays.samples) - i) * each + slope);
            step.slope = static_cast<float>(slope);
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
