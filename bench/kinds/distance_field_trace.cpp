// Sphere tracing (Hart, "Sphere Tracing", The Visual Computer 12, 1996), a vector of rays at a time: rays
// that miss the grid's box are dropped before the first step, and after every step the rays still on their
// way are moved together.
#include <algorithm>
#include <vector>

#include "bench/kinds/distance_field.hpp"
#include "format/frame.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/kinds/distance_field_trace.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace dfield::kinds::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;

// Rays that are still on their way, in node coordinates: origin + t * (dx, dy, dz), until `end`.
struct Rays {
    std::vector<float> dx, dy, dz, t, end;
    explicit Rays(std::size_t count) : dx(count), dy(count), dz(count), t(count), end(count) {}

    std::size_t keep(V kept_dx, V kept_dy, V kept_dz, V kept_t, V kept_end, hn::Mask<D> mask,
                     std::size_t at) {
        const D d;
        hn::CompressStore(kept_dx, mask, d, &dx[at]);
        hn::CompressStore(kept_dy, mask, d, &dy[at]);
        hn::CompressStore(kept_dz, mask, d, &dz[at]);
        hn::CompressStore(kept_t, mask, d, &t[at]);
        return at + hn::CompressStore(kept_end, mask, d, &end[at]);
    }
};

// Trilinear distance. A gather of 32 bits brings two neighbours along x, so that four make the eight nodes of
// a cell.
HWY_INLINE V sample(const DistanceField::View& field, V x, V y, V z) {
    const D d;
    const hn::RebindToSigned<D> di;
    const V highest = hn::Set(d, static_cast<float>(field.size) - 1.001f), zero = hn::Zero(d);
    x = hn::Min(hn::Max(x, zero), highest);
    y = hn::Min(hn::Max(y, zero), highest);
    z = hn::Min(hn::Max(z, zero), highest);
    const auto ix = hn::ConvertTo(di, x), iy = hn::ConvertTo(di, y), iz = hn::ConvertTo(di, z);
    const V fx = hn::Sub(x, hn::ConvertTo(d, ix)), fy = hn::Sub(y, hn::ConvertTo(d, iy)),
            fz = hn::Sub(z, hn::ConvertTo(d, iz));
    const auto row = hn::Set(di, field.size), slice = hn::Set(di, field.size * field.size);
    const auto offset = hn::Add(ix, hn::Add(hn::Mul(iy, row), hn::Mul(iz, slice)));
    const auto low = hn::Set(di, 0xff);
    const auto* base = reinterpret_cast<const std::int32_t*>(field.nodes);
    const auto along_x = [&](auto at) HWY_ATTR {
        const auto pair = hn::GatherOffset(di, base, at);
        const V a = hn::ConvertTo(d, hn::And(pair, low));
        const V b = hn::ConvertTo(d, hn::And(hn::ShiftRight<8>(pair), low));
        return hn::MulAdd(fx, hn::Sub(b, a), a);
    };
    const auto along_y = [&](auto at) HWY_ATTR {
        const V a = along_x(at), b = along_x(hn::Add(at, row));
        return hn::MulAdd(fy, hn::Sub(b, a), a);
    };
    const V a = along_y(offset), b = along_y(hn::Add(offset, slice));
    return hn::MulAdd(hn::MulAdd(fz, hn::Sub(b, a), a), hn::Set(d, field.distance_scale),
                      hn::Set(d, field.distance_offset));
}

// The part of o + t d, t >= 0, between the planes 0 and `highest`, taken together with [enter, leave].
HWY_INLINE void clip(V o, V direction, V highest, V& enter, V& leave) {
    const D d;
    const V tiny = hn::Set(d, 1e-20f);  // instead of 0, whose reciprocal makes NaNs of planes that it lies in
    const V inverse = hn::Div(hn::Set(d, 1), hn::IfThenElse(hn::Eq(direction, hn::Zero(d)), tiny, direction));
    const V a = hn::Mul(hn::Neg(o), inverse), b = hn::Mul(hn::Sub(highest, o), inverse);
    enter = hn::Max(enter, hn::Min(a, b));
    leave = hn::Min(leave, hn::Max(a, b));
}

std::size_t trace(const DistanceField::View& field, const glm::vec3& origin, Rays& rays, std::size_t count) {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    const V ox = hn::Set(d, origin.x), oy = hn::Set(d, origin.y), oz = hn::Set(d, origin.z);
    const V surface = hn::Set(d, field.surface), least_step = hn::Set(d, field.least_step);
    std::size_t hits = 0;
    while (count > 0) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; i += lanes) {
            const auto valid = hn::FirstN(d, count - i);
            const V dx = hn::LoadU(d, &rays.dx[i]), dy = hn::LoadU(d, &rays.dy[i]),
                    dz = hn::LoadU(d, &rays.dz[i]), t = hn::LoadU(d, &rays.t[i]),
                    end = hn::LoadU(d, &rays.end[i]);
            const V distance =
                sample(field, hn::MulAdd(t, dx, ox), hn::MulAdd(t, dy, oy), hn::MulAdd(t, dz, oz));
            const auto hit = hn::And(valid, hn::Le(distance, surface));
            hits += hn::CountTrue(d, hit);
            const V next = hn::Add(t, hn::Max(distance, least_step));
            const auto alive = hn::AndNot(hit, hn::And(valid, hn::Lt(next, end)));
            kept = rays.keep(dx, dy, dz, next, end, alive, kept);
        }
        count = kept;
    }
    return hits;
}

// Directions as three arrays, padded with copies of the last to whole vectors.
void visibility(const DistanceField::View& field, const paper::Receivers& receivers, const float* xs,
                const float* ys, const float* zs, std::size_t count, float* result) {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    const V highest = hn::Set(d, static_cast<float>(field.size - 1));
    Rays rays(count + 2 * lanes);
    for (std::size_t r = 0; r < receivers.size(); ++r) {
        const glm::vec3 origin = (receivers.positions[r] - field.origin) * field.to_nodes;
        const Frame frame = frame_of_normal(receivers.normals[r]);
        const glm::vec3 tangent = frame.tangent * field.to_nodes,
                        bitangent = frame.bitangent * field.to_nodes, normal = frame.normal * field.to_nodes;
        const V ox = hn::Set(d, origin.x), oy = hn::Set(d, origin.y), oz = hn::Set(d, origin.z);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; i += lanes) {
            const V x = hn::LoadU(d, xs + i), y = hn::LoadU(d, ys + i), z = hn::LoadU(d, zs + i);
            const auto turned = [&](int axis) HWY_ATTR {
                return hn::MulAdd(
                    x, hn::Set(d, tangent[axis]),
                    hn::MulAdd(y, hn::Set(d, bitangent[axis]), hn::Mul(z, hn::Set(d, normal[axis]))));
            };
            const V dx = turned(0), dy = turned(1), dz = turned(2);
            V enter = hn::Zero(d), leave = hn::Set(d, 1e30f);
            clip(ox, dx, highest, enter, leave);
            clip(oy, dy, highest, enter, leave);
            clip(oz, dz, highest, enter, leave);
            const auto meets = hn::And(hn::FirstN(d, count - i), hn::Lt(enter, leave));
            kept = rays.keep(dx, dy, dz, enter, leave, meets, kept);
        }
        const std::size_t hits = trace(field, origin, rays, kept);
        result[r] = 1 - static_cast<float>(hits) / static_cast<float>(count);
    }
}

}  // namespace dfield::kinds::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::kinds {

HWY_EXPORT(visibility);

std::vector<float> DistanceField::visibility(const paper::Receivers& receivers,
                                             std::span<const glm::vec3> directions) const {
    constexpr std::size_t kWidest = 64;  // lanes of any target
    std::vector<float> axes[3];
    for (int axis = 0; axis < 3; ++axis) {
        for (const glm::vec3& direction : directions) axes[axis].push_back(direction[axis]);
        axes[axis].resize(directions.size() + kWidest, axes[axis].back());
    }
    std::vector<float> result(receivers.size());
    HWY_DYNAMIC_DISPATCH(visibility)
    (view(), receivers, axes[0].data(), axes[1].data(), axes[2].data(), directions.size(), result.data());
    return result;
}

}  // namespace dfield::kinds
#endif
