// What the kernels of screen space share: vectors of pixels of a row and what is known of them. Seen once a
// target.
#include <hwy/highway.h>

#include <cstdint>

#include "screen/estimate.hpp"
#include "screen/lattice.hpp"

#if defined(DFIELD_SCREEN_VECTOR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_SCREEN_VECTOR_INL
#undef DFIELD_SCREEN_VECTOR_INL
#else
#define DFIELD_SCREEN_VECTOR_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::screen::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET != HWY_SCALAR

using F = hn::CappedTag<float, Lattice::kBorder>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using V = hn::Vec<F>;
using VI = hn::Vec<I>;
using M = hn::Mask<F>;

struct V3 {
    V x, y, z;
};

HWY_INLINE V set(float value) {
    return hn::Set(F(), value);
}
// In the scalar code's order, for what must be the same to the last bit.
HWY_INLINE V dot(const V3& a, const V3& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

// at_x() of pixels `step` apart.
HWY_INLINE V places(const Camera& camera, std::int32_t column, std::int32_t step) {
    const V columns =
        hn::Add(set(static_cast<float>(column)), hn::Mul(hn::Iota(F(), 0.0f), set(static_cast<float>(step))));
    return hn::Add(set(camera.left), hn::Mul(columns, set(camera.step_x)));
}

// shaded_at() and reach_of() of such pixels, to the last bit: what samples are taken must not depend on it.
struct Pixels {
    V depth;
    M sky, nothing;       // nothing: sky too
    V r_x, r_y, sight_2;  // the ray of sight, its squared length
    V length, reach;      // its length; R in pixels of a row
    V pixel_x, pixel_y;   // in units of R
    V3 normal;
    V facing;  // normal . -(ray of sight)

    HWY_INLINE Pixels(const Frame& frame, const Lattice& lattice, std::ptrdiff_t at, std::int32_t column,
                      std::int32_t step, std::int32_t row) {
        const F f;
        const V one = set(1);
        depth = hn::LoadU(f, lattice.depth + at);
        sky = hn::Not(hn::Lt(depth, set(kSky)));
        r_x = places(frame.sight, column, step);
        r_y = set(frame.sight.at_y(row));
        sight_2 = hn::Add(hn::Mul(r_x, r_x), hn::Add(hn::Mul(r_y, r_y), one));
        const V scale = hn::Div(frame.camera.perspective ? depth : one, set(frame.radius));
        pixel_x = hn::Mul(set(frame.camera.step_x), scale);
        pixel_y = hn::Mul(set(frame.camera.step_y), scale);
        length = hn::Sqrt(sight_2);
        reach = hn::Div(length, pixel_x);
        nothing = hn::Or(sky, hn::Not(hn::Gt(hn::Max(reach, hn::Div(length, pixel_y)), set(0.5f))));
        const auto plane = static_cast<std::ptrdiff_t>(lattice.size());
        normal = {hn::LoadU(f, lattice.normals + at), hn::LoadU(f, lattice.normals + plane + at),
                  hn::LoadU(f, lattice.normals + 2 * plane + at)};
        facing = hn::Sub(normal.z, hn::Add(hn::Mul(normal.x, r_x), hn::Mul(normal.y, r_y)));
    }
    // slopes_of()
    HWY_INLINE V slope_x(float radius) const {
        return hn::IfThenElse(sky, set(0), hn::Mul(hn::Mul(normal.x, pixel_x), hn::Div(set(radius), facing)));
    }
    HWY_INLINE V slope_y(float radius) const {
        return hn::IfThenElse(sky, set(0),
                              hn::Neg(hn::Mul(hn::Mul(normal.y, pixel_y), hn::Div(set(radius), facing))));
    }
};

#endif
}  // namespace dfield::runtime::screen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
