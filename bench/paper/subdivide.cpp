#include "bench/paper/subdivide.hpp"

#include <algorithm>
#include <cstdint>
#include <unordered_map>

namespace dfield::paper {

TriangleMesh subdivided(const TriangleMesh& mesh) {
    TriangleMesh result{mesh.positions, {}, {}};
    std::unordered_map<std::uint64_t, std::uint32_t> midpoints;
    const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
        const std::uint64_t edge = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
        const auto [at, added] = midpoints.emplace(edge, static_cast<std::uint32_t>(result.positions.size()));
        if (added) result.positions.push_back(0.5f * (mesh.positions[a] + mesh.positions[b]));
        return at->second;
    };
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::uvec3 m{midpoint(t.y, t.z), midpoint(t.z, t.x), midpoint(t.x, t.y)};
        for (const glm::uvec3& part : {glm::uvec3(t.x, m.z, m.y), glm::uvec3(m.z, t.y, m.x),
                                       glm::uvec3(m.y, m.x, t.z), glm::uvec3(m.x, m.y, m.z)})
            result.triangles.push_back(part);
    }
    return result;
}

}  // namespace dfield::paper
