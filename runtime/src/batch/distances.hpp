// Batches where it matters how far a hit is: bounded distances and falloff. The any-hit kernels find the
// pairs, the depth maps say how far.
#pragma once

#include <array>
#include <cstdint>

#include "ao.hpp"
#include "batch/chunk.hpp"

namespace dfield::runtime {

// Blocks at a time: a byte a pair fits where masks have a bit.
inline constexpr std::size_t kDistanceBlocks = 16;

// Of each line of a slab and each receiver of a chunk of at most kDistanceBlocks: the occlusion, times
// 255, rounded; of several casters the largest, since none gives more than its nearest hit.
struct ChunkOcclusion {
    std::array<std::array<std::uint8_t, kDistanceBlocks * kLanes>, kSlab> rows;
};

// What a hit at some distance gives: its occlusion by the settings, or all where it is within reach.
struct DistanceRule {
    const dfield_ao& ao;
    bool reach_only;

    float occlusion(float distance) const {
        return reach_only ? static_cast<float>(distance <= ao.max_distance) : ao.occlusion(distance);
    }
};

void add_ground_distances(const Plane& ground, const DistanceRule& rule, const Slab& slab, const Chunk& chunk,
                          ChunkOcclusion& occlusion);

// `masks` and `prepared` are working memory.
void add_caster_distances(const BatchKernels& kernels, const DirectionCaster& caster,
                          const DistanceRule& rule, const Slab& slab, const Chunk& chunk, BlockPairs& pairs,
                          ChunkMasks& masks, PreparedLines& prepared, ChunkOcclusion& occlusion);

// Adds weight * |n.w| * occlusion of all pairs to occluded[receiver].
void add_occlusion(const Slab& slab, const Chunk& chunk, const ChunkOcclusion& occlusion, float* occluded);

}  // namespace dfield::runtime
