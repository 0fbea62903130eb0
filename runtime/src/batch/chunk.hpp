// What the kernels of batches share: receivers in blocks of sixteen, blocks in chunks, and a mask word of
// sixteen receivers for each line and block.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
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
inline constexpr std::size_t kSlab = 256;         // lines at a time

struct GroupBox {
    glm::vec3 middle, half;
    float radius;  // half its diagonal
};

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
    glm::vec3 low, high;                                  // of all boxes
    std::array<GroupBox, kChunkBlocks / 16> group_boxes;  // of sixteen blocks together
    // Blocks in which a lane has no receiver, or one with an owner.
    std::array<std::uint16_t, kChunkBlocks / 16> irregular;
    // Blocks whose normals are all the same, and the axis too: floors, walls.
    std::array<std::uint16_t, kChunkBlocks / 16> flat;

    std::size_t groups() const { return (blocks + 15) / 16; }
    // Bits of the blocks that group `g` has.
    std::uint16_t blocks_of_group(std::size_t g) const {
        return static_cast<std::uint16_t>((1u << std::min<std::size_t>(16, blocks - 16 * g)) - 1);
    }
    glm::vec3 position(std::size_t lane) const { return {x[lane], y[lane], z[lane]}; }
    glm::vec3 normal(std::size_t lane) const { return {nx[lane], ny[lane], nz[lane]}; }
};

// Of each line of a slab, in cluster order, and each block: for which receivers the end that they face is
// blocked. Line by line, so that one direction's map meets all blocks while it is in registers. Bits of lanes
// without a receiver mean nothing.
struct ChunkMasks {
    alignas(64) std::array<std::array<std::uint16_t, kChunkBlocks>, kSlab> rows;

    // Nothing blocked yet in lines [0, lines).
    void clear(const Chunk& chunk, std::size_t lines) {
        for (std::size_t k = 0; k < lines; ++k)
            std::fill_n(rows[k].begin(), (chunk.blocks + 15) / 16 * 16, std::uint16_t{0});
    }
};

// Blocks of a chunk, a bit each.
using BlockSet = std::array<std::uint16_t, kChunkBlocks / 16>;

inline BlockSet all_blocks(const Chunk& chunk) {
    BlockSet blocks{};
    for (std::size_t g = 0; g < chunk.groups(); ++g) blocks[g] = chunk.blocks_of_group(g);
    return blocks;
}

// Calls use(k) for the lines of some clusters of a slab.
template<class Use>
void for_lines(std::uint32_t clusters, const Use& use) {
    for (; clusters != 0; clusters &= clusters - 1) {
        const std::size_t first = static_cast<std::size_t>(std::countr_zero(clusters)) * kClusterSize;
        for (std::size_t k = first; k < first + kClusterSize; ++k) use(k);
    }
}

// Pairs of a line of a slab and a block; 16 blocks a word.
struct BlockPairs {
    alignas(64) std::array<std::array<std::uint16_t, kChunkBlocks / 16>, kSlab> rows;
    std::uint32_t clusters =
        0;  // bit c: any line of cluster c of the slab; other clusters' rows mean nothing
};

// Lines [first, first + count) in cluster order; both multiples of kClusterSize, count at most kSlab.
struct Slab {
    const SharedDirections& shared;
    std::size_t first, count;

    Slab(const SharedDirections& directions, std::size_t index)
        : shared(directions), first(index * kSlab), count(std::min(kSlab, directions.lines() - first)) {}

    glm::vec3 direction(std::size_t k) const { return shared.direction(first + k); }
    // The end of line k that a receiver faces: 0 or 1, as SharedDirections says; and the direction towards
    // it.
    int faced_end(std::size_t k, const glm::vec3& normal) const { return glm::dot(normal, direction(k)) < 0; }
    // Index of that direction in the caller's order; kNoRay where there is none, or the receiver faces
    // neither.
    std::uint32_t faced_ray(std::size_t k, const glm::vec3& normal) const {
        const float cosine = glm::dot(normal, direction(k));
        return cosine != 0 ? shared.ray[cosine < 0][first + k] : SharedDirections::kNoRay;
    }
    glm::vec3 towards(std::size_t k, int end) const { return end ? -direction(k) : direction(k); }
};
inline std::size_t slab_count(const SharedDirections& shared) {
    return (shared.lines() + kSlab - 1) / kSlab;
}

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
struct PreparedLines;
// The box of a block, without slack, and the cone of its normals: n.axis >= cosine, 1 exactly where all are
// the same and the axis too.
struct BlockBounds {
    glm::vec3 low, high, axis;
    float cosine;
};
inline constexpr float kLargestCosine = 0.99999994f;  // below 1, where normals differ
struct BatchKernels {
    // Packed receivers into loaded.count places: all but its cells.
    void (*load_packed)(const float* positions, const float* normals, Loaded& loaded);
    void (*find_cells)(Loaded& loaded);
    BlockBounds (*bound_block)(const Chunk& chunk, std::size_t block);
    // The pairs where some receiver faces an end that has a ray.
    void (*find_pairs)(const Chunk& chunk, const Slab& slab, BlockPairs& pairs);
    // Ors into the masks what the ground's half-space blocks.
    void (*add_ground)(const Plane& ground, const Slab& slab, const Chunk& chunk, ChunkMasks& masks);
    // Ors into the masks what the caster blocks, of the pairs asked about. Takes pairs out that are blocked
    // altogether, some of them: the next caster need not be asked about them. `prepared` keeps what one
    // caster's chunks can share.
    void (*add_caster)(const DirectionCaster& caster, const Slab& slab, const Chunk& chunk, BlockPairs& pairs,
                       ChunkMasks& masks, PreparedLines& prepared);
    // Takes out of `pairs` the words that are all blocked.
    void (*keep_open)(const Chunk& chunk, const ChunkMasks& masks, BlockPairs& pairs);
    // Of `asked`, the words of the masks that are not 0.
    void (*find_touched)(const Chunk& chunk, const BlockPairs& asked, const ChunkMasks& masks,
                         BlockPairs& touched);
    // Sets bit i where (direction i . away)^2 >= least; arrays aligned and readable up to a multiple of
    // sixteen.
    void (*mark_along)(const float* x, const float* y, const float* z, std::size_t count,
                       const glm::vec3& away, float least, std::uint32_t* bits);
    // Adds weight * |n.w| of blocked ends to occluded[receiver], in some blocks.
    void (*add_occluded)(const Slab& slab, const Chunk& chunk, const ChunkMasks& masks,
                         const BlockSet& blocks, float* occluded);
    // Of sums of all slabs, in place: visibility, 1 - occluded / SharedDirections::total.
    void (*finish_visibility)(const SharedDirections& shared, const Chunk& chunk, float* values);
};
const BatchKernels& batch_kernels(std::int64_t targets);  // dfield_context::simd_targets
extern const BatchKernels kReferenceKernels;

}  // namespace dfield::runtime
