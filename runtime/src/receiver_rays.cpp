// Updates of a receiver set where rays answer: receivers are computed from scratch, those alone that a
// changed instance may affect where it was or where it is.
#include <cmath>
#include <glm/geometric.hpp>

#include "ambient.hpp"
#include "receiver_set.hpp"

namespace dfield::runtime {
namespace {

// Whether an instance may block a receiver of the block. Conservative.
bool may_block(const Instance& instance, const dfield_ao& ao, const Chunk& chunk, std::size_t b) {
    const glm::vec3 half = 0.5f * (instance.bounds.high - instance.bounds.low);
    const glm::vec3 block_half(chunk.half_x[b], chunk.half_y[b], chunk.half_z[b]);
    const glm::vec3 away =
        instance.bounds.low + half - glm::vec3(chunk.centre_x[b], chunk.centre_y[b], chunk.centre_z[b]);
    const float distance = glm::length(away), reach = 1.0001f * (glm::length(half) + glm::length(block_half));
    if (distance - reach > ao.max_distance) return false;
    // Normals lie within a cone; how far off its axis one is bounds by how much more it faces the instance.
    const glm::vec3 axis(chunk.axis_x[b], chunk.axis_y[b], chunk.axis_z[b]);
    return glm::dot(axis, away) + 1.42f * chunk.sine[b] * distance + reach > 0;
}

}  // namespace
}  // namespace dfield::runtime

using namespace dfield::runtime;

void dfield_receiver_set::update_by_rays(SetChunk& set_chunk, const SceneState* before, const SceneState& now,
                                         const SceneChanges& changes) {
    const Chunk& chunk = set_chunk.chunk;
    for (std::size_t b = 0; b < chunk.blocks; ++b) {
        bool affected = !before || (set_chunk.moved[b / 16] >> b % 16 & 1);
        for (std::size_t i = 0; i < changes.before.size() && !affected; ++i)
            affected = may_block(before->instances[changes.before[i]], *ao_, chunk, b);
        for (std::size_t i = 0; i < changes.now.size() && !affected; ++i)
            affected = may_block(now.instances[changes.now[i]], *ao_, chunk, b);
        if (!affected) continue;

        const BlockReceivers receivers(chunk, b);
        std::array<float, kLanes> values;
        receiver_visibility(now, *ao_, receivers.view, {values.data(), 0, 1});
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::uint32_t receiver = set_chunk.receiver[b * kLanes + lane];
            if (receiver == kNoReceiver) continue;
            const float value = values[lane] * receivers_[receiver].self_visibility;
            set_chunk.computed[b] |= static_cast<std::uint16_t>(1u << lane);
            set_chunk.changed[b] |= static_cast<std::uint16_t>(1u << lane);
            visibility[receiver] = value;
        }
    }
}
