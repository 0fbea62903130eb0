// Receivers that stay from frame to frame, in the chunks that batches work on, with what blocks them.
//
// An update takes three steps for every chunk. What changed instances blocked before is looked up again, from
// the state of the last update, and taken out of the masks. Since a pair of receiver and direction may be
// blocked by several instances, the others are asked again, for these pairs alone. Then what changed
// instances block now is put in. All look-ups are those of a computation from scratch, so the masks are the
// same bits.
#pragma once

#include <array>
#include <cstdint>
#include <memory_resource>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "ao.hpp"
#include "batch/batch.hpp"
#include "batch/prepared.hpp"
#include "scene.hpp"

namespace dfield::runtime {

// Which of a chunk's blocks; sixteen a word, as in ChunkMasks.

inline constexpr std::size_t kChunkReceivers = kChunkBlocks * kLanes;
inline constexpr std::uint32_t kNoReceiver = 0xffffffff;

struct SetChunk {
    Chunk chunk;
    std::array<std::uint32_t, kChunkReceivers> receiver;  // by lane, kNoReceiver for none
    std::array<dfield_instance, kChunkBlocks> attached;   // by block, DFIELD_NO_INSTANCE for none
    // What the last update did:
    std::array<std::uint16_t, kChunkBlocks> computed,
        changed;     // lanes it looked at, and whose result may differ
    BlockSet moved;  // blocks that it placed anew
};

// What blocks a chunk's receivers, for one slab of lines.
struct SlabMasks {
    ChunkMasks masks;
    BlockPairs pairs;  // that the ground does not block altogether
};

// The block's receivers for a query; those that are nowhere get no normal.
struct BlockReceivers {
    std::array<glm::vec3, kLanes> positions, normals;
    dfield_receivers view{};

    BlockReceivers(const Chunk& chunk, std::size_t block) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t i = block * kLanes + lane;
            const bool placed = chunk.lanes[block] >> lane & 1;
            positions[lane] = {chunk.x[i], chunk.y[i], chunk.z[i]};
            normals[lane] = placed ? glm::vec3(chunk.nx[i], chunk.ny[i], chunk.nz[i]) : glm::vec3(0);
        }
        view.count = kLanes;
        view.positions = &positions.front().x;
        view.normals = &normals.front().x;
        view.owners = &chunk.owners[block * kLanes];
    }
};

// Given receivers, in the caller's order.
struct SetReceiver {
    glm::vec3 position, normal;  // of the attached instance's object space, or of the world
    dfield_instance owner, attached;
    float self_visibility;
};

// How the last update's scene and the new one differ.
struct SceneChanges {
    explicit SceneChanges(std::pmr::memory_resource* memory) : before(memory), now(memory), changed(memory) {}

    std::pmr::vector<dfield_instance> before;  // active in the old state, gone or different now
    std::pmr::vector<dfield_instance> now;     // active in the new state, and not so in the old one
    std::pmr::vector<bool> changed;            // by id: another revision, whether active or not
    std::size_t instances = 0;
    bool all = false;  // nothing of the old results is of use
};

// Buffers of one thread. The masks are all zero between uses.
struct UpdateScratch {
    static constexpr std::size_t kTogether = 4;  // chunks that share what is prepared of each caster

    explicit UpdateScratch(std::pmr::memory_resource* memory) : candidates(memory) {}

    ChunkMasks before{}, now{};
    BlockPairs before_touched, now_touched, still, again;
    std::array<BlockPairs, kTogether> open;
    PreparedLines prepared;
    std::pmr::vector<std::pair<float, dfield_instance>> candidates;  // has room for all active instances
};

// What is left to ask about of a chunk, and what was found.
struct ChunkWork {
    const Chunk* chunk;
    BlockPairs* pairs;
    ChunkMasks* masks;
};

// How far from `centre` a line can pass that an instance blocks.
struct Reach {
    glm::vec3 centre;
    float radius;
};

}  // namespace dfield::runtime

struct dfield_receiver_set final : dfield::runtime::Shared<dfield_receiver_set> {
    dfield_receiver_set(dfield_context* context, const dfield_receiver_set_desc& desc);
    ~dfield_receiver_set();

    void update(dfield_snapshot* snapshot, dfield_update_stats* stats);
    void write_outputs(const dfield_outputs& outputs, bool only_changed) const;

    std::pmr::vector<float> visibility;  // in the caller's order
    std::pmr::vector<std::uint32_t> changed;

  private:
    using SceneState = dfield::runtime::SceneState;
    using SceneChanges = dfield::runtime::SceneChanges;
    using SetChunk = dfield::runtime::SetChunk;

    // receiver_order.cpp: into chunks and blocks, once; and where attached ones are now.
    void arrange();
    void place_attached(const SceneState& now, const SceneChanges& changes);
    void place_block(SetChunk& chunk, std::size_t block, const SceneState* now);

    // receiver_set.cpp
    SceneChanges changes_to(const SceneState& now, bool batched) const;
    void find_casters(const SceneState* before, const SceneState& now, const SceneChanges& changes);
    dfield::runtime::UpdateScratch* take_scratch(std::size_t instances);  // throws std::bad_alloc
    void give_scratch(dfield::runtime::UpdateScratch* scratch);

    // receiver_update.cpp: where direction maps answer. Chunks [begin, end), at most
    // UpdateScratch::kTogether, from scratch; one chunk after some instances have changed.
    void update_all(std::size_t begin, std::size_t end, const SceneState& now,
                    dfield::runtime::UpdateScratch& scratch);
    void update_changed(std::size_t index, const SceneState& now, const SceneChanges& changes,
                        dfield::runtime::UpdateScratch& scratch);
    void find_pairs(const dfield::runtime::Chunk& chunk, const dfield::runtime::Slab& slab,
                    const SceneState& now, dfield::runtime::BlockPairs& pairs,
                    dfield::runtime::UpdateScratch& scratch) const;
    void order_casters(const SceneState& now, const glm::vec3& middle,
                       dfield::runtime::UpdateScratch& scratch) const;
    void add_casters(const dfield::runtime::Slab& slab, const SceneState& now,
                     std::span<const dfield::runtime::ChunkWork> chunks,
                     dfield::runtime::UpdateScratch& scratch) const;
    void update_slab(SetChunk& chunk, dfield::runtime::SlabMasks& state, const dfield::runtime::Slab& slab,
                     const SceneState& now, const SceneChanges& changes,
                     dfield::runtime::UpdateScratch& scratch);
    void ask_again(const dfield::runtime::Chunk& chunk, dfield::runtime::ChunkMasks& masks,
                   const dfield::runtime::Slab& slab, const SceneState& now, const SceneChanges& changes,
                   dfield::runtime::UpdateScratch& scratch) const;
    void store_visibility(const SetChunk& chunk, std::size_t index);

    // receiver_outputs.cpp: masks of a block's lanes, in the caller's order of rays.
    void block_masks(std::size_t index, std::size_t block, std::uint32_t* masks) const;

    // receiver_rays.cpp: the same by rays, receiver by receiver. `before` is null where all changes.
    void update_by_rays(SetChunk& chunk, const SceneState* before, const SceneState& now,
                        const SceneChanges& changes);

    dfield_ao* ao_;
    dfield_snapshot* last_ = nullptr;  // of the last update that succeeded
    bool batched_ = false;             // which of the two ways it took
    std::pmr::vector<dfield::runtime::SetReceiver> receivers_;
    std::pmr::vector<SetChunk> chunks_;
    std::pmr::vector<dfield::runtime::SlabMasks> slabs_;  // of chunk 0, of chunk 1, ...; empty until needed
    std::pmr::vector<dfield::runtime::Reach> reaches_;    // by id, of active instances
    std::pmr::vector<dfield::runtime::DirectionCaster> casters_before_,
        casters_now_;  // changed ones, in an update
    std::mutex scratch_mutex_;
    std::pmr::vector<dfield::runtime::UpdateScratch*> idle_;  // scratch that no thread uses; has room for all
    std::size_t scratch_count_ = 0;
};
