// Receivers of a set into chunks and blocks: those of a block lie near each other, face alike, and move
// together.
#include <algorithm>
#include <glm/common.hpp>
#include <span>

#include "batch/chunk_builder.hpp"
#include "halves.hpp"
#include "receiver_set.hpp"
#include "receivers.hpp"

namespace dfield::runtime {
namespace {

struct Place {
    std::uint32_t receiver;
    dfield_instance attached;
    std::uint32_t side;  // which axis the normal is nearest to, and its sign
    glm::vec3 position;
};
using Places = std::span<Place>;

template<class Key>
void sort_by(Places places, const Key& key) {
    std::sort(places.begin(), places.end(), [&](const Place& a, const Place& b) {
        return key(a) != key(b) ? key(a) < key(b) : a.receiver < b.receiver;
    });
}

void halve_places(Places places, std::size_t unit) {
    halve(
        places, unit, [](const Place& place) { return place.position; },
        [](const Place& place) { return place.receiver; });
}

std::pmr::vector<Place> usable_places(const std::pmr::vector<SetReceiver>& receivers) {
    std::pmr::vector<Place> places(receivers.get_allocator());
    places.reserve(receivers.size());
    for (std::uint32_t i = 0; i < receivers.size(); ++i) {
        if (!unit_receiver(receivers[i].position, receivers[i].normal, 0).usable()) continue;
        const glm::vec3 n = receivers[i].normal, size = glm::abs(n);
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        places.push_back({i, receivers[i].attached, static_cast<std::uint32_t>(2 * axis + (n[axis] < 0)),
                          receivers[i].position});
    }
    return places;
}

// Receivers of one chunk: those that face alike together, in groups of sixteen blocks, in blocks.
void order_chunk(Places places) {
    sort_by(places, [](const Place& place) { return place.side; });
    for (auto begin = places.begin(); begin != places.end();) {
        const auto end =
            std::find_if(begin, places.end(), [&](const Place& place) { return place.side != begin->side; });
        constexpr std::size_t kGroup = 16 * kLanes;
        halve_places({begin, end}, kGroup);
        for (Places rest(begin, end); !rest.empty(); rest = rest.subspan(std::min(rest.size(), kGroup)))
            halve_places(rest.first(std::min(rest.size(), kGroup)), kLanes);
        begin = end;
    }
}

}  // namespace
}  // namespace dfield::runtime

void dfield_receiver_set::arrange() {
    using namespace dfield::runtime;
    std::pmr::vector<Place> places = usable_places(receivers_);
    sort_by(places, [](const Place& place) { return place.attached; });  // to nothing: last
    for (auto begin = places.begin(); begin != places.end();) {
        const auto end = std::find_if(begin, places.end(),
                                      [&](const Place& place) { return place.attached != begin->attached; });
        halve_places({begin, end}, kChunkReceivers);
        begin = end;
    }
    std::size_t blocks = kChunkBlocks;  // used in the last chunk
    for (auto begin = places.begin(); begin != places.end();) {
        if (blocks == kChunkBlocks) {
            chunks_.emplace_back();
            chunks_.back().receiver.fill(kNoReceiver);
            chunks_.back().attached.fill(DFIELD_NO_INSTANCE);
            blocks = 0;
        }
        const auto room = static_cast<std::ptrdiff_t>((kChunkBlocks - blocks) * kLanes);
        auto end = std::find_if(begin, places.end(),
                                [&](const Place& place) { return place.attached != begin->attached; });
        if (end - begin > room) end = begin + room;
        order_chunk({begin, end});
        SetChunk& chunk = chunks_.back();
        std::size_t lane = blocks * kLanes;
        for (auto place = begin; place != end; ++place) {
            chunk.attached[lane / kLanes] = place->attached;
            chunk.receiver[lane++] = place->receiver;
        }
        blocks = (lane + kLanes - 1) / kLanes;
        chunk.chunk.blocks = blocks;
        begin = end;
    }
    const BatchKernels& kernels = batch_kernels(context()->simd_targets);
    for (SetChunk& chunk : chunks_) {
        chunk.moved = {};
        for (std::size_t block = 0; block < chunk.chunk.blocks; ++block) place_block(chunk, block, nullptr);
        finish_chunk(kernels, chunk.chunk);
    }
}

// now: null before the first update, when attached receivers are nowhere.
void dfield_receiver_set::place_block(SetChunk& set_chunk, std::size_t block, const SceneState* now) {
    using namespace dfield::runtime;
    Chunk& chunk = set_chunk.chunk;
    const dfield_instance attached = set_chunk.attached[block];
    const Instance* carrier = nullptr;
    if (attached != DFIELD_NO_INSTANCE && now && attached < now->instances.size() &&
        now->instances[attached].field)
        carrier = &now->instances[attached];
    UnitReceiver spare{glm::vec3(0), glm::vec3(0, 0, 1),
                       DFIELD_NO_INSTANCE};  // what lanes without a receiver repeat
    chunk.lanes[block] = 0;
    for (int pass = 0; pass < 2; ++pass)  // first those that are somewhere
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t at = block * kLanes + lane;
            UnitReceiver placed = spare;
            if (pass == 0) {
                if (set_chunk.receiver[at] == kNoReceiver || (attached != DFIELD_NO_INSTANCE && !carrier))
                    continue;
                const SetReceiver& given = receivers_[set_chunk.receiver[at]];
                glm::vec3 position = given.position, normal = given.normal;
                if (carrier) {
                    position = carrier->object_to_world * glm::vec4(position, 1);
                    // Planes are carried by the inverse's transpose; to_unit is the inverse, scaled.
                    normal = normal * carrier->to_unit;
                    normal /= std::max({std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)});
                }
                placed = unit_receiver(position, normal, given.owner);
                if (!placed.usable()) continue;
                spare = placed;
                chunk.lanes[block] |= static_cast<std::uint16_t>(1u << lane);
            } else if (chunk.lanes[block] >> lane & 1) {
                continue;
            } else {
                placed.owner = DFIELD_NO_INSTANCE;
            }
            chunk.x[at] = placed.position.x;
            chunk.y[at] = placed.position.y;
            chunk.z[at] = placed.position.z;
            chunk.nx[at] = placed.normal.x;
            chunk.ny[at] = placed.normal.y;
            chunk.nz[at] = placed.normal.z;
            chunk.owners[at] = placed.owner;
            chunk.any_owner |= placed.owner != DFIELD_NO_INSTANCE;
        }
    set_chunk.moved[block / 16] |= static_cast<std::uint16_t>(1u << block % 16);
}

void dfield_receiver_set::place_attached(const SceneState& now, const SceneChanges& changes) {
    using namespace dfield::runtime;
    const BatchKernels& kernels = batch_kernels(context()->simd_targets);
    for (SetChunk& chunk : chunks_) {
        chunk.moved = {};
        for (std::size_t block = 0; block < chunk.chunk.blocks; ++block) {
            const dfield_instance attached = chunk.attached[block];
            if (attached == DFIELD_NO_INSTANCE) continue;
            if (changes.all || (attached < changes.changed.size() && changes.changed[attached]))
                place_block(chunk, block, &now);
        }
        if (chunk.moved != BlockSet{}) finish_chunk(kernels, chunk.chunk);
    }
}
