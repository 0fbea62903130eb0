// What the kernels of batches share: receivers in blocks of sixteen, blocks in chunks, and a mask word of
// sixteen receivers for each direction and block.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "batch/shared_directions.hpp"
#include "dfield/dfield.h"
#include "format/direction_maps.hpp"
#include "scene.hpp"

namespace dfield::runtime {

inline constexpr std::size_t kLanes = 16;         // receivers in a block
inline constexpr std::size_t kChunkBlocks = 128;  // blocks in a chunk; a multiple of kLanes
inline constexpr std::size_t kSlab = 512;         // directions at a time

// Receivers of a chunk. Lanes without a receiver repeat one; blocks beyond `blocks`, up to a multiple of
// kLanes, have boxes that nothing meets.
struct Chunk {
    std::size_t blocks = 0;
    alignas(64) std::array<float, kChunkBlocks * kLanes> x, y, z;     // world
    alignas(64) std::array<float, kChunkBlocks * kLanes> nx, ny, nz;  // unit normals, world
    alignas(64) std::array<float, kChunkBlocks> centre_x, centre_y, centre_z, half_x, half_y,
        half_z;  // boxes
    // Normals of a block lie within a cone: n.axis >= cosine.
    alignas(64) std::array<float, kChunkBlocks> axis_x, axis_y, axis_z, sine;
    alignas(64) std::array<std::uint16_t, kChunkBlocks> lanes;  // bits of the lanes that hold a receiver
    std::array<dfield_instance, kChunkBlocks * kLanes> owners;  // DFIELD_NO_INSTANCE for none
    bool any_owner = false;
    // Of all boxes, and of sixteen blocks together.
    glm::vec3 low, high;
    std::array<glm::vec3, kChunkBlocks / 16> group_low, group_high;
};

// Of each direction of a slab, in cluster order, and each block: which receivers are blocked. Direction by
// direction, so that one direction's map meets all blocks while it is in registers. Bits of receivers that do
// not face the direction, and of lanes without a receiver, mean nothing.
struct ChunkMasks {
    alignas(64) std::array<std::array<std::uint16_t, kChunkBlocks>, kSlab> rows;

    // Nothing blocked yet in directions [0, directions).
    void clear(const Chunk& chunk, std::size_t directions) {
        for (std::size_t k = 0; k < directions; ++k)
            std::fill_n(rows[k].begin(), (chunk.blocks + 15) / 16 * 16, std::uint16_t{0});
    }
};

// Of each direction of a slab: which blocks have a receiver that faces it; 16 blocks a word.
struct ChunkFacing {
    alignas(64) std::array<std::array<std::uint16_t, kChunkBlocks / 16>, kSlab> rows;
    std::uint32_t clusters = 0;  // bit c: any block faces a direction of cluster c of the slab
};

// Directions [first, first + count) in cluster order; both multiples of kClusterSize, count at most kSlab.
struct Slab {
    const SharedDirections& shared;
    std::size_t first, count;
};

// An instance whose field has direction maps.
struct DirectionCaster {
    const Instance& instance;
    const DirectionMaps& maps;
    glm::vec3 centre;  // of the bounding sphere, world
    float reach;       // world: where a line that hits crosses its pivot plane lies within it of `centre`
    float bias;  // world: hits nearer than this do not count, unless the object lies in front of the receiver
    dfield_instance id;
    // All levels of detail, coarse first, of which `maps` is the finest; empty where it is the only one to
    // read.
    std::span<const DirectionMaps> levels = {};
    const float* disagreements = nullptr;  // of each level: field_levels.hpp
    float level_error = 0;
    // Receivers that read `maps`: those whose squared distance from the bounding sphere's centre, in radii,
    // lies within [from, to).
    float from = 0, to = std::numeric_limits<float>::infinity();
};

// Calls look_up(caster) for each level of detail with the receivers that read it. A level whose lines
// disagree with the finest one's in a share p errs by at most p / D^2 at distance D (in radii): the sphere's
// cosine-weighted share of the hemisphere is at most 1 / D^2. A receiver reads the coarsest level for which
// that is at most level_error.
template<class LookUp>
void for_levels(const DirectionCaster& caster, const LookUp& look_up) {
    if (caster.levels.empty()) return look_up(caster);
    float to = std::numeric_limits<float>::infinity();
    for (std::size_t level = 0; level < caster.levels.size(); ++level) {
        const bool finest = level + 1 == caster.levels.size();
        const float from = finest ? 0 : std::min(caster.disagreements[level] / caster.level_error, to);
        if (from < to)
            look_up(DirectionCaster{caster.instance,
                                    caster.levels[level],
                                    caster.centre,
                                    caster.reach,
                                    caster.bias,
                                    caster.id,
                                    {},
                                    nullptr,
                                    0,
                                    from,
                                    to});
        to = from;
    }
}

// The kernels, one form a level of SIMD; reference.cpp has the one that reads like the method.
struct Loaded;
struct BatchKernels {
    // Packed receivers into loaded.count places: all but its cells.
    void (*load_packed)(const float* positions, const float* normals, Loaded& loaded);
    void (*find_cells)(Loaded& loaded);
    // Which blocks face which directions.
    void (*find_facing)(const Chunk& chunk, const Slab& slab, ChunkFacing& facing);
    // Ors into the masks the pairs that the caster blocks.
    void (*add_caster)(const DirectionCaster& caster, const Slab& slab, const Chunk& chunk,
                       const ChunkFacing& facing, ChunkMasks& masks);
    // Adds weight * max(0, n.w) of blocked pairs to occluded[receiver].
    void (*add_occluded)(const Slab& slab, const Chunk& chunk, const ChunkMasks& masks, float* occluded);
    // Of sums of all slabs, in place: visibility, 1 - occluded / SharedDirections::total.
    void (*finish_visibility)(const SharedDirections& shared, const Chunk& chunk, float* values);
};
const BatchKernels& batch_kernels(std::int64_t targets);  // dfield_context::simd_targets
extern const BatchKernels kReferenceKernels;

}  // namespace dfield::runtime
