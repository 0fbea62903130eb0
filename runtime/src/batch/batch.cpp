#include "batch/batch.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>

#include "batch/chunk_builder.hpp"
#include "batch/distances.hpp"
#include "batch/prepared.hpp"
#include "kind.hpp"
#include "stretch.hpp"

namespace dfield::runtime {
namespace {

// Their buffers are never needed together: inlined into one function they would add up on the stack.
#if defined(__GNUC__)
#define DFIELD_OWN_FRAME [[gnu::noinline]]
#else
#define DFIELD_OWN_FRAME
#endif

constexpr std::size_t kChunkReceivers = kChunkBlocks * kLanes;

// Calls consume(slab, masks) for each slab of directions, with what instances and ground block.
template<class Consume>
DFIELD_OWN_FRAME void for_slabs(const SceneState& scene, const dfield_ao& ao, const Chunk& chunk,
                                const Consume& consume) {
    const BatchKernels& kernels = batch_kernels(scene.context()->simd_targets);
    ChunkMasks masks;
    BlockPairs pairs;
    PreparedLines prepared;
    for (std::size_t s = 0; s < slab_count(ao.shared); ++s) {
        const Slab slab(ao.shared, s);
        masks.clear(chunk, slab.count);
        kernels.find_pairs(chunk, slab, pairs);
        if (scene.ground) kernels.add_ground(*scene.ground, slab, chunk, masks);
        for (const dfield_instance id : scene.active) {
            const Instance& instance = scene.instances[id];
            if (kind_for(ao, *instance.field) != DFIELD_KIND_DIRECTIONS) continue;
            prepared.clusters = 0;
            kernels.add_caster(direction_caster(ao, instance, id), slab, chunk, pairs, masks, prepared);
        }
        consume(slab, masks);
    }
}

// The same where distances count: consume(slab, occlusion), for a chunk of at most kDistanceBlocks.
template<class Consume>
DFIELD_OWN_FRAME void for_distance_slabs(const SceneState& scene, const DistanceRule& rule,
                                         const Chunk& chunk, const Consume& consume) {
    const dfield_ao& ao = rule.ao;
    const BatchKernels& kernels = batch_kernels(scene.context()->simd_targets);
    ChunkOcclusion occlusion;
    ChunkMasks masks;
    BlockPairs pairs;
    PreparedLines prepared;
    for (std::size_t s = 0; s < slab_count(ao.shared); ++s) {
        const Slab slab(ao.shared, s);
        for (std::size_t k = 0; k < slab.count; ++k) occlusion.rows[k].fill(0);
        kernels.find_pairs(chunk, slab, pairs);
        if (scene.ground) add_ground_distances(*scene.ground, rule, slab, chunk, occlusion);
        for (const dfield_instance id : scene.active)
            add_caster_distances(kernels, direction_caster(ao, scene.instances[id], id), rule, slab, chunk,
                                 pairs, masks, prepared, occlusion);
        consume(slab, occlusion);
    }
}

// Calls answer(first, count, chunk, lane_of) for chunks of the receivers, of about equal size and at most
// `blocks`.
template<class Answer>
void for_chunks(const BatchKernels& kernels, const dfield_receivers& receivers, std::size_t blocks,
                const Answer& answer) {
    const std::size_t largest = blocks * kLanes, chunks = (receivers.count + largest - 1) / largest;
    Chunk chunk;
    LaneOfReceiver lane_of;
    for (std::size_t c = 0; c < chunks; ++c) {
        const std::size_t begin = receivers.count * c / chunks, end = receivers.count * (c + 1) / chunks;
        build_chunk(kernels, receivers, begin, end, chunk, lane_of);
        answer(begin, end - begin, chunk, lane_of);
    }
}

// Calls mark(lane, ray) for a blocked pair of a line and a receiver, if there is a ray at the end that it
// faces.
template<class Mark>
void mark_faced(const Slab& slab, const Chunk& chunk, std::size_t k, std::size_t lane, const Mark& mark) {
    const std::uint32_t ray = slab.faced_ray(k, chunk.normal(lane));
    if (ray != SharedDirections::kNoRay) mark(lane, ray);
}

}  // namespace

BatchShare batch_share(const SceneState& scene, const dfield_ao& ao) {
    if (ao.sampling != DFIELD_SAMPLING_SHARED) return BatchShare::kNone;
    bool some = false, all = true;
    for (const dfield_instance id : scene.active) {
        const dfield_kind kind = kind_for(ao, *scene.instances[id].field);
        if (kind == DFIELD_KIND_VOLUME) continue;  // multiplied to what the others say
        some |= kind == DFIELD_KIND_DIRECTIONS;
        all &= kind == DFIELD_KIND_DIRECTIONS;
    }
    return all ? BatchShare::kAll : some ? BatchShare::kSome : BatchShare::kNone;
}

DirectionCaster direction_caster(const dfield_ao& ao, const Instance& instance, dfield_instance id) {
    const dfield_field& field = *instance.field;
    const auto& levels = field.maps.directions;
    const bool choose = ao.level_error > 0 && levels.size() > 1;
    const float reach = *std::max_element(field.direction_reach.begin(), field.direction_reach.end());
    return {instance,
            levels.back(),
            -(instance.to_world * instance.unit_offset),
            1.0001f * reach * stretch(instance.to_world),
            ao.bias,
            id,
            choose ? std::span<const DirectionMaps>(levels) : std::span<const DirectionMaps>(),
            field.level_disagreement.data(),
            ao.level_error};
}

void batch_visibility(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                      const Strided<float>& visibility) {
    const BatchKernels& kernels = batch_kernels(scene.context()->simd_targets);
    for_chunks(kernels, receivers, ao.any_hit() ? kChunkBlocks : kDistanceBlocks,
               [&](std::size_t begin, std::size_t count, const Chunk& chunk, const LaneOfReceiver& lane_of) {
                   alignas(64) std::array<float, kChunkReceivers> values;
                   std::fill_n(values.begin(), chunk.blocks * kLanes, 0.0f);
                   if (ao.any_hit())
                       for_slabs(scene, ao, chunk, [&](const Slab& slab, const ChunkMasks& masks) {
                           kernels.add_occluded(slab, chunk, masks, all_blocks(chunk), values.data());
                       });
                   else
                       for_distance_slabs(scene, {ao, false}, chunk,
                                          [&](const Slab& slab, const ChunkOcclusion& occlusion) {
                                              add_occlusion(slab, chunk, occlusion, values.data());
                                          });
                   kernels.finish_visibility(ao.shared, chunk, values.data());
                   for (std::size_t i = 0; i < count; ++i)
                       *visibility.at(begin + i) = lane_of[i] != kLeftOut ? values[lane_of[i]] : 1.0f;
               });
}

void batch_masks(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                 const Strided<std::uint32_t>& masks) {
    const BatchKernels& kernels = batch_kernels(scene.context()->simd_targets);
    for_chunks(
        kernels, receivers, ao.any_hit() ? kChunkBlocks : kDistanceBlocks,
        [&](std::size_t begin, std::size_t count, const Chunk& chunk, const LaneOfReceiver& lane_of) {
            std::array<std::uint32_t, kChunkReceivers> receiver_of;  // by lane
            for (std::size_t i = 0; i < count; ++i) {
                std::fill_n(masks.at(begin + i), ao.mask_words(), 0u);
                if (lane_of[i] != kLeftOut) receiver_of[lane_of[i]] = static_cast<std::uint32_t>(begin + i);
            }
            const auto mark = [&](std::size_t lane, std::uint32_t ray) {
                masks.at(receiver_of[lane])[ray >> 5] |= 1u << (ray & 31);
            };
            if (ao.any_hit())
                for_slabs(scene, ao, chunk, [&](const Slab& slab, const ChunkMasks& blocked) {
                    for (std::size_t k = 0; k < slab.count; ++k)
                        for (std::size_t b = 0; b < chunk.blocks; ++b)
                            for (std::uint32_t bits = blocked.rows[k][b] & chunk.lanes[b]; bits != 0;
                                 bits &= bits - 1)
                                mark_faced(slab, chunk, k, b * kLanes + std::countr_zero(bits), mark);
                });
            else
                for_distance_slabs(
                    scene, {ao, true}, chunk, [&](const Slab& slab, const ChunkOcclusion& occlusion) {
                        for (std::size_t k = 0; k < slab.count; ++k)
                            for (std::size_t i = 0; i < chunk.blocks * kLanes; ++i)
                                if (occlusion.rows[k][i] != 0 && (chunk.lanes[i / kLanes] >> i % kLanes & 1))
                                    mark_faced(slab, chunk, k, i, mark);
                    });
        });
}

}  // namespace dfield::runtime
