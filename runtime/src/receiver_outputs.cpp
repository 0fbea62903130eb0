// Receiver sets through the C ABI, and what is written of them.
#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>

#include "ambient.hpp"
#include "gather.hpp"
#include "kind.hpp"
#include "receiver_set.hpp"
#include "receivers.hpp"
#include "status.hpp"

using namespace dfield::runtime;

void dfield_receiver_set::block_masks(std::size_t index, std::size_t block, std::uint32_t* masks) const {
    const Chunk& chunk = chunks_[index].chunk;
    const std::size_t words = ao_->mask_words();
    const BlockReceivers receivers(chunk, block);
    std::fill_n(masks, kLanes * words, 0u);
    if (!last_) return;
    if (!batched_) return receiver_masks(last_->scene.state, *ao_, receivers.view, {masks, 0, words});
    const std::size_t slabs = slab_count(ao_->shared);
    for (std::size_t s = 0; s < slabs; ++s) {
        const Slab slab(ao_->shared, s);
        const ChunkMasks& blocked = slabs_[index * slabs + s].masks;
        for (std::size_t k = 0; k < slab.count; ++k)
            for (std::uint32_t bits = blocked.rows[k][block] & chunk.lanes[block]; bits != 0;
                 bits &= bits - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
                const std::uint32_t ray = slab.faced_ray(k, receivers.normals[lane]);
                if (ray != SharedDirections::kNoRay) masks[lane * words + (ray >> 5)] |= 1u << (ray & 31);
            }
    }
}

void dfield_receiver_set::write_outputs(const dfield_outputs& outputs, bool only_changed) const {
    const OutputWriter writer(*ao_, outputs);
    const bool needs_masks = writer.masks() || writer.wants_moments();
    if (needs_masks && last_) require_kinds(*ao_, last_->scene.state, true);
    const std::size_t words = ao_->mask_words();
    context()->for_ranges(chunks_.size(), [&](std::size_t begin, std::size_t end) {
        std::array<std::uint32_t, kLanes*(DFIELD_MAX_RAYS / 32)> masks;
        for (std::size_t index = begin; index < end; ++index)
            for (std::size_t b = 0; b < chunks_[index].chunk.blocks; ++b) {
                const SetChunk& set_chunk = chunks_[index];
                const Chunk& chunk = set_chunk.chunk;
                if (only_changed && set_chunk.changed[b] == 0) continue;
                if (needs_masks) block_masks(index, b, masks.data());
                for (std::size_t lane = 0; lane < kLanes; ++lane) {
                    const std::size_t i = b * kLanes + lane;
                    const std::uint32_t receiver = set_chunk.receiver[i];
                    if (receiver == kNoReceiver || (only_changed && !(set_chunk.changed[b] >> lane & 1)))
                        continue;
                    const bool placed = chunk.lanes[b] >> lane & 1;
                    if (needs_masks)
                        writer.write(receiver,
                                     placed ? glm::vec3(chunk.nx[i], chunk.ny[i], chunk.nz[i]) : glm::vec3(0),
                                     &masks[lane * words], visibility[receiver]);
                    else
                        writer.write_visibility(receiver, visibility[receiver]);
                }
            }
    });
    if (only_changed) return;
    // Those that are in no block.
    const std::array<std::uint32_t, DFIELD_MAX_RAYS / 32> open{};
    for (std::size_t i = 0; i < receivers_.size(); ++i)
        if (!unit_receiver(receivers_[i].position, receivers_[i].normal, 0).usable())
            writer.write(i, glm::vec3(0), open.data(), visibility[i]);
}

extern "C" {

dfield_status dfield_receiver_set_create(dfield_context* context, const dfield_receiver_set_desc* desc,
                                         dfield_receiver_set** set) {
    return guarded([&] {
        require(context && desc && set, "dfield_receiver_set_create: context, desc or set is null");
        require(desc->struct_size == sizeof(dfield_receiver_set_desc),
                "dfield_receiver_set_create: desc->struct_size is not sizeof(dfield_receiver_set_desc)");
        require(desc->ao, "dfield_receiver_set_create: desc->ao is null");
        const dfield_receivers& receivers = desc->receivers;
        require(receivers.count == 0 || (receivers.positions && receivers.normals),
                "dfield_receiver_set_create: the receivers' positions or normals are null");
        require(receivers.count < kNoReceiver, "dfield_receiver_set_create: more than 2^32 - 2 receivers");
        *set = dfield_receiver_set::make(context, *desc);
    });
}

void dfield_receiver_set_release(dfield_receiver_set* set) {
    if (set) set->release();
}

dfield_status dfield_receiver_set_update(dfield_receiver_set* set, dfield_snapshot* snapshot,
                                         dfield_update_stats* stats) {
    return guarded([&] {
        require(set && snapshot, "dfield_receiver_set_update: set or snapshot is null");
        require(snapshot->context() == set->context(),
                "dfield_receiver_set_update: set and snapshot are of different contexts");
        set->update(snapshot, stats);
    });
}

const float* dfield_receiver_set_get_visibility(const dfield_receiver_set* set) {
    return set ? set->visibility.data() : nullptr;
}

const uint32_t* dfield_receiver_set_get_changed(const dfield_receiver_set* set, size_t* count) {
    if (count) *count = set ? set->changed.size() : 0;
    return set ? set->changed.data() : nullptr;
}

dfield_status dfield_receiver_set_get_outputs(const dfield_receiver_set* set, const dfield_outputs* outputs,
                                              int only_changed) {
    return guarded([&] {
        require(set && outputs, "dfield_receiver_set_get_outputs: set or outputs is null");
        set->write_outputs(*outputs, only_changed != 0);
    });
}
}
