// Updates of a receiver set where direction maps answer: receiver_set.hpp says how.
#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "batch/ground.hpp"
#include "receiver_pairs.hpp"
#include "receiver_set.hpp"

namespace dfield::runtime {
namespace {

// Lanes that a receiver was given for.
std::uint16_t lanes_of(const SetChunk& chunk, std::size_t block) {
    std::uint32_t lanes = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
        lanes |= std::uint32_t{chunk.receiver[block * kLanes + lane] != kNoReceiver} << lane;
    return static_cast<std::uint16_t>(lanes);
}

}  // namespace
}  // namespace dfield::runtime

using namespace dfield::runtime;

void dfield_receiver_set::update_all(std::size_t begin, std::size_t end, const SceneState& now,
                                     UpdateScratch& scratch) {
    const std::size_t slabs = slab_count(ao_->shared);
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (std::size_t i = begin; i < end; ++i) {
        SetChunk& chunk = chunks_[i];
        for (std::size_t block = 0; block < chunk.chunk.blocks; ++block)
            chunk.computed[block] = chunk.changed[block] = lanes_of(chunk, block);
        low = glm::min(low, chunk.chunk.low);
        high = glm::max(high, chunk.chunk.high);
    }
    order_casters(now, 0.5f * (low + high), scratch);
    for (std::size_t s = 0; s < slabs; ++s) {
        const Slab slab(ao_->shared, s);
        std::array<ChunkWork, UpdateScratch::kTogether> work;
        for (std::size_t i = begin; i < end; ++i) {
            SlabMasks& state = slabs_[i * slabs + s];
            const Chunk& chunk = chunks_[i].chunk;
            find_pairs(chunk, slab, now, state.pairs, scratch);
            state.masks.clear(chunk, slab.count);
            scratch.open[i - begin] = state.pairs;
            work[i - begin] = {&chunk, &scratch.open[i - begin], &state.masks};
        }
        add_casters(slab, now, {work.data(), end - begin}, scratch);
    }
    for (std::size_t i = begin; i < end; ++i) store_visibility(chunks_[i], i);
}

// All pairs that the ground does not block altogether.
void dfield_receiver_set::find_pairs(const Chunk& chunk, const Slab& slab, const SceneState& now,
                                     BlockPairs& pairs, UpdateScratch& scratch) const {
    const BatchKernels& kernels = batch_kernels(context()->simd_targets);
    kernels.find_pairs(chunk, slab, pairs);
    if (!now.ground) return;
    kernels.add_ground(*now.ground, slab, chunk, scratch.now);
    kernels.keep_open(chunk, scratch.now, pairs);
    scratch.now.clear(chunk, slab.count);
}

// Near ones first: what they block altogether, the others need not be asked about.
void dfield_receiver_set::order_casters(const SceneState& now, const glm::vec3& middle,
                                        UpdateScratch& scratch) const {
    scratch.candidates.clear();
    for (const dfield_instance id : now.active) {
        const glm::vec3 away = reaches_[id].centre - middle;
        scratch.candidates.emplace_back(glm::dot(away, away), id);
    }
    std::sort(scratch.candidates.begin(), scratch.candidates.end());
}

void dfield_receiver_set::add_casters(const Slab& slab, const SceneState& now,
                                      std::span<const ChunkWork> chunks, UpdateScratch& scratch) const {
    const BatchKernels& kernels = batch_kernels(context()->simd_targets);
    for (const ChunkWork& work : chunks)
        if (now.ground) kernels.add_ground(*now.ground, slab, *work.chunk, *work.masks);
    for (const auto& [distance, id] : scratch.candidates) {
        const DirectionCaster caster = direction_caster(*ao_, now.instances[id], id);
        scratch.prepared.clusters = 0;
        for (const ChunkWork& work : chunks)
            kernels.add_caster(caster, slab, *work.chunk, *work.pairs, *work.masks, scratch.prepared);
    }
}

void dfield_receiver_set::update_changed(std::size_t index, const SceneState& now,
                                         const SceneChanges& changes, UpdateScratch& scratch) {
    SetChunk& chunk = chunks_[index];
    for (std::size_t block = 0; block < chunk.chunk.blocks; ++block)
        if (chunk.moved[block / 16] >> block % 16 & 1)
            chunk.computed[block] = chunk.changed[block] = lanes_of(chunk, block);
    const std::size_t slabs = slab_count(ao_->shared);
    for (std::size_t s = 0; s < slabs; ++s) {
        const Slab slab(ao_->shared, s);
        update_slab(chunk, slabs_[index * slabs + s], slab, now, changes, scratch);
    }
    store_visibility(chunk, index);
}

void dfield_receiver_set::update_slab(SetChunk& set_chunk, SlabMasks& state, const Slab& slab,
                                      const SceneState& now, const SceneChanges& changes,
                                      UpdateScratch& scratch) {
    const BatchKernels& kernels = batch_kernels(context()->simd_targets);
    const Chunk& chunk = set_chunk.chunk;
    ChunkMasks& masks = state.masks;
    const bool moved = set_chunk.moved != BlockSet{};
    if (moved) find_pairs(chunk, slab, now, state.pairs, scratch);
    const auto restrict_to = [&](std::uint16_t flip) {
        restrict_pairs(
            chunk, slab, state.pairs,
            [&](std::size_t, std::size_t group) { return set_chunk.moved[group] ^ flip; }, scratch.still);
    };
    const BlockPairs* still = &state.pairs;
    if (moved) {
        restrict_to(0xffff);
        still = &scratch.still;
    }

    // What changed instances blocked is taken out.
    const auto add_changed = [&](std::span<const DirectionCaster> casters, ChunkMasks& found,
                                 BlockPairs& touched) {
        touched.clusters = 0;
        if (scratch.again.clusters == 0) return;
        BlockPairs& open = scratch.open.front() = scratch.again;
        for (const DirectionCaster& caster : casters) {
            scratch.prepared.clusters = 0;
            kernels.add_caster(caster, slab, chunk, open, found, scratch.prepared);
        }
        kernels.find_touched(chunk, scratch.again, found, touched);
    };
    find_near(chunk, slab, *still, casters_before_, scratch.again);
    add_changed(casters_before_, scratch.before, scratch.before_touched);
    for_touched(chunk, scratch.before_touched, [&](std::size_t k, std::size_t block) {
        const std::uint16_t taken = scratch.before.rows[k][block];
        masks.rows[k][block] &= static_cast<std::uint16_t>(~taken);
        if (now.ground) masks.rows[k][block] |= facing_ground(*now.ground, slab, k, chunk, block) & taken;
    });
    // What they block now is put in, where not all is blocked anyway.
    find_near(chunk, slab, *still, casters_now_, scratch.again);
    kernels.keep_open(chunk, masks, scratch.again);
    add_changed(casters_now_, scratch.now, scratch.now_touched);
    for_touched(chunk, scratch.now_touched, [&](std::size_t k, std::size_t block) {
        const std::uint16_t bits = scratch.now.rows[k][block];
        const std::uint32_t old = masks.rows[k][block] | scratch.before.rows[k][block];
        masks.rows[k][block] |= bits;
        set_chunk.computed[block] |= bits;
        set_chunk.changed[block] |= static_cast<std::uint16_t>(bits & ~old);
    });
    // What is left may still be blocked by others.
    scratch.again.clusters = 0;
    for_lines(scratch.before_touched.clusters, [&](std::size_t k) { scratch.again.rows[k].fill(0); });
    for_touched(chunk, scratch.before_touched, [&](std::size_t k, std::size_t block) {
        if ((scratch.before.rows[k][block] & ~masks.rows[k][block]) == 0) return;
        scratch.again.rows[k][block / 16] |= static_cast<std::uint16_t>(1u << block % 16);
        scratch.again.clusters |= 1u << k / kClusterSize;
    });
    if (scratch.again.clusters != 0) ask_again(chunk, masks, slab, now, changes, scratch);
    for_touched(chunk, scratch.before_touched, [&](std::size_t k, std::size_t block) {
        const std::uint16_t bits = scratch.before.rows[k][block];
        set_chunk.computed[block] |= bits;
        set_chunk.changed[block] |= static_cast<std::uint16_t>(bits & ~masks.rows[k][block]);
    });
    clear(chunk, scratch.before_touched, scratch.before);
    clear(chunk, scratch.now_touched, scratch.now);

    // Blocks in a new place, from nothing.
    if (!moved) return;
    for (std::size_t k = 0; k < slab.count; ++k)
        for (std::size_t block = 0; block < chunk.blocks; ++block)
            if (set_chunk.moved[block / 16] >> block % 16 & 1) masks.rows[k][block] = 0;
    restrict_to(0);
    order_casters(now, 0.5f * (chunk.low + chunk.high), scratch);
    const ChunkWork work{&chunk, &scratch.still, &masks};
    add_casters(slab, now, {&work, 1}, scratch);
}

// Lets the unchanged instances block again, among the pairs of scratch.again. For each of their directions
// the lines fill a prism, the ball around the blocks swept along it; all of them lie in a cone around the
// mean direction. Instances that stay clear of the cone are left out, others are asked for the clusters alone
// whose prisms they meet, those that look largest first, since words that are as they were need no more. A
// line has no sense.
void dfield_receiver_set::ask_again(const Chunk& chunk, ChunkMasks& masks, const Slab& slab,
                                    const SceneState& now, const SceneChanges& changes,
                                    UpdateScratch& scratch) const {
    struct Prism {
        Ball ball;
        std::uint32_t k;
    };
    BlockPairs& pairs = scratch.again;
    std::array<Prism, kSlab> prisms;
    alignas(64) std::array<float, kSlab> x, y, z;  // their directions
    std::array<std::uint32_t, kSlab / 32> pass;    // a bit each
    std::size_t count = 0;
    glm::vec3 axis(0), low(INFINITY), high(-INFINITY);
    for_lines(pairs.clusters, [&](std::size_t k) {
        glm::vec3 prism_low(INFINITY), prism_high(-INFINITY);
        for (std::size_t group = 0; group < chunk.groups(); ++group)
            for (std::uint32_t rest = pairs.rows[k][group]; rest != 0; rest &= rest - 1) {
                const std::size_t b = 16 * group + std::countr_zero(rest);
                const glm::vec3 centre(chunk.centre_x[b], chunk.centre_y[b], chunk.centre_z[b]);
                const glm::vec3 half(chunk.half_x[b], chunk.half_y[b], chunk.half_z[b]);
                prism_low = glm::min(prism_low, centre - half);
                prism_high = glm::max(prism_high, centre + half);
            }
        if (!(prism_low.x <= prism_high.x)) return;
        const glm::vec3 w = slab.direction(k);
        x[count] = w.x, y[count] = w.y, z[count] = w.z;
        prisms[count++] = {ball_of(prism_low, prism_high), static_cast<std::uint32_t>(k)};
        axis += w;
        low = glm::min(low, prism_low);
        high = glm::max(high, prism_high);
    });
    const float length = glm::length(axis);
    axis = length > 1e-3f ? axis / length : glm::vec3(0, 0, 1);
    float cosine = 1;
    for (std::size_t i = 0; i < count; ++i)
        cosine = std::min(cosine, axis.x * x[i] + axis.y * y[i] + axis.z * z[i]);
    // The lines start within a ball around the blocks; where few instances have changed they also pass by one
    // of them.
    constexpr float kMargin = 1.0001f;
    constexpr std::size_t kFew = 16;
    std::array<Ball, kFew> passed;
    const std::size_t few = casters_before_.size() <= kFew ? casters_before_.size() : 0;
    for (std::size_t i = 0; i < few; ++i) passed[i] = {casters_before_[i].centre, casters_before_[i].reach};
    const Ball start = ball_of(low, high);
    const std::span<const Ball> gates =
        few > 0 ? std::span<const Ball>(passed.data(), few) : std::span(&start, 1);
    const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
    const auto within_cone = [&](const Ball& gate, const Reach& reach) {
        const glm::vec3 away = reach.centre - gate.centre;
        const float square = glm::dot(away, away), near = kMargin * (reach.radius + gate.radius);
        if (cosine <= 0 || near * near >= square) return true;
        // The angle to the axis is at most the cone's plus the one that both balls are seen under.
        const float bound = cosine * std::sqrt(square - near * near) - sine * near;
        return std::fabs(glm::dot(axis, away)) >= bound - 1e-4f * std::sqrt(square);
    };
    const auto crosses = [&](const Ball& gate, const Reach& reach, const glm::vec3& direction) {
        const glm::vec3 away = reach.centre - gate.centre;
        const float along = glm::dot(away, direction), near = kMargin * (reach.radius + gate.radius);
        return glm::dot(away, away) * 0.999999f - along * along <= near * near;
    };
    scratch.candidates.clear();
    for (const dfield_instance id : now.active) {
        const Reach& reach = reaches_[id];
        if (std::none_of(gates.begin(), gates.end(),
                         [&](const Ball& gate) { return within_cone(gate, reach); }))
            continue;
        if (id < changes.changed.size() && changes.changed[id]) continue;
        const glm::vec3 away = reach.centre - start.centre;
        scratch.candidates.emplace_back(glm::dot(away, away) / (reach.radius * reach.radius), id);
    }
    std::sort(scratch.candidates.begin(), scratch.candidates.end());

    const BatchKernels& kernels = batch_kernels(context()->simd_targets);
    for (const auto& [order, id] : scratch.candidates) {
        const Reach& reach = reaches_[id];
        std::fill_n(pass.begin(), (count + 31) / 32, 0u);
        for (const Ball& gate : gates) {
            const glm::vec3 away = reach.centre - gate.centre;
            const float near = kMargin * (reach.radius + gate.radius);
            kernels.mark_along(x.data(), y.data(), z.data(), count, away,
                               glm::dot(away, away) * 0.999999f - near * near, pass.data());
        }
        pairs.clusters = 0;
        for (std::size_t word = 0; 32 * word < count; ++word)
            for (std::uint32_t rest = pass[word]; rest != 0; rest &= rest - 1) {
                const std::size_t i = 32 * word + static_cast<std::size_t>(std::countr_zero(rest));
                if (i < count && crosses(prisms[i].ball, reach, {x[i], y[i], z[i]}))
                    pairs.clusters |= 1u << prisms[i].k / kClusterSize;
            }
        if (pairs.clusters == 0) continue;
        scratch.prepared.clusters = 0;
        kernels.add_caster(direction_caster(*ao_, now.instances[id], id), slab, chunk, pairs, masks,
                           scratch.prepared);
        std::size_t left = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t k = prisms[i].k;
            std::uint32_t open = 1;
            if (pairs.clusters >> k / kClusterSize & 1) {
                open = 0;
                for (std::size_t group = 0; group < chunk.groups(); ++group)
                    for (std::uint32_t rest = pairs.rows[k][group]; rest != 0; rest &= rest - 1) {
                        const std::size_t b = 16 * group + std::countr_zero(rest);
                        if (scratch.before.rows[k][b] & ~masks.rows[k][b])
                            open = 1;
                        else
                            pairs.rows[k][group] &= static_cast<std::uint16_t>(~(rest & -rest));
                    }
            }
            prisms[left] = prisms[i];
            x[left] = x[i], y[left] = y[i], z[left] = z[i];
            left += open;
        }
        count = left;
        if (count == 0) return;
    }
}

// Of blocks with changed lanes, as batch_visibility.
void dfield_receiver_set::store_visibility(const SetChunk& set_chunk, std::size_t index) {
    const Chunk& chunk = set_chunk.chunk;
    BlockSet changed{};
    for (std::size_t b = 0; b < chunk.blocks; ++b)
        if (set_chunk.changed[b] != 0) changed[b / 16] |= static_cast<std::uint16_t>(1u << b % 16);
    if (changed == BlockSet{}) return;
    alignas(64) std::array<float, kChunkReceivers> values;
    std::fill_n(values.begin(), chunk.blocks * kLanes, 0.0f);
    const BatchKernels& kernels = batch_kernels(context()->simd_targets);
    const std::size_t slabs = slab_count(ao_->shared);
    for (std::size_t s = 0; s < slabs; ++s) {
        const Slab slab(ao_->shared, s);
        kernels.add_occluded(slab, chunk, slabs_[index * slabs + s].masks, changed, values.data());
    }
    kernels.finish_visibility(ao_->shared, chunk, values.data());
    for (std::size_t b = 0; b < chunk.blocks; ++b) {
        if (set_chunk.changed[b] == 0) continue;
        for (std::size_t i = b * kLanes; i < (b + 1) * kLanes; ++i) {
            const std::uint32_t receiver = set_chunk.receiver[i];
            if (receiver == kNoReceiver) continue;
            const bool placed = chunk.lanes[b] >> i % kLanes & 1;
            visibility[receiver] = (placed ? values[i] : 1.0f) * receivers_[receiver].self_visibility;
        }
    }
}
