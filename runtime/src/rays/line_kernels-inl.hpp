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

// Lanes that are not valid may hold nonsense: nothing is read for them.
HWY_INLINE VI indices(VI index, MF valid) {
    return hn::IfThenElseZero(hn::RebindMask(I(), valid), index);
}

// Lanes of bits, counted from the first word on, that are set.
HWY_INLINE MF bits_at(const std::uint32_t* words, VI index) {
    const I i;
    const hn::RebindToUnsigned<I> u;
    const auto word = hn::GatherIndex(u, words, hn::ShiftRight<5>(index));
    const auto bit = hn::Shl(hn::Set(u, 1), hn::BitCast(u, hn::And(index, hn::Set(i, 31))));
    return hn::RebindMask(F(), hn::TestBit(word, bit));
}

// hit_index.
HWY_INLINE VI hit_indices(VI entry, VI exit) {
    const VI high = hn::Max(entry, exit), low = hn::Min(entry, exit);
    return hn::Add(hn::ShiftRight<1>(hn::Mul(high, hn::Add(high, hn::Set(I(), 1)))), low);
}

// The other end of pivoted_chord.
HWY_INLINE VI pivoted_exits(std::uint32_t lattice, const glm::vec4* points, VI entry, const V3& middle,
                            MF valid) {
    const VI place = hn::ShiftLeft<2>(indices(entry, valid));
    const VF radius = set(kLineRadius);
    const V3 p{hn::Mul(hn::GatherIndex(F(), &points->x, place), radius),
               hn::Mul(hn::GatherIndex(F(), &points->y, place), radius),
               hn::Mul(hn::GatherIndex(F(), &points->z, place), radius)};
    const V3 aim = middle - p;
    const VF r = hn::Mul(hn::Mul(set(-2), dot(p, aim)), reciprocal(hn::Max(dot(aim, aim), set(1e-12f))));
    return nearest_lattice_points(lattice, along(p, r, aim));
}

// share_on_line above a half.
HWY_INLINE MF majority_hits(const LineTable& table, const V3& entry_point, const V3& exit_point, MF valid) {
    const std::uint32_t lattice = table.parameters.lattice;
    const Neighbours entry(lattice, entry_point), exit(lattice, exit_point);
    VF share = hn::Zero(F());
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
            // hit_index: the larger point's triangle is the one that counts.
            const VI index = indices(hn::Max(hn::Add(entry.triangles[a], exit.points[b]),
                                             hn::Add(exit.triangles[b], entry.points[a])),
                                     valid);
            share = hn::Add(share, hn::IfThenElseZero(bits_at(table.hits.data(), index),
                                                      hn::Mul(entry.shares[a], exit.shares[b])));
        }
    return hn::And(valid, hn::Gt(share, set(0.5f)));
}

// Chords of a block on their way to the table, in steps that are short enough for the processor to have
// several vectors in each under way.
class LineLookups {
  public:
    // Rays with something on their line, on either side of the origin, whose chords end ahead of t = minimum.
    template<class Rays>
    HWY_INLINE RayBits hits(const dfield_field& field, const Rays& rays, VF minimum) {
        const F f;
        const I i;
        const LineTable& table = *field.maps.lines;
        const std::uint32_t lattice = table.parameters.lattice;
        const bool pivot = table.parameters.pivot && !table.parameters.filtered;
        for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(f)) {
            const Chords chord(rays.origin(k), rays.direction(k), kLineRadius);
            const MF ahead = hn::And(chord.valid, hn::Gt(chord.t_out(), minimum));
            add_lanes(valid_, k, hn::And(hn::FirstN(f, rays.count() - k), ahead));
            entry_.put(k, chord.at_middle_plus(hn::Neg(chord.half)));
            exit_.put(k, pivot ? chord.middle : chord.at_middle_plus(chord.half));
        }
        RayBits hits{};
        if (table.parameters.filtered) {
            for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(f))
                add_lanes(hits, k, majority_hits(table, entry_[k], exit_[k], lanes_at(valid_, k)));
            return hits;
        }
        for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(f)) {
            const MF valid = lanes_at(valid_, k);
            const VI entry = nearest_lattice_points(lattice, entry_[k]),
                     exit = pivot ? pivoted_exits(lattice, field.line_points.data(), entry, exit_[k], valid)
                                  : nearest_lattice_points(lattice, exit_[k]);
            const VI index = indices(hit_indices(entry, exit), valid);
            hn::Store(hn::ShiftRight<5>(index), i, word_.data() + k);
            hn::Store(hn::Shl(hn::Set(i, 1), hn::And(index, hn::Set(i, 31))), i, bit_.data() + k);
        }
        // One by one: a gathering instruction takes longer.
        const auto* const words = reinterpret_cast<const std::int32_t*>(table.hits.data());
        for (std::size_t k = 0; k < rays.count(); ++k) word_[k] = words[word_[k]];
        for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(f)) {
            const VI both = hn::And(hn::Load(i, word_.data() + k), hn::Load(i, bit_.data() + k));
            add_lanes(hits, k, hn::RebindMask(f, hn::Ne(both, hn::Zero(i))));
        }
        for (std::size_t word = 0; word < hits.size(); ++word) hits[word] &= valid_[word];
        return hits;
    }

  private:
    RayVectors entry_;
    RayVectors exit_;  // or the pivot
    alignas(64) RayArray<std::int32_t> word_, bit_;
    RayBits valid_{};
};

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
    const std::uint32_t lattice = table.parameters.depth_lattice;
    const VI entry = nearest_lattice_points(lattice, chord.at_middle_plus(hn::Neg(chord.half))),
             exit = nearest_lattice_points(lattice, chord.at_middle_plus(chord.half));
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
    hits.last = hn::MulAdd(place(entry, exit), chord.half, chord.t_middle);
    hits.first = kFirst ? hn::NegMulAdd(place(exit, entry), chord.half, chord.t_middle) : hits.last;
    return hits;
}

template<class Rays>
HWY_INLINE void any_line_hits(const dfield_field& field, const Rays& rays, float least, bool in_front,
                              RayBits& open) {
    const VF minimum = set(least);
    LineLookups lookups;
    RayBits hits = lookups.hits(field, rays, minimum);
    for (std::size_t k = 0; k < rays.count() && !in_front; k += hn::Lanes(F())) {
        const MF hit = lanes_at(hits, k);
        if (hn::AllFalse(F(), hit)) continue;
        const Chords chord(rays.origin(k), rays.direction(k), kLineRadius);
        const MF unsure = hn::And(hit, hn::Lt(chord.t_in(), minimum));
        if (hn::AllFalse(F(), unsure)) continue;
        const MF behind = hn::Le(hits_on_lines<false>(field, chord, hit).last, minimum);
        remove_lanes(hits, k, hn::And(unsure, behind));
    }
    close_rays(rays.kept(), hits, open);
}

template<class Rays>
HWY_INLINE void line_distances(const dfield_field& field, const Rays& rays, float least, bool in_front,
                               float* nearest) {
    const VF minimum = set(least);
    LineLookups lookups;
    const RayBits found = lookups.hits(field, rays, minimum);
    for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(F())) {
        const MF hit = lanes_at(found, k);
        if (hn::AllFalse(F(), hit)) continue;
        const Chords chord(rays.origin(k), rays.direction(k), kLineRadius);
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
void lines_any_hits(const RayQuery& query, const GroupedRays& block, RayBits& open) {
    const SharedRays<false> rays(query, block, open, kLineRadius);
    any_line_hits(*query.field, rays, query.minimum, query.in_front, open);
}

void lines_distances(const RayQuery& query, const GroupedRays& block, float* nearest) {
    const SharedRays<true> rays(query, block, first_bits(block.count()), kLineRadius);
    line_distances(*query.field, rays, query.minimum, query.in_front, nearest);
}

void lines_ray_any_hits(const Instance& instance, const RayBlock& block, RayBits& open) {
    const OwnRays<false> rays(line_space(instance), instance, false, block, open);
    any_line_hits(*instance.field, rays, 0, false, open);
}

void lines_ray_distances(const Instance& instance, const RayBlock& block, float* nearest) {
    const OwnRays<true> rays(line_space(instance), instance, false, block, first_bits(block.count));
    line_distances(*instance.field, rays, 0, false, nearest);
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
