#include "batch/distances.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "batch/confirm.hpp"
#include "batch/direction_lookup.hpp"
#include "batch/prepared.hpp"

namespace dfield::runtime {
namespace {

std::uint8_t byte_of(float occlusion) {
    return static_cast<std::uint8_t>(255 * std::clamp(occlusion, 0.0f, 1.0f) + 0.5f);
}

// Distance of the hit that counts, negative for none. Where the object lies in front of the receiver's
// tangent plane that is the nearest one. Where the plane cuts it the nearest may lie behind: then the
// farthest, an upper bound.
float counting_distance(const HitSpan& span, bool cut, float bias) {
    if (!cut) return std::max(span.nearest, 0.0f);
    if (span.nearest >= bias) return span.nearest;
    return span.farthest > bias ? span.farthest : -1;
}

}  // namespace

void add_ground_distances(const Plane& ground, const DistanceRule& rule, const Slab& slab, const Chunk& chunk,
                          ChunkOcclusion& occlusion) {
    for (std::size_t k = 0; k < slab.count; ++k) {
        for (std::size_t i = 0; i < chunk.blocks * kLanes; ++i) {
            const glm::vec3 ray = slab.towards(k, slab.faced_end(k, chunk.normal(i)));
            const float approach = -glm::dot(ground.normal, ray);
            if (!(approach > 0)) continue;
            const float height = std::max(glm::dot(ground.normal, chunk.position(i)) - ground.distance, 0.0f);
            occlusion.rows[k][i] = std::max(occlusion.rows[k][i], byte_of(rule.occlusion(height / approach)));
        }
    }
}

namespace {

void add_level_distances(const BatchKernels& kernels, const DirectionCaster& caster, const DistanceRule& rule,
                         const Slab& slab, const Chunk& chunk, BlockPairs& pairs, ChunkMasks& masks,
                         PreparedLines& prepared, ChunkOcclusion& occlusion) {
    // Everything out of reach occludes nothing.
    const glm::vec3 outside =
        glm::max(glm::max(chunk.low - caster.centre, caster.centre - chunk.high), glm::vec3(0));
    if (glm::length(outside) > caster.reach + rule.ao.max_distance) return;
    masks.clear(chunk, slab.count);
    prepared.clusters = 0;
    kernels.add_caster(caster, slab, chunk, pairs, masks, prepared);
    for (std::size_t k = 0; k < slab.count; ++k) {
        const auto& row = masks.rows[k];
        if (std::all_of(row.begin(), row.begin() + chunk.blocks,
                        [](std::uint16_t bits) { return bits == 0; }))
            continue;
        const DirectionLookup lookup(caster.maps, caster.instance, slab.direction(k));
        for (std::size_t b = 0; b < chunk.blocks; ++b)
            for (std::uint32_t bits = row[b]; bits != 0; bits &= bits - 1) {
                const std::size_t i = b * kLanes + std::countr_zero(bits);
                const glm::vec3 position = chunk.position(i), normal = chunk.normal(i);
                const glm::vec3 ray = slab.towards(k, slab.faced_end(k, normal));
                MapPlace place;
                if (!lookup.hits(position, place)) continue;
                const bool cut = side_of_receiver(caster, position, normal).cut;
                const float distance =
                    counting_distance(hit_span(caster, position, ray, place), cut, caster.bias);
                if (distance >= 0)
                    occlusion.rows[k][i] = std::max(occlusion.rows[k][i], byte_of(rule.occlusion(distance)));
            }
    }
}

}  // namespace

void add_caster_distances(const BatchKernels& kernels, const DirectionCaster& caster,
                          const DistanceRule& rule, const Slab& slab, const Chunk& chunk, BlockPairs& pairs,
                          ChunkMasks& masks, PreparedLines& prepared, ChunkOcclusion& occlusion) {
    for_levels(caster, [&](const DirectionCaster& level) {
        add_level_distances(kernels, level, rule, slab, chunk, pairs, masks, prepared, occlusion);
    });
}

void add_occlusion(const Slab& slab, const Chunk& chunk, const ChunkOcclusion& occlusion, float* occluded) {
    for (std::size_t k = 0; k < slab.count; ++k) {
        const glm::vec3 w = slab.direction(k);
        const float front = slab.shared.weight[0][slab.first + k] * (1.0f / 255),
                    back = slab.shared.weight[1][slab.first + k] * (1.0f / 255);
        const auto& row = occlusion.rows[k];
        for (std::size_t i = 0; i < chunk.blocks * kLanes; ++i) {
            const float cosine = chunk.nx[i] * w.x + chunk.ny[i] * w.y + chunk.nz[i] * w.z;
            occluded[i] += (cosine < 0 ? back : front) * std::fabs(cosine) * static_cast<float>(row[i]);
        }
    }
}

}  // namespace dfield::runtime
