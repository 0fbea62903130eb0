#include "batch/shared_directions.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>

#include "format/octahedral.hpp"
#include "halves.hpp"

namespace dfield::runtime {
namespace {

struct Line {
    glm::vec3 direction;               // in the upper half
    std::array<std::uint32_t, 2> ray;  // along it, against it; SharedDirections::kNoRay for none
};

// Directions in the caller's order as lines; of each, the first that has no opposite yet takes one.
std::vector<Line> lines_of(std::span<const glm::vec3> directions) {
    std::vector<Line> lines;
    std::map<std::array<float, 3>, std::vector<std::size_t>> open[2];  // lines that lack an end
    for (std::uint32_t r = 0; r < directions.size(); ++r) {
        const glm::vec3 w = directions[r];
        const bool against = w.z != 0 ? w.z < 0 : w.y != 0 ? w.y < 0 : w.x < 0;
        const glm::vec3 u = (against ? -w : w) + 0.0f;  // no negative zeros
        const std::array<float, 3> key{u.x, u.y, u.z};
        if (const auto found = open[against].find(key);
            found != open[against].end() && !found->second.empty()) {
            lines[found->second.back()].ray[against] = r;
            found->second.pop_back();
            continue;
        }
        Line line{u, {SharedDirections::kNoRay, SharedDirections::kNoRay}};
        line.ray[against] = r;
        open[!against][key].push_back(lines.size());
        lines.push_back(line);
    }
    return lines;
}

}  // namespace

void SharedDirections::build(std::span<const glm::vec3> directions, std::span<const float> weights) {
    const std::vector<Line> lines = lines_of(directions);
    std::vector<glm::vec3> upper;
    for (const Line& line : lines) upper.push_back(line.direction);
    std::vector<std::uint32_t> order(lines.size());
    std::iota(order.begin(), order.end(), 0u);
    halve(
        std::span(order), kClusterSize, [&](std::uint32_t i) { return upper[i]; }, std::identity());
    const std::size_t count = (order.size() + kClusterSize - 1) / kClusterSize * kClusterSize;
    for (std::size_t i = 0; i < count; ++i) {
        const bool real = i < order.size();
        const Line& line = lines[real ? order[i] : order.back()];
        x.push_back(line.direction.x);
        y.push_back(line.direction.y);
        z.push_back(line.direction.z);
        for (int end = 0; end < 2; ++end) {
            const std::uint32_t r = real ? line.ray[end] : kNoRay;
            ray[end].push_back(r);
            weight[end].push_back(r == kNoRay ? 0.0f : weights.empty() ? 1.0f : weights[r]);
            one_sided |= real && r == kNoRay;
        }
    }
    for (std::size_t first = 0; first < count; first += kClusterSize) {
        DirectionCluster result{glm::vec3(0), 1, 0};
        for (std::size_t i = first; i < first + kClusterSize; ++i) result.axis += glm::vec3(x[i], y[i], z[i]);
        const float length = glm::length(result.axis);
        result.axis = length > 0 ? result.axis / length : glm::vec3(x[first], y[first], z[first]);
        for (std::size_t i = first; i < first + kClusterSize; ++i)
            result.cosine = std::min(result.cosine, glm::dot(result.axis, glm::vec3(x[i], y[i], z[i])));
        result.cosine = std::max(result.cosine - 1e-6f, -1.0f);
        result.sine = std::sqrt(std::max(0.0f, 1 - result.cosine * result.cosine));
        clusters.push_back(result);
    }
    for (const DirectionCluster& c : clusters)
        for (std::size_t i = 0; i < cluster_rows.size(); ++i)
            cluster_rows[i].push_back(i < 3 ? c.axis[static_cast<int>(i)] : i == 3 ? c.cosine : c.sine);
    // A slab's clusters are read as two whole vectors of sixteen.
    for (auto& row : cluster_rows) row.resize((row.size() + 31) / 32 * 32, 0.0f);
    for (int row = 0; row <= kTotalsSize; ++row)
        for (int column = 0; column <= kTotalsSize; ++column) {
            const glm::vec3 n = octahedral_direction({2.0f * static_cast<float>(column) / kTotalsSize - 1,
                                                      2.0f * static_cast<float>(row) / kTotalsSize - 1});
            double sum = 0;
            for (std::size_t i = 0; i < count; ++i) {
                const float cosine = n.x * x[i] + n.y * y[i] + n.z * z[i];
                sum += weight[cosine < 0][i] * std::fabs(cosine);
            }
            totals.push_back(static_cast<float>(sum));
        }
}

float SharedDirections::total(const glm::vec3& n) const {
    const float scale = 1 / (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z));
    float a = n.x * scale, b = n.y * scale;
    if (n.z < 0) {
        const float folded = std::copysign(1 - std::fabs(b), a);
        b = std::copysign(1 - std::fabs(a), b);
        a = folded;
    }
    const float column = (a + 1) * (0.5f * kTotalsSize), row = (b + 1) * (0.5f * kTotalsSize);
    const int i = std::clamp(static_cast<int>(column), 0, kTotalsSize - 1);
    const int j = std::clamp(static_cast<int>(row), 0, kTotalsSize - 1);
    const float u = column - static_cast<float>(i), v = row - static_cast<float>(j);
    const float* const cell = totals.data() + j * (kTotalsSize + 1) + i;
    const float* const next = cell + kTotalsSize + 1;
    const float above = cell[0] + u * (cell[1] - cell[0]), below = next[0] + u * (next[1] - next[0]);
    return above + v * (below - above);
}

}  // namespace dfield::runtime
