#include "rays/ray_groups.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

#include "halves.hpp"

namespace dfield::runtime {
namespace {

constexpr float kHalfSpace = 1e6f;  // tangent of a cone that is no cone

}  // namespace

void RayGroups::build(std::span<const glm::vec3> directions, std::span<const float> weights,
                      float even_weight) {
    std::vector<std::uint32_t> order(directions.size());
    std::iota(order.begin(), order.end(), 0u);
    halve(
        std::span(order), kRayGroup, [&](std::uint32_t i) { return directions[i]; }, std::identity());
    const std::size_t count = (order.size() + kRayGroup - 1) / kRayGroup * kRayGroup;
    for (std::size_t i = 0; i < count; ++i) {
        const bool real = i < order.size();
        const std::uint32_t r = real ? order[i] : order.back();
        x.push_back(directions[r].x);
        y.push_back(directions[r].y);
        z.push_back(directions[r].z);
        weight.push_back(!real ? 0.0f : weights.empty() ? even_weight : weights[r]);
        ray.push_back(real ? r : kNoRay);
    }
    for (std::size_t first = 0; first < count; first += kRayGroup) {
        const auto unit = [&](std::size_t i) { return glm::normalize(glm::vec3(x[i], y[i], z[i])); };
        glm::vec3 axis(0);
        for (std::size_t i = first; i < first + kRayGroup; ++i) axis += unit(i);
        const float length = glm::length(axis);
        axis = length > 0 ? axis / length : unit(first);
        float cosine = 1;
        for (std::size_t i = first; i < first + kRayGroup; ++i)
            cosine = std::min(cosine, glm::dot(axis, unit(i)));
        // Rounding must not leave a direction outside.
        const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine)) + 1e-3f;
        const float tangent = cosine * kHalfSpace > sine ? sine / cosine : kHalfSpace;
        for (int row = 0; row < 4; ++row) cones[row].push_back(row < 3 ? axis[row] : tangent);
    }
    constexpr std::size_t kGroups = kRayBlock / kRayGroup;
    for (auto& row : cones) row.resize((row.size() + kGroups - 1) / kGroups * kGroups, 0.0f);
    for (auto* row : {&x, &y, &z, &weight}) row->resize(count + kRayPadding, 0.0f);
}

}  // namespace dfield::runtime
