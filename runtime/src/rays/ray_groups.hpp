// Ray directions laid out for culling: neighbours together in groups of sixteen, each with a cone around it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <span>
#include <vector>

namespace dfield::runtime {

// Rays of a block, which share stack-held results. Arrays handed to kernels can be read kRayPadding elements
// past their end.
inline constexpr std::size_t kRayBlock = 256;
inline constexpr std::size_t kRayPadding = 16;
inline constexpr std::size_t kRayGroup = 16;

// A bit for each ray of a block.
using RayBits = std::array<std::uint64_t, kRayBlock / 64>;

inline RayBits first_bits(std::size_t count) {
    RayBits bits;
    for (std::size_t word = 0; word < bits.size(); ++word) {
        const std::size_t left = count > 64 * word ? count - 64 * word : 0;
        bits[word] = left >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << left) - 1;
    }
    return bits;
}
inline bool has_bit(const RayBits& bits, std::size_t i) {
    return bits[i / 64] >> i % 64 & 1;
}
inline void clear_bit(RayBits& bits, std::size_t i) {
    bits[i / 64] &= ~(std::uint64_t{1} << i % 64);
}
// Without the processor's own instruction, which plain code must not expect.
inline std::size_t count_bits(const RayBits& bits) {
    constexpr std::uint64_t kPairs = 0x3333333333333333, kBytes = 0x0f0f0f0f0f0f0f0f,
                            kShorts = 0x00ff00ff00ff00ff;
    std::uint64_t sums = 0;
    for (std::uint64_t word : bits) {
        word -= word >> 1 & 0x5555555555555555;
        word = (word & kPairs) + (word >> 2 & kPairs);
        sums += (word + (word >> 4)) & kBytes;
    }
    sums = (sums & kShorts) + (sums >> 8 & kShorts);
    return static_cast<std::size_t>(sums * 0x0001000100010001 >> 48);
}

// The cone of a group: its axis, unit, and the tangent of the angle to the direction farthest from it (at
// least; very large where the cone is no narrower than a half space).
struct RayCones {
    const float *x, *y, *z, *tangent;
};

// Consecutive groups of a RayGroups, at most a block. Cones can be read up to whole blocks.
struct GroupedRays {
    const float *x, *y, *z;
    RayCones cones;
    std::size_t groups;

    std::size_t count() const { return kRayGroup * groups; }
    glm::vec3 direction(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

struct RayGroups {
    static constexpr std::uint32_t kNoRay = 0xffffffff;

    explicit RayGroups(std::pmr::memory_resource* memory)
        : x(memory),
          y(memory),
          z(memory),
          weight(memory),
          ray(memory),
          cones{std::pmr::vector<float>(memory), std::pmr::vector<float>(memory),
                std::pmr::vector<float>(memory), std::pmr::vector<float>(memory)} {}

    // Directions are unit to 1e-3; empty weights: all `even_weight`.
    void build(std::span<const glm::vec3> directions, std::span<const float> weights, float even_weight);

    std::size_t padded() const { return ray.size(); }  // a multiple of kRayGroup

    // The block from this ray on, a multiple of kRayBlock.
    GroupedRays block(std::size_t begin) const {
        const std::size_t group = begin / kRayGroup;
        return {&x[begin],
                &y[begin],
                &z[begin],
                {&cones[0][group], &cones[1][group], &cones[2][group], &cones[3][group]},
                std::min(padded() - begin, kRayBlock) / kRayGroup};
    }
    // In group order. Padding repeats a direction, with weight 0 and ray kNoRay.
    std::pmr::vector<float> x, y, z, weight;
    std::pmr::vector<std::uint32_t> ray;  // index in the caller's order
    std::array<std::pmr::vector<float>, 4> cones;
};

}  // namespace dfield::runtime
