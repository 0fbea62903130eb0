// The directions of shared sampling, laid out for batches: opposite ones as one line, whose ends are told
// apart by a receiver's normal; neighbours together in clusters of sixteen; and the sum of cosine weights
// over the hemisphere of any normal as a table.
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
    float cosine, sine;  // of the angle between the axis and the line farthest from it
};

struct SharedDirections {
    static constexpr std::uint32_t kNoRay = 0xffffffff;
    static constexpr int kTotalsSize = 64;  // cells along a side of the octahedral table

    explicit SharedDirections(std::pmr::memory_resource* memory)
        : x(memory),
          y(memory),
          z(memory),
          weight{std::pmr::vector<float>(memory), std::pmr::vector<float>(memory)},
          ray{std::pmr::vector<std::uint32_t>(memory), std::pmr::vector<std::uint32_t>(memory)},
          clusters(memory),
          cluster_rows{std::pmr::vector<float>(memory), std::pmr::vector<float>(memory),
                       std::pmr::vector<float>(memory), std::pmr::vector<float>(memory),
                       std::pmr::vector<float>(memory)},
          totals(memory) {}

    // Directions are unit, weights non-negative; empty weights: all 1.
    void build(std::span<const glm::vec3> directions, std::span<const float> weights);

    bool empty() const { return x.empty(); }
    std::size_t lines() const { return x.size(); }  // with padding: a multiple of kClusterSize
    glm::vec3 direction(std::size_t line) const { return {x[line], y[line], z[line]}; }

    // Sum of weight * max(0, n.w) over all directions, interpolated: within 1e-3 of the exact sum, relative,
    // for 256 directions and more.
    float total(const glm::vec3& normal) const;

    // Lines in cluster order, by their direction in the upper half. Padding repeats one.
    std::pmr::vector<float> x, y, z;
    // Of a line's two ends, [0] along (x, y, z), [1] against it: weight and index in the caller's order. An
    // end that the caller has no direction for: 0 and kNoRay.
    std::array<std::pmr::vector<float>, 2> weight;
    std::array<std::pmr::vector<std::uint32_t>, 2> ray;
    bool one_sided = false;  // some line has one end only
    std::pmr::vector<DirectionCluster> clusters;
    // The clusters again, one array a member, filled up to a multiple of kClusterSize: axis, cosine, sine.
    std::array<std::pmr::vector<float>, 5> cluster_rows;
    std::pmr::vector<float> totals;  // (kTotalsSize + 1)^2 values at the octahedron's lattice, row by row
};

}  // namespace dfield::runtime
