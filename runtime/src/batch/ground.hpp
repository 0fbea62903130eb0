// The ground as a caster of batches: it blocks the ends of lines that lead below its plane.
#pragma once

#include "batch/chunk.hpp"

namespace dfield::runtime {

// Of a block: the receivers that face the lower end of line k.
inline std::uint16_t facing_ground(const Plane& ground, const Slab& slab, std::size_t k, const Chunk& chunk,
                                   std::size_t block) {
    std::uint32_t bits = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const int end = slab.faced_end(k, chunk.normal(block * kLanes + lane));
        bits |= std::uint32_t{glm::dot(ground.normal, slab.towards(k, end)) < 0} << lane;
    }
    return static_cast<std::uint16_t>(bits & chunk.lanes[block]);
}

}  // namespace dfield::runtime
