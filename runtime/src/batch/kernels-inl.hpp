// Included once a target by kernels.cpp, hence no include guard of the usual kind.
#if defined(DFIELD_BATCH_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_BATCH_KERNELS_INL
#undef DFIELD_BATCH_KERNELS_INL
#else
#define DFIELD_BATCH_KERNELS_INL
#endif

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstring>

#include "batch/map_lookup-inl.hpp"
#include "batch/prepare-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

// Bits of `count` lanes (at most 16), lane by lane of vectors of Lanes(d): bits(first lane) gives a vector's.
template<class Bits>
HWY_INLINE std::uint32_t for_sixteen(F d, const Bits& bits) {
    std::uint32_t result = 0;
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) result |= bits(i) << i;
    return result;
}

// Of sixteen blocks from `first` on: those with a receiver before a plane through it across the line, and
// those with one behind.
struct BlocksFacing {
    std::uint32_t front, back;
};
HWY_INLINE BlocksFacing blocks_facing(F d, const Chunk& chunk, std::size_t first, const glm::vec3& w) {
    constexpr float kMargin = 1e-5f;  // rounding must not lose a receiver at its own horizon
    const V x = hn::Set(d, w.x), y = hn::Set(d, w.y), z = hn::Set(d, w.z), margin = hn::Set(d, kMargin);
    BlocksFacing result{0, 0};
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
        const V cosine = hn::MulAdd(x, hn::Load(d, &chunk.axis_x[first + i]),
                                    hn::MulAdd(y, hn::Load(d, &chunk.axis_y[first + i]),
                                               hn::Mul(z, hn::Load(d, &chunk.axis_z[first + i]))));
        const V sine = hn::Add(hn::Load(d, &chunk.sine[first + i]), margin);
        result.front |= mask_bits(d, hn::Gt(hn::Add(cosine, sine), hn::Zero(d))) << i;
        result.back |= mask_bits(d, hn::Lt(hn::Sub(cosine, sine), hn::Zero(d))) << i;
    }
    return result;
}

// Of a block: the receivers before a plane through them across `w`.
HWY_INLINE std::uint32_t receivers_facing(F d, const Chunk& chunk, std::size_t block, const glm::vec3& w) {
    return for_sixteen(d, [&](std::size_t i) HWY_ATTR {
        const std::size_t lane = block * kLanes + i;
        const V cosine = hn::MulAdd(hn::Set(d, w.x), hn::Load(d, &chunk.nx[lane]),
                                    hn::MulAdd(hn::Set(d, w.y), hn::Load(d, &chunk.ny[lane]),
                                               hn::Mul(hn::Set(d, w.z), hn::Load(d, &chunk.nz[lane]))));
        return mask_bits(d, hn::Gt(cosine, hn::Zero(d)));
    });
}

inline void find_pairs(const Chunk& chunk, const Slab& slab, BlockPairs& pairs) {
    const F d;
    if (!slab.shared.one_sided) {
        auto& all = pairs.rows[0];
        for (std::size_t g = 0; g < chunk.groups(); ++g) all[g] = chunk.blocks_of_group(g);
        for (std::size_t k = 1; k < slab.count; ++k) pairs.rows[k] = all;
        pairs.clusters = ~0u >> (32 - slab.count / kClusterSize);
        return;
    }
    pairs.clusters = 0;
    for (std::size_t k = 0; k < slab.count; ++k) {
        const bool front = slab.shared.ray[0][slab.first + k] != SharedDirections::kNoRay,
                   back = slab.shared.ray[1][slab.first + k] != SharedDirections::kNoRay;
        std::uint32_t any = 0;
        for (std::size_t g = 0; g < chunk.groups(); ++g) {
            std::uint32_t bits = chunk.blocks_of_group(g);
            if (!(front && back)) {
                const BlocksFacing facing = blocks_facing(d, chunk, 16 * g, slab.direction(k));
                bits &= (front ? facing.front : 0) | (back ? facing.back : 0);
            }
            pairs.rows[k][g] = static_cast<std::uint16_t>(bits);
            any |= bits;
        }
        if (any != 0) pairs.clusters |= 1u << k / kClusterSize;
    }
}

inline void add_ground(const Plane& ground, const Slab& slab, const Chunk& chunk, ChunkMasks& masks) {
    const F d;
    for (std::size_t k = 0; k < slab.count; ++k) {
        const glm::vec3 w = slab.direction(k);
        const float climb = glm::dot(ground.normal, w);
        if (climb == 0) continue;
        const glm::vec3 down = climb < 0 ? w : -w;
        for (std::size_t g = 0; g < chunk.groups(); ++g) {
            const BlocksFacing facing = blocks_facing(d, chunk, 16 * g, down);
            for (std::uint32_t rest = facing.front & chunk.blocks_of_group(g); rest != 0; rest &= rest - 1) {
                const int place = std::countr_zero(rest);
                const std::size_t b = 16 * g + static_cast<std::size_t>(place);
                masks.rows[k][b] |= static_cast<std::uint16_t>(
                    chunk.lanes[b] &
                    (facing.back >> place & 1 ? receivers_facing(d, chunk, b, down) : 0xffffu));
            }
        }
    }
}

// Which clusters of the slab hold a line that through some point of a box may come near the caster.
HWY_INLINE std::uint32_t clusters_near(const DirectionCaster& caster, const Slab& slab, const GroupBox& box) {
    const F d;
    const glm::vec3 away = caster.centre - box.middle;
    const float distance = std::sqrt(glm::dot(away, away));
    const float reach = 1.0001f * (caster.reach + box.radius);
    if (!(reach < distance)) return ~0u;
    // The angle between axis and line of centres is at most the sum of both cones' (lines have no sense).
    const float sine = reach / distance;
    const V sines = hn::Set(d, sine), cosines = hn::Set(d, std::sqrt(1 - sine * sine));
    const glm::vec3 towards = away / distance;
    const std::size_t first = slab.first / kClusterSize;
    const auto& rows = slab.shared.cluster_rows;
    std::uint32_t result = 0;
    for (std::size_t c = 0; c < slab.count / kClusterSize; c += hn::Lanes(d)) {
        const auto row = [&](int i) HWY_ATTR { return hn::LoadU(d, &rows[i][first + c]); };
        const V along = hn::Abs(
            hn::MulAdd(row(0), hn::Set(d, towards.x),
                       hn::MulAdd(row(1), hn::Set(d, towards.y), hn::Mul(row(2), hn::Set(d, towards.z)))));
        const V cosine = row(3);
        const V bound = hn::Sub(hn::NegMulAdd(sines, row(4), hn::Mul(cosines, cosine)), hn::Set(d, 1e-5f));
        result |= mask_bits(d, hn::Or(hn::Ge(along, bound), hn::Le(cosine, hn::Zero(d)))) << c;
    }
    return result;
}

// How a block's receivers lie to the caster, found when the block is first met.
struct BlockSides {
    std::uint16_t active;  // may be blocked by the caster
    std::uint16_t cut;     // their tangent plane cuts it
    // By axis: near receivers above, below the box; the third stands for neither and is 0.
    std::uint16_t beside[3][3];
};

// Of a ray in unit space, by axis: which of BlockSides::beside it leaves the box from.
struct LeavingSides {
    std::array<std::uint8_t, 3> side;

    explicit LeavingSides(const glm::vec3& w) {
        for (int axis = 0; axis < 3; ++axis) side[axis] = w[axis] > 0 ? 0 : w[axis] < 0 ? 1 : 2;
    }
    std::uint32_t staying(const BlockSides& sides) const {
        return sides.active &
               ~(sides.beside[0][side[0]] | sides.beside[1][side[1]] | sides.beside[2][side[2]]);
    }
};

HWY_INLINE BlockSides sides_of_block(const DirectionCaster& caster, const Chunk& chunk, std::size_t block) {
    const F d;
    const Instance& instance = caster.instance;
    BlockSides sides{};
    std::uint32_t behind = 0, near_box = 0;
    const auto dot3 = [&](const glm::vec3& a, V x, V y, V z) HWY_ATTR {
        return hn::MulAdd(hn::Set(d, a.x), x, hn::MulAdd(hn::Set(d, a.y), y, hn::Mul(hn::Set(d, a.z), z)));
    };
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
        const std::size_t at = block * kLanes + i;
        const V x = hn::Load(d, &chunk.x[at]), y = hn::Load(d, &chunk.y[at]), z = hn::Load(d, &chunk.z[at]);
        const V nx = hn::Load(d, &chunk.nx[at]), ny = hn::Load(d, &chunk.ny[at]),
                nz = hn::Load(d, &chunk.nz[at]);
        const V zero = hn::Zero(d);
        V beside = hn::Set(d, -1e30f);
        V distance = hn::Zero(d);  // squared, from the centre
        V square = hn::Zero(d), at_origin = hn::Zero(d), height = hn::Zero(d), extent = hn::Zero(d);
        for (int axis = 0; axis < 3; ++axis) {
            const glm::vec3 row(instance.to_unit[0][axis], instance.to_unit[1][axis],
                                instance.to_unit[2][axis]);
            const V origin = hn::Add(dot3(row, x, y, z), hn::Set(d, instance.unit_offset[axis]));
            const V n = dot3(instance.to_world[axis], nx, ny, nz);
            const V away = hn::Sub(hn::Set(d, instance.box_centre[axis]), origin);
            const V half = hn::Set(d, instance.box_half[axis]);
            distance = hn::MulAdd(origin, origin, distance);
            square = hn::MulAdd(n, n, square);
            at_origin = hn::MulAdd(n, origin, at_origin);
            height = hn::MulAdd(n, away, height);
            extent = hn::MulAdd(hn::Abs(n), half, extent);
            const V contact = hn::Set(d, LeavingBox::kContact * instance.box_half[axis]);
            sides.beside[axis][0] |=
                static_cast<std::uint16_t>(mask_bits(d, hn::Le(hn::Add(away, contact), zero)) << i);
            sides.beside[axis][1] |= static_cast<std::uint16_t>(mask_bits(d, hn::Ge(away, contact)) << i);
            beside = hn::Max(beside, hn::Sub(hn::Abs(away), half));
        }
        near_box |= mask_bits(d, hn::Lt(beside, hn::Set(d, kNearBox))) << i;
        behind |= mask_bits(d, hn::Not(hn::And(hn::Ge(distance, hn::Set(d, caster.from)),
                                               hn::Lt(distance, hn::Set(d, caster.to)))))
                  << i;
        const V length = hn::Sqrt(square);
        behind |= mask_bits(d, hn::Or(hn::Le(hn::Add(height, extent), zero), hn::Le(length, at_origin))) << i;
        const V contact = hn::Mul(hn::Set(d, -PlaneSide::kContact), length);
        sides.cut |= static_cast<std::uint16_t>(mask_bits(d, hn::Lt(hn::Sub(height, extent), contact)) << i);
    }
    std::uint32_t active = chunk.lanes[block] & ~behind;
    if (chunk.any_owner)
        for (std::uint32_t rest = active; rest != 0; rest &= rest - 1)
            if (chunk.owners[block * kLanes + std::countr_zero(rest)] == caster.id) active &= ~(rest & -rest);
    for (auto& axis : sides.beside)
        for (std::uint16_t& lanes : axis) lanes &= static_cast<std::uint16_t>(near_box);
    sides.active = static_cast<std::uint16_t>(active);
    return sides;
}

// Of `bits`, those whose receivers have the hit ahead. Rare, hence one by one.
inline std::uint32_t with_hit_ahead(const DirectionCaster& caster, const Slab& slab, const Chunk& chunk,
                                    const PreparedLines& prepared, std::size_t k, std::size_t block,
                                    std::uint32_t bits) {
    std::uint32_t result = 0;
    for (; bits != 0; bits &= bits - 1) {
        const int lane = std::countr_zero(bits);
        const std::size_t i = block * kLanes + lane;
        const glm::vec3 position = chunk.position(i);
        const glm::vec3 ray = slab.towards(k, slab.faced_end(k, chunk.normal(i)));
        if (hit_is_ahead(caster, position, ray, prepared.place(k, position, caster.instance)))
            result |= 1u << lane;
    }
    return result;
}

// Which of 16 words are not full yet: `lanes` has the bits of full ones.
HWY_INLINE std::uint32_t open_words(const std::uint16_t* words, const std::uint16_t* lanes) {
    const hn::CappedTag<std::uint16_t, 16> d;
    std::uint32_t result = 0;
    for (std::size_t i = 0; i < 16; i += hn::Lanes(d))
        result |= mask_bits(d, hn::Ne(hn::Load(d, words + i), hn::Load(d, lanes + i))) << i;
    return result;
}

// Which of 16 words are not 0.
HWY_INLINE std::uint32_t words_set(const std::uint16_t* words) {
    const hn::CappedTag<std::uint16_t, 16> d;
    std::uint32_t result = 0;
    for (std::size_t i = 0; i < 16; i += hn::Lanes(d))
        result |= mask_bits(d, hn::Ne(hn::Load(d, words + i), hn::Zero(d))) << i;
    return result;
}

// One direction's texel coordinates, in registers.
struct Coordinate {
    V x, y, z, constant;

    HWY_INLINE Coordinate(F d, const std::array<PreparedLines::Row, 4>& row, std::size_t k)
        : x(hn::Set(d, row[0][k])),
          y(hn::Set(d, row[1][k])),
          z(hn::Set(d, row[2][k])),
          constant(hn::Set(d, row[3][k])) {}
    HWY_INLINE V at(V px, V py, V pz) const {
        return hn::MulAdd(x, px, hn::MulAdd(y, py, hn::MulAdd(z, pz, constant)));
    }
    HWY_INLINE V from_middle(V px, V py, V pz, V half_map) const {
        return hn::MulAdd(x, px, hn::MulAdd(y, py, hn::MulAdd(z, pz, hn::Sub(constant, half_map))));
    }
};

// Which of 16 blocks, from `first` on, have a box that a direction's map can meet. Conservative: what
// rounding could add to a receiver's texel coordinates is less than the margin.
HWY_INLINE std::uint32_t blocks_on_map(F d, const Chunk& chunk, std::size_t first, const Coordinate& u,
                                       const Coordinate& v, V half_map) {
    return for_sixteen(d, [&](std::size_t i) HWY_ATTR {
        const std::size_t b = first + i;
        const V x = hn::Load(d, &chunk.centre_x[b]), y = hn::Load(d, &chunk.centre_y[b]),
                z = hn::Load(d, &chunk.centre_z[b]);
        const V half_x = hn::Load(d, &chunk.half_x[b]), half_y = hn::Load(d, &chunk.half_y[b]),
                half_z = hn::Load(d, &chunk.half_z[b]);
        const auto inside = [&](const Coordinate& c) HWY_ATTR {
            const V middle = c.from_middle(x, y, z, half_map);
            const V reach = hn::MulAdd(
                hn::Abs(c.x), half_x,
                hn::MulAdd(hn::Abs(c.y), half_y,
                           hn::MulAdd(hn::Abs(c.z), half_z, hn::Add(half_map, hn::Set(d, kTexelMargin)))));
            return hn::Le(hn::Abs(middle), reach);
        };
        return mask_bits(d, hn::And(inside(u), inside(v)));
    });
}

// Blocks of a chunk.
struct BlockList {
    std::size_t size = 0;
    alignas(64) std::array<std::uint32_t, kChunkBlocks + 16> blocks;

    // Of the sixteen from `first` on, those whose bit is set.
    HWY_INLINE void append(std::size_t first, std::uint32_t bits) {
#if DFIELD_AVX512
        // Without a branch on any of them. Compressed in a register: straight to memory takes some processors
        // ten times as long.
        const __m512i lanes =
            _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(first)),
                             _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
        _mm512_storeu_si512(&blocks[size], _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), lanes));
        size += static_cast<std::size_t>(std::popcount(bits));
#else
        for (; bits != 0; bits &= bits - 1)
            blocks[size++] =
                static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(std::countr_zero(bits));
#endif
    }
};

// Of sixteen blocks from `first` on, by bounds for their boxes and cones of normals: those whose receivers
// all have the whole object in front of their tangent planes, are not near its box and read these maps; and
// those that have it behind.
struct BlockClasses {
    std::uint32_t plain = 0, hidden = 0;
};
HWY_INLINE BlockClasses classes_of_blocks(const DirectionCaster& caster, const Chunk& chunk,
                                          std::size_t first) {
    const F d;
    const Instance& instance = caster.instance;
    const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
    const auto dot3 = [&](const glm::vec3& a, V x, V y, V z) HWY_ATTR {
        return hn::MulAdd(set(a.x), x, hn::MulAdd(set(a.y), y, hn::Mul(set(a.z), z)));
    };
    BlockClasses result;
    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
        const std::size_t b = first + i;
        const V x = hn::Load(d, &chunk.centre_x[b]), y = hn::Load(d, &chunk.centre_y[b]),
                z = hn::Load(d, &chunk.centre_z[b]);
        const V half_x = hn::Load(d, &chunk.half_x[b]), half_y = hn::Load(d, &chunk.half_y[b]),
                half_z = hn::Load(d, &chunk.half_z[b]);
        const V ax = hn::Load(d, &chunk.axis_x[b]), ay = hn::Load(d, &chunk.axis_y[b]),
                az = hn::Load(d, &chunk.axis_z[b]);
        // Normals stray from the axis by at most 1.5 sines, as vectors, within a quarter turn.
        const V stray = hn::Mul(set(1.5f), hn::Load(d, &chunk.sine[b]));
        V height = hn::Zero(d), extent = hn::Zero(d), square = hn::Zero(d);  // along the axis
        V away_square = hn::Zero(d);                                         // in unit space, at most
        V near = hn::Zero(d), far = hn::Zero(d), beside = set(-1e30f);       // squared distances
        V slope_square = hn::Zero(d);
        for (int axis = 0; axis < 3; ++axis) {
            const glm::vec3 row(instance.to_unit[0][axis], instance.to_unit[1][axis],
                                instance.to_unit[2][axis]);
            const V origin = hn::Add(dot3(row, x, y, z), set(instance.unit_offset[axis]));
            const V spread = dot3(glm::abs(row), half_x, half_y, half_z);
            const V n = dot3(instance.to_world[axis], ax, ay, az);
            const V away = hn::Sub(set(instance.box_centre[axis]), origin);
            const V half = set(instance.box_half[axis]);
            height = hn::MulAdd(n, away, height);
            extent = hn::MulAdd(hn::Abs(n), hn::Add(half, spread), extent);
            square = hn::MulAdd(n, n, square);
            const V whole = hn::Add(hn::Add(hn::Abs(away), spread), half);
            away_square = hn::MulAdd(whole, whole, away_square);
            const V column = set(glm::dot(instance.to_world[axis], instance.to_world[axis]));
            slope_square = hn::Add(slope_square, column);
            beside = hn::Max(beside, hn::Sub(hn::Sub(hn::Abs(away), spread), half));
            const V least = hn::Max(hn::Sub(hn::Abs(origin), spread), hn::Zero(d));
            const V most = hn::Add(hn::Abs(origin), spread);
            near = hn::MulAdd(least, least, near);
            far = hn::MulAdd(most, most, far);
        }
        // A normal that strays by s changes height and extent by s times the columns' length times theirs.
        const V slack = hn::Mul(stray, hn::Sqrt(hn::Mul(slope_square, away_square)));
        extent = hn::Add(extent, slack);
        const V contact = hn::Mul(set(-0.9f * PlaneSide::kContact), hn::Sqrt(square));
        const auto front = hn::And(hn::Ge(hn::Sub(height, extent), contact), hn::Ge(beside, set(kNearBox)));
        const auto read = hn::And(hn::Ge(near, set(caster.from)), hn::Lt(far, set(caster.to)));
        result.plain |= mask_bits(d, hn::And(front, read)) << i;
        result.hidden |= mask_bits(d, hn::Le(hn::Add(height, extent), hn::Zero(d))) << i;
    }
    return result;
}

// What a chunk's blocks are to one caster.
struct ChunkSides {
    std::array<BlockSides, kChunkBlocks> blocks;
    std::array<bool, kChunkBlocks / 16> met{};              // groups whose classes are known
    std::array<std::uint16_t, kChunkBlocks / 16> known{};   // in one of both, or in `blocks`
    std::array<std::uint16_t, kChunkBlocks / 16> plain{};   // all lanes active, none cut, none near the box
    std::array<std::uint16_t, kChunkBlocks / 16> hidden{};  // no lane active

    HWY_INLINE void find(const DirectionCaster& caster, const Chunk& chunk, std::size_t g,
                         std::uint32_t missing) {
        if (!met[g]) {
            met[g] = true;
            const BlockClasses classes = classes_of_blocks(caster, chunk, 16 * g);
            plain[g] = static_cast<std::uint16_t>(classes.plain & ~chunk.irregular[g]);
            hidden[g] = static_cast<std::uint16_t>(classes.hidden);
            known[g] = plain[g] | hidden[g];
        }
        for (missing &= ~known[g]; missing != 0; missing &= missing - 1) {
            const auto place = static_cast<std::size_t>(std::countr_zero(missing));
            const BlockSides& side = blocks[16 * g + place] = sides_of_block(caster, chunk, 16 * g + place);
            std::uint32_t special = side.cut | (side.active ^ 0xffffu);
            for (const auto& axis : side.beside) special |= axis[0] | axis[1];
            plain[g] |= static_cast<std::uint16_t>((special == 0) << place);
            known[g] |= static_cast<std::uint16_t>(1u << place);
        }
    }
};

template<int kSize>
void add_caster_sized(const DirectionCaster& caster, const Slab& slab, const Chunk& chunk, BlockPairs& pairs,
                      ChunkMasks& masks, PreparedLines& prepared) {
    const F d;
    constexpr auto kMapSize = static_cast<float>(kSize);
    const std::size_t groups = chunk.groups();
    // Sixteen blocks at a time: chunks may be long and thin.
    std::array<std::uint32_t, kChunkBlocks / 16> near;
    std::uint32_t clusters = 0;
    for (std::size_t g = 0; g < groups; ++g) {
        near[g] = pairs.clusters & clusters_near(caster, slab, chunk.group_boxes[g]);
        clusters |= near[g];
    }
    if (clusters == 0) return;
    ChunkSides sides;
    const V half_map = hn::Set(d, 0.5f * kMapSize);

    for (std::uint32_t rest = clusters; rest != 0; rest &= rest - 1) {
        const auto c = static_cast<std::size_t>(std::countr_zero(rest));
        const std::size_t first = c * kClusterSize;
        if (!(prepared.clusters >> c & 1)) prepare_lines(caster, slab, first, prepared);
        prepared.clusters |= 1u << c;
        // Of the groups near, which lines of the cluster meet them; of each line, which groups.
        static_assert(kChunkBlocks / 16 <= 8);
        std::array<std::uint8_t, kClusterSize> groups_of_line{};
        std::uint32_t lines = 0;
        for (std::size_t g = 0; g < groups; ++g) {
            if (!(near[g] >> c & 1)) continue;
            const std::uint32_t on = lines_on_box(prepared, first, chunk.group_boxes[g], kMapSize);
            lines |= on;
            for (std::uint32_t rest_on = on; rest_on != 0; rest_on &= rest_on - 1)
                groups_of_line[static_cast<std::size_t>(std::countr_zero(rest_on))] |=
                    static_cast<std::uint8_t>(1u << g);
        }
        for (; lines != 0; lines &= lines - 1) {
            const auto place = static_cast<std::size_t>(std::countr_zero(lines));
            const std::size_t k = first + place;
            const Coordinate u(d, prepared.u, k), v(d, prepared.v, k);
            auto& row = masks.rows[k];
            // First which blocks, then the lookups: a loop an end, not one for every sixteen blocks, whose
            // ends no processor foresees.
            BlockList plain, special;
            for (std::uint32_t left = groups_of_line[place]; left != 0; left &= left - 1) {
                const auto g = static_cast<std::size_t>(std::countr_zero(left));
                const std::uint32_t asked = pairs.rows[k][g];
                if (asked == 0) continue;
                const std::uint32_t open = asked & open_words(&row[16 * g], &chunk.lanes[16 * g]);
                pairs.rows[k][g] = static_cast<std::uint16_t>(open);
                const std::uint32_t blocks = open & blocks_on_map(d, chunk, 16 * g, u, v, half_map);
                if (const std::uint32_t missing = blocks & ~std::uint32_t{sides.known[g]})
                    sides.find(caster, chunk, g, missing);
                plain.append(16 * g, blocks & sides.plain[g]);
                if (const std::uint32_t others = blocks & ~(sides.plain[g] | std::uint32_t{sides.hidden[g]}))
                    special.append(16 * g, others);
            }
            if (plain.size + special.size == 0) continue;
            const MapRegisters<kSize> map(
                d, caster.maps.texels.data() + std::size_t{prepared.index[k]} * direction_map_words(kSize));
            const auto look_up = [&](std::size_t b) HWY_ATTR {
                return for_sixteen(d, [&](std::size_t i) HWY_ATTR {
                    const std::size_t lane = b * kLanes + i;
                    const V x = hn::Load(d, &chunk.x[lane]), y = hn::Load(d, &chunk.y[lane]),
                            z = hn::Load(d, &chunk.z[lane]);
                    return map.hits(d, u.at(x, y, z), v.at(x, y, z));
                });
            };
            std::size_t next = 0;
            for (; next + 1 < plain.size; next += 2) {
                const std::size_t a = plain.blocks[next], b = plain.blocks[next + 1];
                const std::uint32_t bits_a = look_up(a), bits_b = look_up(b);
                row[a] |= static_cast<std::uint16_t>(bits_a);
                row[b] |= static_cast<std::uint16_t>(bits_b);
            }
            if (next < plain.size) {
                const std::size_t b = plain.blocks[next];
                row[b] |= static_cast<std::uint16_t>(look_up(b));
            }
            if (special.size == 0) continue;
            const glm::vec3 w = slab.direction(k), carried = caster.instance.carry_direction(w);
            const LeavingSides along(carried), against(-carried);
            for (std::size_t i = 0; i < special.size; ++i) {
                const std::size_t b = special.blocks[i];
                const BlockSides& side = sides.blocks[b];
                const std::uint32_t front = receivers_facing(d, chunk, b, w);
                std::uint32_t bits =
                    ((front & along.staying(side)) | (~front & against.staying(side))) & look_up(b);
                if (const std::uint32_t cut = bits & side.cut)
                    bits = (bits & ~cut) | with_hit_ahead(caster, slab, chunk, prepared, k, b, cut);
                row[b] |= static_cast<std::uint16_t>(bits);
            }
        }
    }
}

inline void add_level(const DirectionCaster& caster, const Slab& slab, const Chunk& chunk, BlockPairs& pairs,
                      ChunkMasks& masks, PreparedLines& prepared) {
    switch (caster.maps.parameters.map_size) {
        case 16:
            return add_caster_sized<16>(caster, slab, chunk, pairs, masks, prepared);
        case 32:
            return add_caster_sized<32>(caster, slab, chunk, pairs, masks, prepared);
        case 64:
            return add_caster_sized<64>(caster, slab, chunk, pairs, masks, prepared);
        default:
            return add_caster_sized<128>(caster, slab, chunk, pairs, masks, prepared);
    }
}

inline void add_caster(const DirectionCaster& caster, const Slab& slab, const Chunk& chunk, BlockPairs& pairs,
                       ChunkMasks& masks, PreparedLines& prepared) {
    for_levels(caster, [&](const DirectionCaster& level) {
        if (!caster.levels.empty()) prepared.clusters = 0;
        add_level(level, slab, chunk, pairs, masks, prepared);
    });
}

inline void mark_along(const float* x, const float* y, const float* z, std::size_t count,
                       const glm::vec3& away, float least, std::uint32_t* bits) {
    const F d;
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const V along = hn::MulAdd(hn::Set(d, away.x), hn::Load(d, x + i),
                                   hn::MulAdd(hn::Set(d, away.y), hn::Load(d, y + i),
                                              hn::Mul(hn::Set(d, away.z), hn::Load(d, z + i))));
        bits[i / 32] |= mask_bits(d, hn::Ge(hn::Mul(along, along), hn::Set(d, least))) << i % 32;
    }
}

// Weight times |n.w| for sixteen normals, n.w being `cosine`; the ends' weights may differ.
HWY_INLINE V share_of(F d, V cosine, V front, V back) {
    return hn::Mul(hn::IfThenElse(hn::Lt(cosine, hn::Zero(d)), back, front), hn::Abs(cosine));
}

inline void keep_open(const Chunk& chunk, const ChunkMasks& masks, BlockPairs& pairs) {
    for_lines(pairs.clusters, [&](std::size_t k) HWY_ATTR {
        for (std::size_t g = 0; g < chunk.groups(); ++g)
            if (pairs.rows[k][g] != 0)
                pairs.rows[k][g] &=
                    static_cast<std::uint16_t>(open_words(&masks.rows[k][16 * g], &chunk.lanes[16 * g]));
    });
}

inline void find_touched(const Chunk& chunk, const BlockPairs& asked, const ChunkMasks& masks,
                         BlockPairs& touched) {
    touched.clusters = asked.clusters;
    for_lines(asked.clusters, [&](std::size_t k) HWY_ATTR {
        for (std::size_t g = 0; g < chunk.groups(); ++g)
            touched.rows[k][g] = asked.rows[k][g] != 0
                                     ? static_cast<std::uint16_t>(words_set(&masks.rows[k][16 * g]))
                                     : std::uint16_t{0};
    });
}

inline void add_occluded(const Slab& slab, const Chunk& chunk, const ChunkMasks& masks,
                         const BlockSet& blocks, float* occluded) {
    const F d;
    const auto add = [&](std::size_t lane, std::uint32_t bits, V share) HWY_ATTR {
        hn::Store(hn::Add(hn::Load(d, occluded + lane), keep_bits(d, bits, share)), d, occluded + lane);
    };
    for (std::size_t k = 0; k < slab.count; ++k) {
        const std::size_t at = slab.first + k;
        const V x = hn::Set(d, slab.shared.x[at]), y = hn::Set(d, slab.shared.y[at]),
                z = hn::Set(d, slab.shared.z[at]);
        const V front = hn::Set(d, slab.shared.weight[0][at]), back = hn::Set(d, slab.shared.weight[1][at]);
        const auto share = [&](const float* nx, const float* ny, const float* nz) HWY_ATTR {
            const V cosine =
                hn::MulAdd(x, hn::Load(d, nx), hn::MulAdd(y, hn::Load(d, ny), hn::Mul(z, hn::Load(d, nz))));
            return share_of(d, cosine, front, back);
        };
        for (std::size_t g = 0; g < chunk.groups(); ++g) {
            if (blocks[g] == 0) continue;
            const std::uint32_t blocked = blocks[g] & words_set(&masks.rows[k][16 * g]);
            if (blocked == 0) continue;
            if (const std::uint32_t flat = blocked & chunk.flat[g]) {  // one share a block
                HWY_ALIGN std::array<float, 16> shares;
                for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
                    const std::size_t b = 16 * g + i;
                    hn::Store(share(&chunk.axis_x[b], &chunk.axis_y[b], &chunk.axis_z[b]), d, &shares[i]);
                }
                for (std::uint32_t rest = flat; rest != 0; rest &= rest - 1) {
                    const auto place = static_cast<std::size_t>(std::countr_zero(rest));
                    const std::size_t b = 16 * g + place;
                    const std::uint32_t bits = masks.rows[k][b];
                    for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d))
                        add(b * kLanes + i, bits >> i, hn::Set(d, shares[place]));
                }
            }
            for (std::uint32_t rest = blocked & ~std::uint32_t{chunk.flat[g]}; rest != 0; rest &= rest - 1) {
                const std::size_t b = 16 * g + static_cast<std::size_t>(std::countr_zero(rest));
                const std::uint32_t bits = masks.rows[k][b];
                for (std::size_t i = 0; i < kLanes; i += hn::Lanes(d)) {
                    const std::size_t lane = b * kLanes + i;
                    add(lane, bits >> i, share(&chunk.nx[lane], &chunk.ny[lane], &chunk.nz[lane]));
                }
            }
        }
    }
}

// Sums of weights over normals' hemispheres, as SharedDirections::total.
HWY_INLINE V totals_of(F d, const SharedDirections& shared, const float* x, const float* y, const float* z) {
    const I in;
    constexpr int kSize = SharedDirections::kTotalsSize;
    const V one = hn::Set(d, 1.0f), zero = hn::Zero(d), scale = hn::Set(d, 0.5f * kSize);
    const V nx = hn::Load(d, x), ny = hn::Load(d, y), nz = hn::Load(d, z);
    const V norm = hn::Div(one, hn::Add(hn::Abs(nx), hn::Add(hn::Abs(ny), hn::Abs(nz))));
    const V a = hn::Mul(nx, norm), b = hn::Mul(ny, norm);
    const auto south = hn::Lt(nz, zero);
    const V column =
        hn::Mul(scale, hn::Add(one, hn::IfThenElse(south, hn::CopySign(hn::Sub(one, hn::Abs(b)), a), a)));
    const V row =
        hn::Mul(scale, hn::Add(one, hn::IfThenElse(south, hn::CopySign(hn::Sub(one, hn::Abs(a)), b), b)));
    const auto whole = [&](V v) HWY_ATTR {
        return hn::Min(hn::Max(hn::ConvertTo(in, v), hn::Zero(in)), hn::Set(in, kSize - 1));
    };
    const auto s = whole(column), t = whole(row);
    const V u = hn::Sub(column, hn::ConvertTo(d, s)), v = hn::Sub(row, hn::ConvertTo(d, t));
    const auto cell = hn::Add(hn::Mul(t, hn::Set(in, kSize + 1)), s);
    const auto corner = [&](int offset)
                            HWY_ATTR { return gathered_float(d, shared.totals.data() + offset, cell); };
    const V top_left = corner(0), bottom_left = corner(kSize + 1);
    const V top = hn::MulAdd(u, hn::Sub(corner(1), top_left), top_left);
    const V bottom = hn::MulAdd(u, hn::Sub(corner(kSize + 2), bottom_left), bottom_left);
    return hn::MulAdd(v, hn::Sub(bottom, top), top);
}

inline void finish_visibility(const SharedDirections& shared, const Chunk& chunk, float* values) {
    const F d;
    const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
    for (std::size_t g = 0; g < chunk.groups(); ++g) {
        HWY_ALIGN std::array<float, 16> totals;  // of flat blocks
        if (chunk.flat[g] != 0)
            for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
                const std::size_t b = 16 * g + i;
                hn::Store(totals_of(d, shared, &chunk.axis_x[b], &chunk.axis_y[b], &chunk.axis_z[b]), d,
                          &totals[i]);
            }
        for (std::size_t b = 16 * g; b < std::min(16 * g + 16, chunk.blocks); ++b)
            for (std::size_t i = b * kLanes; i < (b + 1) * kLanes; i += hn::Lanes(d)) {
                const V occluded = hn::Load(d, values + i);
                const V total = chunk.flat[g] >> b % 16 & 1
                                    ? hn::Set(d, totals[b % 16])
                                    : totals_of(d, shared, &chunk.nx[i], &chunk.ny[i], &chunk.nz[i]);
                const V visibility = hn::Max(zero, hn::Sub(one, hn::Div(occluded, total)));
                hn::Store(hn::IfThenElse(hn::Gt(occluded, zero), visibility, one), d, values + i);
            }
    }
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
