// Lookups of occlusion volumes, a vector of receivers at a time: volume_reference.cpp with arcs by a
// polynomial.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octants/volume_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "octants/volume_caster.hpp"
#include "simd.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using DI = hn::RebindToSigned<D>;
using VI = hn::Vec<DI>;

constexpr float kPi = 3.14159265f;

HWY_INLINE V set(float value) {
    return hn::Set(D(), value);
}

struct V3 {
    V x, y, z;
};
HWY_INLINE V3 load(const float* x, const float* y, const float* z) {
    const D d;
    return {hn::Load(d, x), hn::Load(d, y), hn::Load(d, z)};
}
HWY_INLINE V dot(const V3& a, const V3& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE V dot(const glm::vec3& a, const V3& b) {
    return hn::MulAdd(set(a.x), b.x, hn::MulAdd(set(a.y), b.y, hn::Mul(set(a.z), b.z)));
}
HWY_INLINE V3 transformed(const glm::mat3& m, const V3& v) {
    return {dot(glm::vec3(m[0].x, m[1].x, m[2].x), v), dot(glm::vec3(m[0].y, m[1].y, m[2].y), v),
            dot(glm::vec3(m[0].z, m[1].z, m[2].z), v)};
}
HWY_INLINE V3 moved(const V3& v, const glm::vec3& offset) {
    return {hn::Add(v.x, set(offset.x)), hn::Add(v.y, set(offset.y)), hn::Add(v.z, set(offset.z))};
}
HWY_INLINE V length(const V3& v) {
    return hn::Sqrt(dot(v, v));
}
// Within 0..high; 0 for NaN.
HWY_INLINE V within(V value, V high) {
    return hn::IfThenElseZero(hn::Gt(value, hn::Zero(D())), hn::Min(value, high));
}

// atan2(y, x) for y >= 0, not both 0, within 1e-5.
HWY_INLINE V arc(V y, V x) {
    const D d;
    const V ax = hn::Abs(x), high = hn::Max(hn::Max(ax, y), set(1e-30f));
    const V t = hn::Div(hn::Min(ax, y), high), s = hn::Mul(t, t);
    V p = hn::MulAdd(s, set(-0.01172120f), set(0.05265332f));
    p = hn::MulAdd(s, p, set(-0.11643287f));
    p = hn::MulAdd(s, p, set(0.19354346f));
    p = hn::MulAdd(s, p, set(-0.33262347f));
    p = hn::Mul(t, hn::MulAdd(s, p, set(0.99997726f)));
    p = hn::IfThenElse(hn::Gt(y, ax), hn::Sub(set(kPi / 2), p), p);
    return hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(set(kPi), p), p);
}

HWY_INLINE V ball_occlusion(V square_sine, V cosine) {
    const V zero = hn::Zero(D());
    const V rim = hn::Sqrt(hn::Max(hn::Sub(set(1), square_sine), zero));
    const V cut = hn::Sqrt(hn::Max(hn::NegMulAdd(cosine, cosine, square_sine), zero));
    const V above =
        hn::MulSub(hn::Mul(square_sine, cosine), arc(cut, hn::Neg(hn::Mul(cosine, rim))), hn::Mul(rim, cut));
    const V sum = hn::Mul(set(1 / kPi), hn::Add(above, arc(cut, rim)));
    return hn::Min(hn::Max(sum, zero), set(1));
}

// Sum of darkness times octant_terms() over the octants.
HWY_INLINE V faced_darkness(const OctantCones& cones, const V3& n, V (&dark)[kOctantCount]) {
    const V zero = hn::Zero(D()), pi = set(kPi), half = set(0.5f);
    V a[3], nu[3], cosine[3], angle[3];
    hn::Mask<D> positive[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const V facing = dot(cones.axis[k], n), towards = dot(cones.normal[k], n);
        positive[k] = hn::Ge(facing, zero);
        // Two zeros have no angle; that of two equal small numbers serves everything that multiplies it.
        a[k] = hn::Max(hn::Abs(facing), set(1e-6f));
        nu[k] = hn::IfThenElse(positive[k], towards, hn::Neg(towards));
        // By which of the octant's axes lie opposite to N.
        for (std::size_t s = 0; s < kOctantCount; ++s)
            if ((s >> k & 1) == 0) {
                const V low = dark[s], high = dark[s | 1u << k];
                dark[s] = hn::IfThenElse(positive[k], high, low);
                dark[s | 1u << k] = hn::IfThenElse(positive[k], low, high);
            }
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const auto differ = hn::Xor(positive[(k + 1) % 3], positive[(k + 2) % 3]);
        cosine[k] = hn::IfThenElse(differ, set(-cones.cosine[k]), set(cones.cosine[k]));
        angle[k] = hn::IfThenElse(differ, set(kPi - cones.angle[k]), set(cones.angle[k]));
    }
    const V all =
        hn::Mul(half, hn::MulAdd(angle[0], nu[0], hn::MulAdd(angle[1], nu[1], hn::Mul(angle[2], nu[2]))));
    V sum = hn::Mul(all, dark[0]);
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        const V to_i = arc(hn::Mul(a[k], set(cones.sine[j])), hn::NegMulAdd(cosine[j], a[k], a[i]));
        const V to_j = arc(hn::Mul(a[k], set(cones.sine[i])), hn::NegMulAdd(cosine[i], a[k], a[j]));
        const V slanted =
            hn::MulAdd(a[i], cosine[i], hn::NegMulAdd(a[k], cosine[k], hn::Mul(a[j], cosine[j])));
        const V horizon =
            arc(hn::Mul(a[k], set(cones.volume)), hn::NegMulAdd(a[k], slanted, hn::Mul(a[i], a[j])));
        const V corner =
            hn::Max(zero, hn::Mul(half, hn::NegMulAdd(nu[j], to_i, hn::NegMulAdd(nu[i], to_j, horizon))));
        const V whole =
            hn::Mul(half, hn::MulAdd(hn::Sub(pi, angle[i]), nu[i],
                                     hn::MulSub(hn::Sub(pi, angle[j]), nu[j], hn::Mul(angle[k], nu[k]))));
        sum = hn::MulAdd(hn::Add(corner, whole), dark[1u << k], sum);
        sum = hn::MulAdd(corner, dark[7u ^ 1u << k], sum);
    }
    return sum;
}

// A coordinate as the sample below it and what is left.
struct Place {
    VI low;
    V rest;
};
HWY_INLINE Place place(V at, float last) {
    const V inside = within(at, set(last));
    const VI low = hn::Min(hn::ConvertTo(DI(), inside), hn::Set(DI(), static_cast<int>(last) - 1));
    return {low, hn::Sub(inside, hn::ConvertTo(D(), low))};
}

template<int kShift>
HWY_INLINE V byte_of(VI word) {
    return hn::ConvertTo(D(), hn::And(hn::ShiftRight<kShift>(word), hn::Set(DI(), 0xff)));
}

HWY_INLINE void darkness_at(const VolumeCaster& caster, const V3& at, V (&dark)[kOctantCount]) {
    const DI di;
    const OcclusionVolume& volume = *caster.volume;
    const Place x = place(at.x, caster.last.x), y = place(at.y, caster.last.y),
                z = place(at.z, caster.last.z);
    const auto row = static_cast<int>(volume.dims[0]), slice = row * static_cast<int>(volume.dims[1]);
    const VI sample =
        hn::Add(x.low, hn::Add(hn::Mul(y.low, hn::Set(di, row)), hn::Mul(z.low, hn::Set(di, slice))));
    const VI words = hn::ShiftLeft<1>(sample);  // two a sample
    const auto* const base = reinterpret_cast<const std::int32_t*>(volume.octants.data());
    const V one = set(1);
    V open[kOctantCount];
    for (V& value : open) value = hn::Zero(D());
    for (int corner = 0; corner < 8; ++corner) {
        const V wx = corner & 1 ? x.rest : hn::Sub(one, x.rest);
        const V wy = corner & 2 ? y.rest : hn::Sub(one, y.rest);
        const V wz = corner & 4 ? z.rest : hn::Sub(one, z.rest);
        const V weight = hn::Mul(wx, hn::Mul(wy, wz));
        const int step = (corner & 1) + row * (corner >> 1 & 1) + slice * (corner >> 2);
        for (std::size_t part = 0; part < 2; ++part) {
            const VI word = hn::GatherIndex(di, base + 2 * step + part, words);
            V* const octants = open + 4 * part;
            octants[0] = hn::MulAdd(weight, byte_of<0>(word), octants[0]);
            octants[1] = hn::MulAdd(weight, byte_of<8>(word), octants[1]);
            octants[2] = hn::MulAdd(weight, byte_of<16>(word), octants[2]);
            octants[3] = hn::MulAdd(weight, byte_of<24>(word), octants[3]);
        }
    }
    for (std::size_t octant = 0; octant < kOctantCount; ++octant)
        dark[octant] = hn::NegMulAdd(open[octant], set(1.0f / 255), one);
}

// What of the hemisphere the object hides, by the octants and by the ball.
HWY_INLINE V near_occlusion(const VolumeCaster& caster, const V3& at, const V3& n) {
    V dark[kOctantCount];
    darkness_at(caster, at, dark);
    return hn::Mul(set(1 / kPi), faced_darkness(caster.cones, n, dark));
}

HWY_INLINE V far_occlusion(const VolumeCaster& caster, const V3& unit, const V3& n) {
    const D d;
    const DI di;
    const V zero = hn::Zero(d);
    // The octahedral map's place of the direction.
    const V scale = hn::Div(
        set(1), hn::Max(hn::Add(hn::Abs(unit.x), hn::Add(hn::Abs(unit.y), hn::Abs(unit.z))), set(1e-20f)));
    const V px = hn::Mul(unit.x, scale), py = hn::Mul(unit.y, scale);
    const auto below = hn::Lt(unit.z, zero);
    const V u = hn::IfThenElse(below, hn::CopySign(hn::Sub(set(1), hn::Abs(py)), px), px);
    const V v = hn::IfThenElse(below, hn::CopySign(hn::Sub(set(1), hn::Abs(px)), py), py);
    const OcclusionVolume& volume = *caster.volume;
    const auto nodes = static_cast<float>(volume.far_size - 1);
    const V half = set(0.5f * nodes);
    const Place s = place(hn::MulAdd(u, half, half), nodes), t = place(hn::MulAdd(v, half, half), nodes);
    const auto size = static_cast<int>(volume.far_size);
    const VI node = hn::Add(s.low, hn::Mul(t.low, hn::Set(di, size)));
    const auto* const base = reinterpret_cast<const std::int32_t*>(volume.far.data());
    V radius = zero;
    V3 middle{zero, zero, zero};
    for (int corner = 0; corner < 4; ++corner) {
        const V weight = hn::Mul(corner & 1 ? s.rest : hn::Sub(set(1), s.rest),
                                 corner & 2 ? t.rest : hn::Sub(set(1), t.rest));
        const VI word = hn::GatherIndex(di, base + (corner & 1) + size * (corner >> 1), node);
        radius = hn::MulAdd(weight, byte_of<0>(word), radius);
        middle.x = hn::MulAdd(weight, byte_of<8>(word), middle.x);
        middle.y = hn::MulAdd(weight, byte_of<16>(word), middle.y);
        middle.z = hn::MulAdd(weight, byte_of<24>(word), middle.z);
    }
    radius = hn::Mul(radius, set(1.0f / 255));
    const auto to_ball = [&](V coordinate, V from) HWY_ATTR {
        return hn::Sub(hn::Mul(hn::Sub(coordinate, set(128)), set(1.0f / 127)), from);
    };
    const V3 way_unit{to_ball(middle.x, unit.x), to_ball(middle.y, unit.y), to_ball(middle.z, unit.z)};
    const V3 way = transformed(caster.to_world, way_unit);
    const V over = hn::Div(set(1), hn::Max(length(way), set(1e-20f)));
    const V square_unit = dot(way_unit, way_unit), square_radius = hn::Mul(radius, radius);
    const V stretch = hn::Mul(hn::Sqrt(square_unit), over);
    const V scaled =
        hn::Mul(hn::Mul(square_radius, set(caster.unit_volume)), hn::Mul(stretch, hn::Mul(stretch, stretch)));
    const V rest = hn::Max(hn::Sub(square_unit, square_radius), zero);
    return ball_occlusion(hn::Div(scaled, hn::Max(hn::Add(rest, scaled), set(1e-20f))),
                          hn::Mul(dot(n, way), over));
}

HWY_INLINE V most_occlusion(const VolumeCaster& caster, const V3& unit, const V3& n) {
    const V3 away = transformed(caster.to_world, unit);
    const V over = hn::Div(set(1), hn::Max(length(away), set(1e-20f)));
    const V sine = hn::Mul(set(caster.bounding_ball), over);
    const V most = ball_occlusion(hn::Min(hn::Mul(sine, sine), set(1)), hn::Neg(hn::Mul(dot(n, away), over)));
    return hn::IfThenElse(hn::Lt(sine, set(1)), most, set(1));
}

HWY_INLINE hn::Mask<D> is_behind(const VolumeCaster& caster, const V3& unit, const V3& n) {
    const glm::mat3& m = caster.to_world;
    const V3 plane{dot(m[0], n), dot(m[1], n), dot(m[2], n)};
    const V3 size{hn::Abs(plane.x), hn::Abs(plane.y), hn::Abs(plane.z)};
    const V highest =
        hn::Add(hn::Sub(dot(caster.box_centre, plane), dot(plane, unit)), dot(caster.box_half, size));
    return hn::Le(highest, hn::Zero(D()));
}

void volume_visibility(const VolumeCaster& caster, const VolumeBlock& receivers, float* visibility) {
    const D d;
    const V zero = hn::Zero(d), one = set(1);
    for (std::size_t i = 0; i < receivers.count; i += hn::Lanes(d)) {
        const V3 p = load(receivers.x + i, receivers.y + i, receivers.z + i);
        const V3 n = load(receivers.nx + i, receivers.ny + i, receivers.nz + i);
        const V3 step = transformed(caster.to_grid, n);
        const V off = hn::Div(set(kOffSurface), length(step));
        V3 at = moved(transformed(caster.to_grid, p), caster.grid_offset);
        at = {hn::MulAdd(step.x, off, at.x), hn::MulAdd(step.y, off, at.y), hn::MulAdd(step.z, off, at.z)};
        const auto margin = [&](V coordinate, float last)
                                HWY_ATTR { return hn::Min(coordinate, hn::Sub(set(last), coordinate)); };
        const V least = hn::Min(margin(at.x, caster.last.x),
                                hn::Min(margin(at.y, caster.last.y), margin(at.z, caster.last.z)));
        const V share = within(hn::Mul(set(caster.blend), least), one);
        const V3 unit = moved(transformed(caster.to_unit, p), caster.unit_offset);
        V near = zero, far = zero;
        if (!hn::AllTrue(d, hn::Eq(share, zero))) near = near_occlusion(caster, at, n);
        if (!hn::AllTrue(d, hn::Eq(share, one))) far = far_occlusion(caster, unit, n);
        // What a vector's other receivers ask for must not tell: each takes its own share alone.
        const V mixed = hn::IfThenElse(hn::Eq(share, one), near, hn::MulAdd(share, hn::Sub(near, far), far));
        const V hidden = hn::IfThenZeroElse(is_behind(caster, unit, n),
                                            within(hn::Min(mixed, most_occlusion(caster, unit, n)), one));
        hn::Store(hn::Sub(one, hidden), d, visibility + i);
    }
}

#else
void volume_visibility(const VolumeCaster& caster, const VolumeBlock& receivers, float* visibility) {
    volume_visibility_reference(caster, receivers, visibility);
}
#endif

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime {

HWY_EXPORT(volume_visibility);

VolumeKernel* volume_kernel(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(volume_visibility), targets, &volume_visibility_reference);
}

}  // namespace dfield::runtime
#endif
