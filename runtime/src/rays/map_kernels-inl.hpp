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

// What texels hold.
struct MapHits {
    MF hit;
    VF t;
};

// A texel's raw bits.
template<int kBits>
HWY_INLINE std::int32_t stored_texel(const std::uint8_t* texels, std::int32_t texel) {
    return kBits == 8 ? texels[texel] : texels[texel >> 3] >> (texel & 7) & 1;
}

// Reads lane by lane: a gathering instruction takes longer for bytes, on processors old and new.
template<int kBits>
HWY_INLINE VI stored_texels(const dfield_field& field, VI texels) {
    alignas(64) std::int32_t lanes[hn::MaxLanes(I())];
    hn::Store(texels, I(), lanes);
    for (std::int32_t& lane : lanes) lane = stored_texel<kBits>(field.maps.texels.data(), lane);
    return hn::Load(I(), lanes);
}

template<int kBits>
HWY_INLINE MapHits hits_of(const dfield_field& field, const Probes& probes, VI stored) {
    if constexpr (kBits == 8) {
        return {hn::RebindMask(F(), hn::Ne(stored, hn::Set(I(), kMiss8))),
                hn::MulAdd(hn::ConvertTo(F(), stored), hn::Mul(probes.scale, set(2 / 254.0f)), probes.base)};
    } else {
        const MF hit = hn::RebindMask(F(), hn::Ne(stored, hn::Zero(I())));
        if (hn::AllTrue(F(), hn::Eq(probes.scale, hn::Zero(F())))) return {hit, probes.base};
        // hit_parameter's mean depth along the normal, carried along the ray.
        alignas(64) std::int32_t depths[hn::MaxLanes(I())];
        hn::Store(probes.map, I(), depths);
        for (std::int32_t& lane : depths) lane = field.maps.mean_depth[static_cast<std::size_t>(lane)];
        const VI raw = hn::Load(I(), depths);
        const VF depth = hn::Mul(hn::ConvertTo(F(), raw), set(2 / 65535.0f)), cosine = probes.cosine;
        const VF distance =
            hn::Div(hn::Min(depth, hn::Mul(hn::Add(cosine, cosine), cosine)), hn::Max(cosine, set(1e-6f)));
        return {hit, hn::MulAdd(distance, probes.scale, probes.base)};
    }
}

// Lookups on their way, between finding the texel and reading it.
struct PendingProbes {
    alignas(64) RayArray<std::int32_t> texel, map;
    alignas(64) RayArray<float> scale, base, cosine;

    HWY_INLINE void put(std::size_t k, const Probes& probes) {
        hn::Store(probes.texel, I(), texel.data() + k);
        hn::Store(probes.map, I(), map.data() + k);
        hn::Store(probes.scale, F(), scale.data() + k);
        hn::Store(probes.base, F(), base.data() + k);
        hn::Store(probes.cosine, F(), cosine.data() + k);
    }
    HWY_INLINE Probes get(std::size_t k) const {
        return {hn::Load(I(), texel.data() + k), hn::Load(I(), map.data() + k),
                hn::Load(F(), scale.data() + k), hn::Load(F(), base.data() + k),
                hn::Load(F(), cosine.data() + k)};
    }
};

// Finds all texels, and asks for their memory, before it reads the first: tables are larger than the nearer
// caches.
template<int kBits, class Rays>
HWY_INLINE void any_map_hits(const dfield_field& field, const Rays& rays, float least, bool in_front,
                             std::uint8_t* blocked) {
    const F f;
    const MapField maps(field);
    const VF minimum = set(least), infinity = set(std::numeric_limits<float>::infinity());
    const MF front = in_front ? hn::Eq(minimum, minimum) : hn::Ne(minimum, minimum);
    const std::uint8_t* const texels = field.maps.texels.data();
    PendingProbes pending;
    Marks marks;
    for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(f)) {
        const Chords chord(rays.origin(k), rays.direction(k));
        const MF inside = hn::FirstN(f, rays.count() - k);
        const MF valid = hn::And(inside, hn::And(chord.valid, hn::Gt(chord.t_out(), minimum)));
        // From outside the sphere every hit is ahead. From inside the exit point is asked, looking back.
        const MF outside = hn::Ge(chord.t_in(), minimum);
        Probes probes = probe(maps, chord, hn::Not(outside), valid);
        const MF sure = hn::Or(front, outside);
        probes.scale = hn::IfThenZeroElse(hn::Or(sure, hn::Not(valid)), probes.scale);
        probes.base = hn::IfThenElse(valid, hn::IfThenElse(sure, infinity, probes.base), hn::Neg(infinity));
        pending.put(k, probes);
        // Those of the lanes before: they can be loaded one by one from where they were stored by now.
        for (std::size_t lane = k < hn::Lanes(f) ? k : k - hn::Lanes(f); lane < k; ++lane)
            prefetch(texels + (kBits == 8 ? pending.texel[lane] : pending.texel[lane] >> 3));
    }
    for (std::size_t k = 0; k < rays.count(); ++k)
        pending.texel[k] = stored_texel<kBits>(texels, pending.texel[k]);
    for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(f)) {
        const Probes probes = pending.get(k);
        const MapHits found = hits_of<kBits>(field, probes, probes.texel);
        marks.put(k, rays.ids(k), hn::And(found.hit, hn::Gt(found.t, minimum)));
    }
    marks.write(rays.count(), blocked);
}

template<int kBits, class Rays>
HWY_INLINE void map_distances(const dfield_field& field, const Rays& rays, float least, bool in_front,
                              float* nearest) {
    const F f;
    const MapField maps(field);
    const VF zero = set(0), minimum = set(in_front ? 0 : least);
    const MF none = hn::Ne(zero, zero);
    Rays again(rays, 0);  // the first hit lies behind the origin: the last one is asked for
    for (std::size_t k = 0; k < rays.count(); k += hn::Lanes(f)) {
        const Chords chord(rays.origin(k), rays.direction(k));
        const MF inside = hn::FirstN(f, rays.count() - k);
        const MF valid = hn::And(inside, hn::And(chord.valid, hn::Gt(chord.t_out(), zero)));
        const Probes probes = probe(maps, chord, none, valid);
        const MapHits found = hits_of<kBits>(field, probes, stored_texels<kBits>(field, probes.texel));
        const MF hit = hn::And(valid, found.hit);
        const VF t = hn::Max(
            found.t, in_front ? zero : hn::IfThenElse(hn::Ge(chord.t_in(), zero), chord.t_in(), found.t));
        lower(rays.ids(k), hn::And(hit, hn::Ge(t, minimum)), t, nearest);
        const MF behind = hn::And(hit, hn::Lt(t, zero));
        if (!hn::AllFalse(f, behind)) again.add(rays, k, behind);
    }
    for (std::size_t k = 0; k < again.count(); k += hn::Lanes(f)) {
        const Chords chord(again.origin(k), again.direction(k));
        const MF valid = hn::FirstN(f, again.count() - k);
        const Probes probes = probe(maps, chord, hn::Not(none), valid);
        const MapHits found = hits_of<kBits>(field, probes, stored_texels<kBits>(field, probes.texel));
        const MF ahead = hn::And(hn::Gt(found.t, zero), hn::Ge(found.t, minimum));
        lower(again.ids(k), hn::And(hn::And(valid, found.hit), ahead), found.t, nearest);
    }
}

template<class Rays>
HWY_INLINE void any_map_hits(const dfield_field& field, const Rays& rays, float least, bool in_front,
                             std::uint8_t* blocked) {
    field.maps.parameters.bits == 8 ? any_map_hits<8>(field, rays, least, in_front, blocked)
                                    : any_map_hits<1>(field, rays, least, in_front, blocked);
}
template<class Rays>
HWY_INLINE void map_distances(const dfield_field& field, const Rays& rays, float least, bool in_front,
                              float* nearest) {
    field.maps.parameters.bits == 8 ? map_distances<8>(field, rays, least, in_front, nearest)
                                    : map_distances<1>(field, rays, least, in_front, nearest);
}

// What RayKernels wants.
void maps_any_hits(const RayQuery& query, const float* x, const float* y, const float* z, std::size_t count,
                   std::uint8_t* blocked) {
    if (!has_map_kernel(*query.field))
        return kRayLookupsReference.maps.any_hits(query, x, y, z, count, blocked);
    const SharedRays rays(query, x, y, z, count, blocked);
    any_map_hits(*query.field, rays, query.minimum, query.in_front, blocked);
}

void maps_distances(const RayQuery& query, const float* x, const float* y, const float* z, std::size_t count,
                    float* nearest) {
    if (!has_map_kernel(*query.field))
        return kRayLookupsReference.maps.distances(query, x, y, z, count, nearest);
    const SharedRays rays(query, x, y, z, count, nullptr);
    map_distances(*query.field, rays, query.minimum, query.in_front, nearest);
}

void maps_ray_any_hits(const Instance& instance, const RayBlock& block, std::uint8_t* blocked) {
    if (!has_map_kernel(*instance.field))
        return kRayLookupsReference.maps.ray_any_hits(instance, block, blocked);
    const OwnRays rays({instance.to_unit, instance.unit_offset}, instance, true, block, blocked);
    any_map_hits(*instance.field, rays, 0, false, blocked);
}

void maps_ray_distances(const Instance& instance, const RayBlock& block, float* nearest) {
    if (!has_map_kernel(*instance.field))
        return kRayLookupsReference.maps.ray_distances(instance, block, nearest);
    const OwnRays rays({instance.to_unit, instance.unit_offset}, instance, true, block, nullptr);
    map_distances(*instance.field, rays, 0, false, nearest);
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
