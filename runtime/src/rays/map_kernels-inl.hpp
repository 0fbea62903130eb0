// Lookups in displacement maps. Seen once a target.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "rays/cull-inl.hpp"
#include "rays/kernels.hpp"
#include "rays/map_lookup-inl.hpp"

#if defined(DFIELD_RAYS_MAP_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_RAYS_MAP_KERNELS_INL
#undef DFIELD_RAYS_MAP_KERNELS_INL
#else
#define DFIELD_RAYS_MAP_KERNELS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

// Other layouts and bit depths are experiments of the paper: the plain path looks them up.
inline bool has_map_kernel(const dfield_field& field) {
    const FieldParameters& parameters = field.maps.parameters;
    return std::endian::native == std::endian::little && parameters.positions == Positions::kSlater &&
           parameters.mapping == Mapping::kConcentric && (parameters.bits == 1 || parameters.bits == 8);
}

// Which end of a ray's chord is asked.
enum class AskedEnd {
    kEntry,
    kExit,
    kSurest,  // the entry, but the exit where the origin lies beyond it: then the last hit decides
};

// Rays of a block on their way to the maps, in steps that are short enough for the processor to have several
// vectors in each under way.
template<int kBits>
class MapLookups {
  public:
    // Rays whose chords end ahead of t = minimum are looked up. Finds all texels, and asks for their memory,
    // before the first is read: tables are larger than the nearer caches.
    template<class Rays>
    HWY_INLINE MapLookups(const dfield_field& field, const Rays& rays, AskedEnd end, VF minimum)
        : count_(rays.count()) {
        const F f;
        const I i;
        const MapField maps(field);
        const MF exits = end == AskedEnd::kExit ? hn::Eq(minimum, minimum) : hn::Ne(minimum, minimum);
        for (std::size_t k = 0; k < count_; k += hn::Lanes(f)) {
            const Chords chord(rays.origin(k), rays.direction(k));
            const MF ahead = hn::And(chord.valid, hn::Gt(chord.t_out(), minimum));
            add_lanes(valid_, k, hn::And(hn::FirstN(f, count_ - k), ahead));
            const MF inside = hn::Lt(chord.t_in(), minimum), exit = end == AskedEnd::kSurest ? inside : exits;
            middle_.put(k, chord.middle);
            end_.put(k, chord.at_middle_plus(hn::IfThenElse(exit, chord.half, hn::Neg(chord.half))));
        }
        for (std::size_t k = 0; k < count_; k += hn::Lanes(f)) {
            const Samples sample = nearest_sample(maps, end_[k]);
            const VF index = hn::IfThenElseZero(lanes_at(valid_, k), sample.index);
            hn::Store(truncated(index), i, value_.data() + k);
            hn::Store(sample.inverse_height, f, inverse_height_.data() + k);
            add_lanes(flipped_, k, sample.flipped);
            end_.put(k, sample.point);
        }
        const VI stride = hn::Set(i, static_cast<std::int32_t>(field.map_stride)), one = hn::Set(i, 1),
                 bit_stride = hn::Set(i, static_cast<std::int32_t>(8 * bit_map_bytes(field)));
        const std::uint8_t* const bits = hit_bits(field);
        for (std::size_t k = 0; k < count_; k += hn::Lanes(f)) {
            const V3 point = end_[k], aim = middle_[k] - point;
            const Samples sample{point, set(0), hn::Load(f, inverse_height_.data() + k),
                                 lanes_at(flipped_, k)};
            const VI texel = truncated(texel_of(maps, sample, aim, inverse_root(dot(aim, aim))));
            const VI map = hn::Load(i, value_.data() + k), bit = hn::Add(hn::Mul(map, bit_stride), texel);
            hn::Store(hn::ShiftRight<3>(bit), i, byte_.data() + k);
            hn::Store(hn::Shl(one, hn::And(bit, hn::Set(i, 7))), i, bit_.data() + k);
            if (kBits == 8) hn::Store(hn::Add(hn::Mul(map, stride), texel), i, value_.data() + k);
            // Those of the lanes before: they can be loaded one by one from where they were stored by now.
            for (std::size_t lane = k < hn::Lanes(f) ? k : k - hn::Lanes(f); lane < k; ++lane)
                prefetch(bits + byte_[lane]);
        }
    }

    // Rays with a hit on their line.
    HWY_INLINE RayBits hits(const dfield_field& field) {
        const std::uint8_t* const bits = hit_bits(field);
        for (std::size_t k = 0; k < count_; ++k) byte_[k] = bits[byte_[k]];
        RayBits hits{};
        for (std::size_t k = 0; k < count_; k += hn::Lanes(F())) {
            const VI both = hn::And(hn::Load(I(), byte_.data() + k), hn::Load(I(), bit_.data() + k));
            add_lanes(hits, k, hn::RebindMask(F(), hn::Ne(both, hn::Zero(I()))));
        }
        for (std::size_t word = 0; word < hits.size(); ++word) hits[word] &= valid_[word];
        return hits;
    }

    // For `parameters`: reads how far the hits are.
    HWY_INLINE void read_depths(const dfield_field& field, const RayBits& hits) {
        for (std::size_t word = 0; word < hits.size(); ++word)
            for (std::uint64_t left = hits[word]; left != 0; left &= left - 1) {
                const std::size_t k = 64 * word + static_cast<std::size_t>(std::countr_zero(left));
                const auto place = static_cast<std::size_t>(value_[k]);
                value_[k] = kBits == 8 ? field.maps.texels[place] : field.maps.mean_depth[place];
            }
    }

    // hit_parameter of the rays from k on, whose chords these are; nonsense where there is no hit.
    HWY_INLINE VF parameters(const Chords& chord, std::size_t k) const {
        const V3 point = end_[k], aim = chord.middle - point;
        const VF inverse_length = inverse_root(dot(aim, aim));
        const VF towards = hn::Mul(dot(aim, chord.direction), chord.inverse_square);
        const VF value = hn::ConvertTo(F(), hn::Load(I(), value_.data() + k));
        VF distance;
        if constexpr (kBits == 8) {
            distance = hn::Mul(value, set(2 / 254.0f));
        } else {
            // The mean depth along the normal, carried along the ray.
            const VF depth = hn::Mul(value, set(2 / 65535.0f));
            const VF cosine = hn::Mul(hn::Neg(dot(aim, point)), inverse_length);
            distance = hn::Div(hn::Min(depth, hn::Mul(hn::Add(cosine, cosine), cosine)),
                               hn::Max(cosine, set(1e-6f)));
        }
        return hn::MulAdd(distance, hn::Mul(inverse_length, towards), hn::Sub(chord.t_middle, towards));
    }

  private:
    // A bit for each texel, 1 for a hit.
    static const std::uint8_t* hit_bits(const dfield_field& field) {
        return kBits == 8 ? field.hit_bits.data() : field.maps.texels.data();
    }
    static std::size_t bit_map_bytes(const dfield_field& field) {
        return kBits == 8 ? field.hit_stride() : field.map_stride;
    }

    std::size_t count_;
    RayVectors middle_;  // of chords
    RayVectors end_;     // of chords, then the sample there
    alignas(64) RayArray<float> inverse_height_;
    // The map; of 8 bit then the place of the texel; then its distance, of 1 bit the map's mean depth.
    alignas(64) RayArray<std::int32_t> value_;
    alignas(64) RayArray<std::int32_t> byte_;  // place of the byte that says whether there is a hit; the byte
    alignas(64) RayArray<std::int32_t> bit_;   // the bit in it
    RayBits valid_{}, flipped_{};
};

template<int kBits, class Rays>
HWY_INLINE void any_map_hits(const dfield_field& field, const Rays& rays, float least, bool in_front,
                             RayBits& open) {
    const VF minimum = set(least);
    MapLookups<kBits> lookups(field, rays, AskedEnd::kSurest, minimum);
    RayBits hits = lookups.hits(field);
    if (!in_front) lookups.read_depths(field, hits);
    for (std::size_t k = 0; k < rays.count() && !in_front; k += hn::Lanes(F())) {
        const MF hit = lanes_at(hits, k);
        if (hn::AllFalse(F(), hit)) continue;
        const Chords chord(rays.origin(k), rays.direction(k));
        const MF unsure = hn::And(hit, hn::Lt(chord.t_in(), minimum));
        if (hn::AllFalse(F(), unsure)) continue;
        const MF behind = hn::Le(lookups.parameters(chord, k), minimum);
        remove_lanes(hits, k, hn::And(unsure, behind));
    }
    close_rays(rays.kept(), hits, open);
}

// Lowers nearest hits to those found from one end. again(k, lanes) is told where the hit lies behind t = 0.
template<int kBits, class Rays, class Again>
HWY_INLINE void map_distances_from(AskedEnd end, const dfield_field& field, const Rays& rays, VF minimum,
                                   bool in_front, float* nearest, const Again& again) {
    const VF zero = set(0);
    MapLookups<kBits> lookups(field, rays, end, zero);
    const RayBits hits = lookups.hits(field);
    lookups.read_depths(field, hits);
    for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(F())) {
        const MF hit = lanes_at(hits, k);
        if (hn::AllFalse(F(), hit)) continue;
        const Chords chord(rays.origin(k), rays.direction(k));
        VF t = lookups.parameters(chord, k);
        if (end == AskedEnd::kEntry) {
            const VF entry = hn::IfThenElse(hn::Ge(chord.t_in(), zero), chord.t_in(), t);
            t = hn::Max(t, in_front ? zero : entry);
            again(k, hn::And(hit, hn::Lt(t, zero)));
        }
        lower(rays.ids(k), hn::And(hit, hn::Ge(t, minimum)), t, nearest);
    }
}

template<int kBits, class Rays>
HWY_INLINE void map_distances(const dfield_field& field, const Rays& rays, float least, bool in_front,
                              float* nearest) {
    Rays again(rays, 0);  // the first hit lies behind the origin: the last one is asked for
    map_distances_from<kBits>(AskedEnd::kEntry, field, rays, set(in_front ? 0 : least), in_front, nearest,
                              [&](std::size_t k, MF behind) HWY_ATTR {
                                  if (!hn::AllFalse(F(), behind)) again.add(rays, k, behind);
                              });
    // Ahead of the origin, not at it.
    const float minimum = std::max(least, std::numeric_limits<float>::min());
    if (again.count() != 0)
        map_distances_from<kBits>(AskedEnd::kExit, field, again, set(minimum), in_front, nearest,
                                  [](std::size_t, MF) {});
}

template<class Rays>
HWY_INLINE void any_map_hits(const dfield_field& field, const Rays& rays, float least, bool in_front,
                             RayBits& open) {
    field.maps.parameters.bits == 8 ? any_map_hits<8>(field, rays, least, in_front, open)
                                    : any_map_hits<1>(field, rays, least, in_front, open);
}
template<class Rays>
HWY_INLINE void map_distances(const dfield_field& field, const Rays& rays, float least, bool in_front,
                              float* nearest) {
    field.maps.parameters.bits == 8 ? map_distances<8>(field, rays, least, in_front, nearest)
                                    : map_distances<1>(field, rays, least, in_front, nearest);
}

// What RayKernels wants.
void maps_any_hits(const RayQuery& query, const GroupedRays& block, RayBits& open) {
    if (!has_map_kernel(*query.field)) return kRayLookupsReference.maps.any_hits(query, block, open);
    const SharedRays<false> rays(query, block, open);
    any_map_hits(*query.field, rays, query.minimum, query.in_front, open);
}

void maps_distances(const RayQuery& query, const GroupedRays& block, float* nearest) {
    if (!has_map_kernel(*query.field)) return kRayLookupsReference.maps.distances(query, block, nearest);
    const SharedRays<true> rays(query, block, first_bits(block.count()));
    map_distances(*query.field, rays, query.minimum, query.in_front, nearest);
}

void maps_ray_any_hits(const Instance& instance, const RayBlock& block, RayBits& open) {
    if (!has_map_kernel(*instance.field))
        return kRayLookupsReference.maps.ray_any_hits(instance, block, open);
    const OwnRays<false> rays({instance.to_unit, instance.unit_offset}, instance, true, block, open);
    any_map_hits(*instance.field, rays, 0, false, open);
}

void maps_ray_distances(const Instance& instance, const RayBlock& block, float* nearest) {
    if (!has_map_kernel(*instance.field))
        return kRayLookupsReference.maps.ray_distances(instance, block, nearest);
    const OwnRays<true> rays({instance.to_unit, instance.unit_offset}, instance, true, block,
                             first_bits(block.count));
    map_distances(*instance.field, rays, 0, false, nearest);
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
