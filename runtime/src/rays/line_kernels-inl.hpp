// Lookups in line tables (line_lookup.hpp is the plain form). Seen once a target.
#include <cstddef>
#include <cstdint>

#include "rays/cull-inl.hpp"
#include "rays/kernels.hpp"
#include "rays/lattice-inl.hpp"

#if defined(DFIELD_RAYS_LINE_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_RAYS_LINE_KERNELS_INL
#undef DFIELD_RAYS_LINE_KERNELS_INL
#else
#define DFIELD_RAYS_LINE_KERNELS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

struct LatticeChords {
    VI entry, exit;
};

HWY_INLINE LatticeChords nearest_chords(std::uint32_t lattice, const Chords& chord) {
    return {nearest_lattice_points(lattice, chord.at_middle_plus(hn::Neg(chord.half))),
            nearest_lattice_points(lattice, chord.at_middle_plus(chord.half))};
}

// Lanes that are not valid may hold nonsense: nothing is read for them.
HWY_INLINE VI indices(VI index, MF valid) {
    return hn::IfThenElseZero(hn::RebindMask(I(), valid), index);
}

HWY_INLINE LatticeChords pivoted_chords(std::uint32_t lattice, const glm::vec4* points, const Chords& chord,
                                        MF valid) {
    const VI entry = nearest_lattice_points(lattice, chord.at_middle_plus(hn::Neg(chord.half)));
    const VI place = hn::ShiftLeft<2>(indices(entry, valid));
    const VF radius = set(kLineRadius);
    const V3 p{hn::Mul(hn::GatherIndex(F(), &points->x, place), radius),
               hn::Mul(hn::GatherIndex(F(), &points->y, place), radius),
               hn::Mul(hn::GatherIndex(F(), &points->z, place), radius)};
    const V3 aim = chord.middle - p;
    const VF r = hn::Mul(hn::Mul(set(-2), dot(p, aim)), reciprocal(hn::Max(dot(aim, aim), set(1e-12f))));
    return {entry, nearest_lattice_points(lattice, along(p, r, aim))};
}

// share_on_line above a half.
HWY_INLINE MF majority_hits(const LineTable& table, const Chords& chord, MF valid) {
    const std::uint32_t lattice = table.parameters.lattice;
    const auto* const hits = reinterpret_cast<const std::int32_t*>(table.hits.data());
    const Neighbours entry(lattice, chord.at_middle_plus(hn::Neg(chord.half))),
        exit(lattice, chord.at_middle_plus(chord.half));
    VF share = hn::Zero(F());
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
            // hit_index: the larger point's triangle is the one that counts.
            const VI index = indices(hn::Max(hn::Add(entry.triangles[a], exit.points[b]),
                                             hn::Add(exit.triangles[b], entry.points[a])),
                                     valid);
            const VI word = hn::GatherIndex(I(), hits, hn::ShiftRight<5>(index));
            const VI bit = hn::And(hn::Shr(word, hn::And(index, hn::Set(I(), 31))), hn::Set(I(), 1));
            share = hn::MulAdd(hn::Mul(entry.shares[a], exit.shares[b]), hn::ConvertTo(F(), bit), share);
        }
    return hn::And(valid, hn::Gt(share, set(0.5f)));
}

// Valid lanes with something on their chord.
HWY_INLINE MF anything_on_lines(const dfield_field& field, const Chords& chord, MF valid) {
    const I i;
    const hn::RebindToUnsigned<I> u;
    const LineTable& table = *field.maps.lines;
    const std::uint32_t lattice = table.parameters.lattice;
    if (table.parameters.filtered) return majority_hits(table, chord, valid);
    const LatticeChords ends = table.parameters.pivot
                                   ? pivoted_chords(lattice, field.line_points.data(), chord, valid)
                                   : nearest_chords(lattice, chord);
    const VI high = hn::Max(ends.entry, ends.exit), low = hn::Min(ends.entry, ends.exit);
    const VI index =
        indices(hn::Add(hn::ShiftRight<1>(hn::Mul(high, hn::Add(high, hn::Set(i, 1)))), low), valid);
    const auto words = hn::GatherIndex(u, table.hits.data(), hn::ShiftRight<5>(index));
    const auto bit = hn::Shl(hn::Set(u, 1), hn::BitCast(u, hn::And(index, hn::Set(i, 31))));
    return hn::And(valid, hn::RebindMask(F(), hn::TestBit(words, bit)));
}

// hits_on_line's ends of what is on a chord.
struct HitRanges {
    VF first, last;
};

template<bool kFirst>
HWY_INLINE HitRanges hits_on_lines(const dfield_field& field, const Chords& chord, MF valid) {
    const I i;
    const LineTable& table = *field.maps.lines;
    const std::uint32_t bits = table.parameters.depth_bits;
    if (bits == 0) return {chord.t_middle, chord.t_middle};
    const VI points =
        hn::Set(i, static_cast<std::int32_t>(lattice_point_count(table.parameters.depth_lattice)));
    const LatticeChords ends = nearest_chords(table.parameters.depth_lattice, chord);
    const auto* const words = reinterpret_cast<const std::int32_t*>(table.depths.data());
    // From the middle of the chord, -1 .. 1 of its half; 0 where nothing is stored.
    const auto place = [&](VI from, VI to) HWY_ATTR {
        const VI index = indices(hn::Add(hn::Mul(from, points), to), valid);
        const hn::RebindToUnsigned<I> u;
        const VI word =
            hn::GatherIndex(i, words, bits == 8 ? hn::ShiftRight<2>(index) : hn::ShiftRight<3>(index));
        const VI shift = bits == 8 ? hn::ShiftLeft<3>(hn::And(index, hn::Set(i, 3)))
                                   : hn::ShiftLeft<2>(hn::And(index, hn::Set(i, 7)));
        const VI value = hn::And(hn::BitCast(i, hn::Shr(hn::BitCast(u, word), hn::BitCast(u, shift))),
                                 hn::Set(i, bits == 8 ? 255 : 15));
        const VF step = set(2 / static_cast<float>((1u << bits) - 2));
        const VF at = hn::MulAdd(hn::ConvertTo(F(), value), step, hn::Neg(hn::Add(step, set(1))));
        return hn::IfThenElseZero(hn::RebindMask(F(), hn::Ne(value, hn::Zero(i))), at);
    };
    HitRanges hits;
    hits.last = hn::MulAdd(place(ends.entry, ends.exit), chord.half, chord.t_middle);
    hits.first = kFirst ? hn::NegMulAdd(place(ends.exit, ends.entry), chord.half, chord.t_middle) : hits.last;
    return hits;
}

template<class Rays>
HWY_INLINE void any_line_hits(const dfield_field& field, const Rays& rays, float least, bool in_front,
                              std::uint8_t* blocked) {
    const F f;
    const VF minimum = set(least);
    Marks marks;
    for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(f)) {
        const Chords chord(rays.origin(k), rays.direction(k), kLineRadius);
        const MF inside = hn::FirstN(f, rays.count() - k);
        const MF valid = hn::And(inside, hn::And(chord.valid, hn::Gt(chord.t_out(), minimum)));
        MF hit = anything_on_lines(field, chord, valid);
        const MF unsure = hn::And(hit, hn::Lt(chord.t_in(), minimum));
        if (!in_front && !hn::AllFalse(f, unsure)) {
            const MF behind = hn::Le(hits_on_lines<false>(field, chord, hit).last, minimum);
            hit = hn::And(hit, hn::Not(hn::And(unsure, behind)));
        }
        marks.put(k, rays.ids(k), hit);
    }
    marks.write(rays.count(), blocked);
}

template<class Rays>
HWY_INLINE void line_distances(const dfield_field& field, const Rays& rays, float least, bool in_front,
                               float* nearest) {
    const F f;
    const VF minimum = set(least);
    for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(f)) {
        const Chords chord(rays.origin(k), rays.direction(k), kLineRadius);
        const MF inside = hn::FirstN(f, rays.count() - k);
        const MF valid = hn::And(inside, hn::And(chord.valid, hn::Gt(chord.t_out(), minimum)));
        const MF hit = anything_on_lines(field, chord, valid);
        if (hn::AllFalse(f, hit)) continue;
        const HitRanges hits = hits_on_lines<true>(field, chord, hit);
        const MF unsure = in_front ? hn::Ne(minimum, minimum) : hn::Lt(chord.t_in(), minimum);
        const MF behind = hn::And(unsure, hn::Lt(hits.first, minimum));
        const VF t = hn::IfThenElse(behind, hits.last, hn::Max(hits.first, minimum));
        lower(rays.ids(k), hn::And(hit, hn::Or(hn::Not(behind), hn::Gt(t, minimum))), t, nearest);
    }
}

inline SphereSpace line_space(const Instance& instance) {
    return {kLineRadius * instance.lines.to_unit, kLineRadius * instance.lines.offset, kLineRadius};
}

// What RayKernels wants.
void lines_any_hits(const RayQuery& query, const float* x, const float* y, const float* z, std::size_t count,
                    std::uint8_t* blocked) {
    const SharedRays rays(query, x, y, z, count, blocked, kLineRadius);
    any_line_hits(*query.field, rays, query.minimum, query.in_front, blocked);
}

void lines_distances(const RayQuery& query, const float* x, const float* y, const float* z, std::size_t count,
                     float* nearest) {
    const SharedRays rays(query, x, y, z, count, nullptr, kLineRadius);
    line_distances(*query.field, rays, query.minimum, query.in_front, nearest);
}

void lines_ray_any_hits(const Instance& instance, const RayBlock& block, std::uint8_t* blocked) {
    const OwnRays rays(line_space(instance), instance, false, block, blocked);
    any_line_hits(*instance.field, rays, 0, false, blocked);
}

void lines_ray_distances(const Instance& instance, const RayBlock& block, float* nearest) {
    const OwnRays rays(line_space(instance), instance, false, block, nullptr);
    line_distances(*instance.field, rays, 0, false, nearest);
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
