#include "batch/distances.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "batch/confirm.hpp"
#include "batch/direction_lookup.hpp"

namespace dfield::runtime {
namespace {

std::uint8_t byte_of(float occlusion) {
    return static_cast<std::uint8_t>(255 * std::clamp(occlusion, 0.0f, 1.0f) + 0.5f);
}

glm::vec3 direction_of(const Slab& slab, std::size_t k) {
    const std::size_t at = slab.first + k;
    return {slab.shared.x[at], slab.shared.y[at], slab.shared.z[at]};
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
        const float approach = -glm::dot(ground.normal, direction_of(slab, k));
        if (!(approach > 0)) continue;
        for (std::size_t i = 0; i < chunk.blocks * kLanes; ++i) {
            const glm::vec3 position(chunk.x[i], chunk.y[i], chunk.z[i]);
            const float height = std::max(glm::dot(ground.normal, position) - ground.distance, 0.0f);
            occlusion.rows[k][i] = std::max(occlusion.rows[k][i], byte_of(rule.occlusion(height / approach)));
        }
    }
}

namespace {

void add_level_distances(const BatchKernels& kernels, const DirectionCaster& caster, const DistanceRule& rule,
                         const Slab& slab, const Chunk& chunk, const ChunkFacing& facing, ChunkMasks& masks,
                         ChunkOcclusion& occlusion) {
    // Everything out of reach occludes nothing.
    const glm::vec3 outside =
        glm::max(glm::max(chunk.low - caster.centre, caster.centre - chunk.high), glm::vec3(0));
    if (glm::length(outside) > caster.reach + rule.ao.max_distance) return;
    masks.clear(chunk, slab.count);
    kernels.add_caster(caster, slab, chunk, facing, masks);
    for (std::size_t k = 0; k < slab.count; ++k) {
        const auto& row = masks.rows[k];
        if (std::all_of(row.begin(), row.begin() + chunk.blocks,
                        [](std::uint16_t bits) { return bits == 0; }))
            continue;
        const glm::vec3 ray = direction_of(slab, k);
        const DirectionLookup lookup(caster.maps, caster.instance, ray);
        for (std::size_t b = 0; b < chunk.blocks; ++b)
            for (std::uint32_t bits = row[b]; bits != 0; bits &= bits - 1) {
                const std::size_t i = b * kLanes + std::countr_zero(bits);
                const glm::vec3 position(chunk.x[i], chunk.y[i], chunk.z[i]);
                const glm::vec3 normal(chunk.nx[i], chunk.ny[i], chunk.nz[i]);
                MapPlace place;
                if (!(glm::dot(normal, ray) > 0) || !lookup.hits(position, place)) continue;
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
                          const DistanceRule& rule, const Slab& slab, const Chunk& chunk,
                          const ChunkFacing& facing, ChunkMasks& masks, ChunkOcclusion& occlusion) {
    for_levels(caster, [&](const DirectionCaster& level) {
        add_level_distances(kernels, level, rule, slab, chunk, facing, masks, occlusion);
    });
}

void add_occlusion(const Slab& slab, const Chunk& chunk, const ChunkOcclusion& occlusion, float* occluded) {
    for (std::size_t k = 0; k < slab.count; ++k) {
        const glm::vec3 ray = direction_of(slab, k);
        const float weight = slab.shared.weight[slab.first + k] * (1.0f / 255);
        const auto& row = occlusion.rows[k];
        for (std::size_t i = 0; i < chunk.blocks * kLanes; ++i) {
            const float cosine = chunk.nx[i] * ray.x + chunk.ny[i] * ray.y + chunk.nz[i] * ray.z;
            occluded[i] += weight * std::max(0.0f, cosine) * static_cast<float>(row[i]);
        }
    }
}

}  // namespace dfield::runtime
