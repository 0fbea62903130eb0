// The batch kernels as the method reads: every receiver, every direction, nothing culled.
#include <cmath>

#include "batch/chunk.hpp"
#include "batch/confirm.hpp"
#include "batch/direction_lookup.hpp"
#include "batch/ground.hpp"
#include "batch/loaded.hpp"

namespace dfield::runtime {
namespace {

void load_packed(const float* positions, const float* normals, Loaded& loaded) {
    dfield_receivers receivers{};
    receivers.positions = positions;
    receivers.normals = normals;
    load_receivers(receivers, 0, loaded);
}

void find_cells(Loaded& loaded) {
    const float scale = loaded.cell_scale();
    for (std::size_t i = 0; i < loaded.count; ++i) {
        const glm::vec3 position(loaded.x[i], loaded.y[i], loaded.z[i]);
        const glm::vec3 normal(loaded.nx[i], loaded.ny[i], loaded.nz[i]), n = glm::abs(normal);
        const int axis = n.x >= std::max(n.y, n.z) ? 0 : n.y >= n.z ? 1 : 2;
        const auto place = [&](int a) {
            const float cell = std::clamp((position[a] - loaded.low[a]) * scale, 0.0f, 15.0f);
            return spread(static_cast<std::uint32_t>(cell));
        };
        loaded.cells[i] = n.x + n.y + n.z > 0
                              ? static_cast<std::uint32_t>(2 * axis + (normal[axis] < 0)) << 2 * kCellBits |
                                    place((axis + 1) % 3) << 1 | place((axis + 2) % 3)
                              : kNoCell;
    }
}

BlockBounds bound_block(const Chunk& chunk, std::size_t block) {
    BlockBounds bounds{glm::vec3(INFINITY), glm::vec3(-INFINITY), glm::vec3(0), 1};
    const std::size_t begin = block * kLanes, end = begin + kLanes;
    bool flat = true;
    for (std::size_t i = begin; i < end; ++i) {
        bounds.low = glm::min(bounds.low, chunk.position(i));
        bounds.high = glm::max(bounds.high, chunk.position(i));
        bounds.axis += chunk.normal(i);
        flat &= chunk.normal(i) == chunk.normal(begin);
    }
    if (flat) {
        bounds.axis = chunk.normal(begin);
        return bounds;
    }
    const float length = glm::length(bounds.axis);
    if (length > 0) bounds.axis /= length;
    for (std::size_t i = begin; i < end; ++i)
        bounds.cosine = std::min(bounds.cosine, glm::dot(bounds.axis, chunk.normal(i)));
    bounds.cosine = std::min(bounds.cosine, kLargestCosine);
    return bounds;
}

void find_pairs(const Chunk& chunk, const Slab& slab, BlockPairs& pairs) {
    pairs.clusters = ~0u >> (32 - slab.count / kClusterSize);  // those that the slab has
    for (std::size_t k = 0; k < slab.count; ++k)
        for (std::size_t g = 0; g < chunk.groups(); ++g) pairs.rows[k][g] = chunk.blocks_of_group(g);
}

void add_ground(const Plane& ground, const Slab& slab, const Chunk& chunk, ChunkMasks& masks) {
    for (std::size_t k = 0; k < slab.count; ++k)
        for (std::size_t b = 0; b < chunk.blocks; ++b)
            masks.rows[k][b] |= facing_ground(ground, slab, k, chunk, b);
}

void add_level(const DirectionCaster& caster, const Slab& slab, const Chunk& chunk, BlockPairs& pairs,
               ChunkMasks& masks) {
    for (std::size_t k = 0; k < slab.count; ++k) {
        const DirectionLookup lookup(caster.maps, caster.instance, slab.direction(k));
        for (std::size_t b = 0; b < chunk.blocks; ++b) {
            if (!(pairs.clusters >> k / kClusterSize & 1) || !(pairs.rows[k][b / 16] >> b % 16 & 1)) continue;
            std::uint16_t bits = 0;
            for (std::size_t lane = 0; lane < kLanes; ++lane) {
                const std::size_t i = b * kLanes + lane;
                if (!(chunk.lanes[b] >> lane & 1) || chunk.owners[i] == caster.id) continue;
                const glm::vec3 position = chunk.position(i), normal = chunk.normal(i);
                const ReceiverSide side = side_of_receiver(caster, position, normal);
                const glm::vec3 ray = slab.towards(k, slab.faced_end(k, normal));
                const glm::vec3 w = caster.instance.carry_direction(ray);
                MapPlace place;
                if (!side.behind && !(side.near_box && side.leaving.leaves(w.x, w.y, w.z)) &&
                    lookup.hits(position, place) && (!side.cut || hit_is_ahead(caster, position, ray, place)))
                    bits |= static_cast<std::uint16_t>(1u << lane);
            }
            masks.rows[k][b] |= bits;
        }
    }
}

void add_caster(const DirectionCaster& caster, const Slab& slab, const Chunk& chunk, BlockPairs& pairs,
                ChunkMasks& masks, PreparedLines&) {
    for_levels(caster, [&](const DirectionCaster& level) { add_level(level, slab, chunk, pairs, masks); });
}

void keep_open(const Chunk& chunk, const ChunkMasks& masks, BlockPairs& pairs) {
    for_lines(pairs.clusters, [&](std::size_t k) {
        for (std::size_t b = 0; b < chunk.blocks; ++b)
            if (masks.rows[k][b] == chunk.lanes[b])
                pairs.rows[k][b / 16] &= static_cast<std::uint16_t>(~(1u << b % 16));
    });
}

void find_touched(const Chunk& chunk, const BlockPairs& asked, const ChunkMasks& masks, BlockPairs& touched) {
    touched.clusters = asked.clusters;
    for_lines(asked.clusters, [&](std::size_t k) {
        touched.rows[k].fill(0);
        for (std::size_t b = 0; b < chunk.blocks; ++b)
            if (asked.rows[k][b / 16] != 0 && masks.rows[k][b] != 0)
                touched.rows[k][b / 16] |= static_cast<std::uint16_t>(1u << b % 16);
    });
}

void mark_along(const float* x, const float* y, const float* z, std::size_t count, const glm::vec3& away,
                float least, std::uint32_t* bits) {
    for (std::size_t i = 0; i < count; ++i) {
        const float along = x[i] * away.x + y[i] * away.y + z[i] * away.z;
        bits[i / 32] |= std::uint32_t{along * along >= least} << i % 32;
    }
}

void add_occluded(const Slab& slab, const Chunk& chunk, const ChunkMasks& masks, const BlockSet& blocks,
                  float* occluded) {
    for (std::size_t k = 0; k < slab.count; ++k)
        for (std::size_t i = 0; i < chunk.blocks * kLanes; ++i) {
            if (!(blocks[i / kLanes / 16] >> i / kLanes % 16 & 1)) continue;
            if (!(masks.rows[k][i / kLanes] >> i % kLanes & 1)) continue;
            const int end = slab.faced_end(k, chunk.normal(i));
            occluded[i] += slab.shared.weight[end][slab.first + k] *
                           std::fabs(glm::dot(chunk.normal(i), slab.direction(k)));
        }
}

void finish_visibility(const SharedDirections& shared, const Chunk& chunk, float* values) {
    for (std::size_t i = 0; i < chunk.blocks * kLanes; ++i)
        values[i] = values[i] > 0 ? std::max(0.0f, 1 - values[i] / shared.total(chunk.normal(i))) : 1.0f;
}

}  // namespace

const BatchKernels kReferenceKernels{load_packed, find_cells,   bound_block,      find_pairs,
                                     add_ground,  add_caster,   keep_open,        find_touched,
                                     mark_along,  add_occluded, finish_visibility};

}  // namespace dfield::runtime
