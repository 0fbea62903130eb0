// Shadow test clipping of many points: a vector of them is carried to the clipping camera and finds its
// depths there.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/clip_points.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>
#include <cstring>

#include "simd.hpp"
#include "volume/clip_coverage.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_SSE4

// The arithmetic is clip_reference()'s, operation by operation.
void clip_points(const PlacedClip& clip, const ClipPoints& points, std::uint8_t* seen) {
    if (clip.mesh->exact()) return clip_reference(clip, points, seen);
    const hn::CappedTag<double, 8> f64;
    const hn::RebindToSigned<decltype(f64)> i64;
    const hn::RebindToUnsigned<decltype(f64)> u64;
    const hn::Rebind<std::uint32_t, decltype(f64)> u32;
    const hn::Rebind<float, decltype(f64)> f32;
    const std::size_t lanes = hn::Lanes(f64);
    const DepthMaps& maps = clip.mesh->maps();
    const auto set = [&](double value) HWY_ATTR { return hn::Set(f64, value); };
    // A pixel is a word: the front depth its lower half.
    static_assert(sizeof(DepthPixel) == sizeof(std::uint64_t) && std::endian::native == std::endian::little);
    const auto* const pixels = reinterpret_cast<const std::uint64_t*>(maps.pixels.data());
    const auto zero = hn::Zero(f64), width = set(maps.width), height = set(maps.height);
    const std::size_t whole = points.count / lanes * lanes;
    for (std::size_t i = 0; i < whole; i += lanes) {
        const auto x = hn::LoadU(f64, points.x + i), y = hn::LoadU(f64, points.y + i),
                   z = hn::LoadU(f64, points.z + i);
        const auto camera = [&](int axis) HWY_ATTR {
            const auto sum =
                hn::Add(hn::Mul(set(clip.column[0][axis]), x), hn::Mul(set(clip.column[1][axis]), y));
            return hn::Add(hn::Add(sum, hn::Mul(set(clip.column[2][axis]), z)), set(clip.origin[axis]));
        };
        const auto per_pixel = set(maps.per_pixel);
        const auto u = hn::Mul(hn::Sub(camera(0), set(maps.low.x)), per_pixel),
                   v = hn::Mul(hn::Sub(camera(1), set(maps.low.y)), per_pixel), depth = camera(2);
        const auto within =
            hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)), hn::And(hn::Lt(u, width), hn::Lt(v, height)));
        const auto pixel = hn::Add(hn::Mul(hn::Floor(v), width), hn::Floor(u));  // exact in double
        const auto pair = hn::GatherIndex(u64, pixels, hn::ConvertTo(i64, hn::IfThenElseZero(within, pixel)));
        const auto depth_of = [&](auto bits) HWY_ATTR {
            return hn::PromoteTo(f64, hn::BitCast(f32, hn::TruncateTo(u32, bits)));
        };
        const auto front = depth_of(pair), back = depth_of(hn::ShiftRight<32>(pair));
        const auto inside = hn::And(within, hn::And(hn::Gt(depth, front), hn::Lt(depth, back)));
        // A bit a lane becomes a byte a lane: each byte keeps its own bit, and its top bit says whether it
        // was set.
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(f64, inside, bits);
        std::uint64_t bytes = bits[0] * 0x0101010101010101u & 0x8040201008040201u, before = 0;
        bytes = (bytes + 0x7f7f7f7f7f7f7f7fu) >> 7 & 0x0101010101010101u;
        std::memcpy(&before, seen + i, lanes);
        before &= clip.probe ? bytes : ~bytes;
        std::memcpy(seen + i, &before, lanes);
    }
    clip_reference(clip, {points.x + whole, points.y + whole, points.z + whole, points.count - whole},
                   seen + whole);
}

#else
void clip_points(const PlacedClip& clip, const ClipPoints& points, std::uint8_t* seen) {
    clip_reference(clip, points, seen);
}
#endif

}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::volume {

HWY_EXPORT(clip_points);

ClipFunction* clip_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(clip_points), targets, &clip_reference);
}

void clip_reference(const PlacedClip& clip, const ClipPoints& points, std::uint8_t* seen) {
    for (std::size_t i = 0; i < points.count; ++i)
        if (clip.clips(clip.to_camera(points.x[i], points.y[i], points.z[i]))) seen[i] = 0;
}

}  // namespace dfield::runtime::volume
#endif
