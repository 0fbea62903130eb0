// probe_line of lookup.hpp for fields of Slater's points and concentric maps, without
// reading anything but the texel: the sample's place and frame are computed, where a table of samples would
// take six gathers. Seen once a target.
#include <cstddef>
#include <cstdint>

#include "field.hpp"
#include "rays/vector-inl.hpp"

#if defined(DFIELD_RAYS_MAP_LOOKUP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_RAYS_MAP_LOOKUP_INL
#undef DFIELD_RAYS_MAP_LOOKUP_INL
#else
#define DFIELD_RAYS_MAP_LOOKUP_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

// What all lookups in one field share.
struct MapField {
    explicit MapField(const dfield_field& field)
        : n(static_cast<float>(field.maps.parameters.subdivision)),
          points(static_cast<float>(field.points.size())),
          map_size(static_cast<float>(field.maps.parameters.map_size)) {}

    float n, points, map_size;
};

// A positional sample near a point of the sphere.
struct Samples {
    V3 point;
    VF index;
    VF inverse_height;  // 1 / (1 + |point.z|)
    MF flipped;         // frames of its directions start from -1 (frame_of_normal's sign)
};

// The sample of a ring that is nearest in azimuth.
struct RingSamples {
    VF k, j, offset;          // offset: azimuth beyond the sample's, radians
    VF height, radius, root;  // |z|, sqrt(1 - z^2), 1 / sqrt(1 + |z|)
    VF cosine;                // of offset

    HWY_INLINE RingSamples(const MapField& field, VF ring, VF turns) : k(ring) {
        const VF along_ring = hn::Mul(turns, k);
        j = hn::Floor(hn::Add(along_ring, set(0.5f)));
        offset = hn::Mul(hn::Mul(hn::Sub(along_ring, j), set(1.57079633f)), reciprocal(hn::Max(k, set(1))));
        const VF u = hn::Mul(k, set(1 / field.n));
        height = hn::Mul(hn::MulAdd(k, hn::Neg(k), set(field.n * field.n)), set(1 / (field.n * field.n)));
        const VF w = hn::Add(height, set(1));
        root = inverse_root(w);
        radius = hn::Mul(u, hn::Mul(w, root));
        // Half a step of the first ring, an eighth of a turn, is the farthest.
        const VF a = hn::Mul(offset, offset);
        cosine =
            hn::MulAdd(a, hn::MulAdd(a, hn::MulAdd(a, set(-1 / 720.0f), set(1 / 24.0f)), set(-0.5f)), set(1));
    }
};

// nearest_slater, and the sample that it finds.
HWY_INLINE Samples nearest_sample(const MapField& field, const V3& q) {
    const VF zero = set(0), one = set(1);
    const VF square = hn::MulAdd(q.x, q.x, hn::Mul(q.y, q.y));
    const VF inverse_radius = inverse_root(square), radius = hn::Mul(square, inverse_radius);
    const VF height = hn::Abs(q.z);
    const MF south = hn::Lt(q.z, zero);
    const VF ring = hn::Mul(hn::Mul(set(field.n), radius), inverse_root(hn::Add(one, height)));
    const VF inner = hn::Min(hn::Floor(ring), set(field.n - 1));
    const VF turns = quarter_turns(q.x, q.y);
    const RingSamples a(field, inner, turns), b(field, hn::Add(inner, one), turns);
    const VF towards_a = hn::MulAdd(a.height, height, hn::Mul(hn::Mul(a.radius, radius), a.cosine));
    const VF towards_b = hn::MulAdd(b.height, height, hn::Mul(hn::Mul(b.radius, radius), b.cosine));
    const MF first = hn::Ge(towards_a, towards_b);
    const auto pick = [first](VF x, VF y) HWY_ATTR { return hn::IfThenElse(first, x, y); };
    const VF k = pick(a.k, b.k), j = pick(a.j, b.j), z = pick(a.height, b.height),
             root = pick(a.root, b.root);

    // Turned back from q's azimuth to the sample's.
    const VF offset = pick(a.offset, b.offset), cosine = pick(a.cosine, b.cosine);
    const VF s = hn::Mul(offset, offset);
    const VF sine = hn::Mul(
        offset,
        hn::MulAdd(s, hn::MulAdd(s, hn::MulAdd(s, set(-1 / 5040.0f), set(1 / 120.0f)), set(-1 / 6.0f)), one));
    const VF scale = hn::Mul(pick(a.radius, b.radius), inverse_radius);
    Samples result;
    result.point.x = hn::Mul(scale, hn::MulAdd(q.x, cosine, hn::Mul(q.y, sine)));
    result.point.y = hn::Mul(scale, hn::NegMulAdd(q.x, sine, hn::Mul(q.y, cosine)));
    result.point.z = hn::IfThenElse(south, hn::Neg(z), z);
    result.inverse_height = hn::Mul(root, root);
    result.flipped = hn::And(hn::Not(south), hn::Gt(z, zero));

    // SlaterRings::index.
    const VF wrapped = hn::IfThenElseZero(hn::Lt(j, hn::Mul(k, set(4))), j);
    const VF two_k = hn::Add(k, k);
    const VF north_first = hn::IfThenElseZero(hn::Gt(k, zero), hn::MulAdd(two_k, hn::Sub(k, one), one));
    const VF south_first = hn::Sub(set(field.points - 1), hn::Mul(two_k, hn::Add(k, one)));
    const MF mirrored = hn::And(south, hn::Lt(k, set(field.n)));
    result.index = hn::Add(hn::IfThenElse(mirrored, south_first, north_first), wrapped);
    return result;
}

// concentric_texel of a direction in the frame of -point.
HWY_INLINE VF texel_of(const MapField& field, const Samples& sample, const V3& aim, VF inverse_length) {
    // frame_of_normal(n).to_local(aim) with n = -point.
    const V3 n{hn::Neg(sample.point.x), hn::Neg(sample.point.y), hn::Neg(sample.point.z)};
    const VF sign = hn::IfThenElse(sample.flipped, set(-1), set(1));
    const VF e = hn::MulAdd(n.x, aim.x, hn::Mul(n.y, aim.y));
    const VF g = hn::Sub(hn::Neg(hn::Mul(hn::Mul(sign, sample.inverse_height), e)), aim.z);
    const VF x = hn::MulAdd(hn::Mul(sign, n.x), g, aim.x);
    const VF y = hn::MulAdd(n.y, g, hn::Mul(sign, aim.y));

    const VF square = hn::MulAdd(x, x, hn::Mul(y, y));
    const VF radius = hn::Mul(hn::Mul(square, inverse_root(square)), inverse_length);
    const MF turned = hn::Lt(hn::Abs(x), hn::Abs(y));
    const VF major = hn::IfThenElse(turned, y, x), minor = hn::IfThenElse(turned, x, y);
    const VF slope =
        hn::CopySign(hn::Mul(minor, reciprocal(hn::Max(hn::Abs(major), set(1e-30f)))), hn::Xor(major, minor));
    const VF a = hn::CopySign(radius, major);
    const VF b = hn::Mul(hn::Add(a, a), quarter_turns_of_slope(slope));
    const VF half = set(0.5f * field.map_size), top = set(field.map_size - 1), zero = set(0);
    const auto cell = [&](VF unit) HWY_ATTR {
        return hn::Floor(hn::Min(hn::Max(hn::MulAdd(unit, half, half), zero), top));
    };
    const VF s = cell(hn::IfThenElse(turned, b, a)), t = cell(hn::IfThenElse(turned, a, b));
    return hn::MulAdd(t, set(field.map_size), s);
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
