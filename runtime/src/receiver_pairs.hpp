// Sets of pairs of a line and a block of receivers, as BlockPairs holds them: which ones to ask about,
// which ones an instance may block, which ones it did.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <span>

#include "batch/batch.hpp"

namespace dfield::runtime {

// The pairs of `pairs` that `keep`(k, group) lets through.
template<class Keep>
void restrict_pairs(const Chunk& chunk, const Slab& slab, const BlockPairs& pairs, const Keep& keep,
                    BlockPairs& result) {
    result.clusters = 0;
    for (std::size_t k = 0; k < slab.count; ++k) {
        std::uint32_t any = 0;
        for (std::size_t group = 0; group < chunk.groups(); ++group)
            any |= result.rows[k][group] = static_cast<std::uint16_t>(pairs.rows[k][group] & keep(k, group));
        if (any != 0) result.clusters |= 1u << k / kClusterSize;
    }
}

// A ball around some receivers.
struct Ball {
    glm::vec3 centre;
    float radius;
};
inline Ball ball_of(const glm::vec3& low, const glm::vec3& high) {
    return {0.5f * (low + high), 0.5f * glm::length(high - low)};
}

// Whether a line of the cluster through a ball may come near the caster.
inline bool may_meet(const Ball& ball, const DirectionCluster& cluster, const DirectionCaster& caster) {
    const glm::vec3 away = caster.centre - ball.centre;
    const float square = glm::dot(away, away), near = 1.001f * (caster.reach + ball.radius);
    if (cluster.cosine <= 0 || near * near >= square) return true;
    // The angle to the cluster's axis is at most the cluster's own plus the one that both balls are seen
    // under.
    const float bound = cluster.cosine * std::sqrt(square - near * near) - cluster.sine * near;
    return std::fabs(glm::dot(cluster.axis, away)) >= bound - 1e-4f * std::sqrt(square);
}

// Of `pairs`, the pairs with a line that may come near a caster: by clusters and groups of blocks.
inline void find_near(const Chunk& chunk, const Slab& slab, const BlockPairs& pairs,
                      std::span<const DirectionCaster> casters, BlockPairs& result) {
    const Ball whole = ball_of(chunk.low, chunk.high);
    result.clusters = 0;
    for (std::uint32_t rest = pairs.clusters; rest != 0; rest &= rest - 1) {
        const auto c = static_cast<std::size_t>(std::countr_zero(rest));
        const DirectionCluster& cluster = slab.shared.clusters[slab.first / kClusterSize + c];
        std::uint32_t groups = 0;
        for (const DirectionCaster& caster : casters) {
            if (!may_meet(whole, cluster, caster)) continue;
            for (std::size_t group = 0; group < chunk.groups(); ++group)
                groups |=
                    std::uint32_t{may_meet({chunk.group_boxes[group].middle, chunk.group_boxes[group].radius},
                                           cluster, caster)}
                    << group;
        }
        if (groups == 0) continue;
        result.clusters |= 1u << c;
        for (std::size_t k = c * kClusterSize; k < (c + 1) * kClusterSize; ++k)
            for (std::size_t group = 0; group < chunk.groups(); ++group)
                result.rows[k][group] = groups >> group & 1 ? pairs.rows[k][group] : std::uint16_t{0};
    }
}

// Calls use(k, block) for touched words.
template<class Use>
void for_touched(const Chunk& chunk, const BlockPairs& touched, const Use& use) {
    for_lines(touched.clusters, [&](std::size_t k) {
        for (std::size_t group = 0; group < chunk.groups(); ++group)
            for (std::uint32_t rest = touched.rows[k][group]; rest != 0; rest &= rest - 1)
                use(k, 16 * group + std::countr_zero(rest));
    });
}

inline void clear(const Chunk& chunk, const BlockPairs& touched, ChunkMasks& masks) {
    for_touched(chunk, touched, [&](std::size_t k, std::size_t block) { masks.rows[k][block] = 0; });
}

}  // namespace dfield::runtime
