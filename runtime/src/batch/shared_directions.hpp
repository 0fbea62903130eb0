// The directions of shared sampling, laid out for batches: neighbours together in clusters of sixteen, and
// the sum of cosine weights over the hemisphere of any normal as a table.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <span>
#include <vector>

namespace dfield::runtime {

inline constexpr std::size_t kClusterSize = 16;

struct DirectionCluster {
    glm::vec3 axis;      // unit
    float cosine, sine;  // of the angle between the axis and the direction farthest from it
};

struct SharedDirections {
    static constexpr std::uint32_t kNoRay = 0xffffffff;
    static constexpr int kTotalsSize = 64;  // cells along a side of the octahedral table

    explicit SharedDirections(std::pmr::memory_resource* memory)
        : x(memory),
          y(memory),
          z(memory),
          weight(memory),
          ray(memory),
          clusters(memory),
          cluster_rows{std::pmr::vector<float>(memory), std::pmr::vector<float>(memory),
                       std::pmr::vector<float>(memory), std::pmr::vector<float>(memory),
                       std::pmr::vector<float>(memory)},
          totals(memory) {}

    // Directions are unit, weights non-negative; empty weights: all 1.
    void build(std::span<const glm::vec3> directions, std::span<const float> weights);

    bool empty() const { return ray.empty(); }
    std::size_t padded() const { return ray.size(); }  // a multiple of kClusterSize

    // Sum of weight * max(0, n.w) over all directions, interpolated: within 1e-3 of the exact sum, relative,
    // for 256 directions and more.
    float total(const glm::vec3& normal) const;

    // In cluster order. Padding repeats a direction, with weight 0 and ray kNoRay.
    std::pmr::vector<float> x, y, z, weight;
    std::pmr::vector<std::uint32_t> ray;  // index in the caller's order
    std::pmr::vector<DirectionCluster> clusters;
    // The clusters again, one array a member, filled up to a multiple of kClusterSize: axis, cosine, sine.
    std::array<std::pmr::vector<float>, 5> cluster_rows;
    std::pmr::vector<float> totals;  // (kTotalsSize + 1)^2 values at the octahedron's lattice, row by row
};

}  // namespace dfield::runtime
