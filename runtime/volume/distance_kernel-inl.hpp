// One diagonal sweep of a group of rows through kSlices slices: equation 1, and with it equations 6 and 7
// where a field of visibility is carried along. Included once a target.
#if defined(DFIELD_VOLUME_DISTANCE_KERNEL_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_VOLUME_DISTANCE_KERNEL_INL_HPP
#undef DFIELD_VOLUME_DISTANCE_KERNEL_INL_HPP
#else
#define DFIELD_VOLUME_DISTANCE_KERNEL_INL_HPP
#endif

#include <hwy/highway.h>

#include "volume/layout-inl.hpp"
#include "volume/sweep.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

// Equation 1 with h = 1. With a_1 <= a_2 <= a_3 relative to a_1 (0, u, v): s_2 <= a_3 exactly where
// v^2 + (v - u)^2 >= 1, and u cut off at 1 turns s_2 into s_1, so that one root serves all three cases.
struct UnitEikonal {
    explicit HWY_INLINE UnitEikonal(const Grid&) {}
    HWY_INLINE VF operator()(VF ax, VF ay, VF az) const {
        const F f;
        const VF one = hn::Set(f, 1.0f);
        const VF low = hn::Min(ax, ay), high = hn::Max(ax, ay), middle = hn::Max(low, az);
        const VF a1 = hn::Min(low, az), a2 = hn::Min(high, middle), a3 = hn::Max(high, middle);
        const VF u = hn::Min(hn::Sub(a2, a1), one), v = hn::Sub(a3, a1), w = hn::Sub(v, u);
        const VF q = hn::MulAdd(w, w, hn::Mul(v, v));
        const auto three = hn::Lt(q, one);
        // 2 - u^2, or 3 - u^2 - v^2 - (v - u)^2
        const VF root = hn::Sqrt(hn::Sub(hn::NegMulAdd(u, u, hn::Set(f, 3.0f)), hn::Min(q, one)));
        const VF sum = hn::Add(hn::Add(root, u), hn::IfThenElseZero(three, v));
        return hn::MulAdd(sum, hn::IfThenElse(three, hn::Set(f, 1.0f / 3), hn::Set(f, 0.5f)), a1);
    }
};

// The same for spacings that differ: the root of sum ((s - a_i) / h_i)^2 = 1 over the one, two or three
// smallest.
struct Eikonal {
    explicit HWY_INLINE Eikonal(const Grid& g)
        : hx(hn::Set(F(), g.hx / g.h())), hy(hn::Set(F(), g.hy / g.h())), hz(hn::Set(F(), g.hz / g.h())) {}
    HWY_INLINE VF operator()(VF ax, VF ay, VF az) const {
        const F f;
        const VF one = hn::Set(f, 1.0f);
        VF a1 = ax, a2 = ay, a3 = az, h1 = hx, h2 = hy, h3 = hz;
        order(a1, a2, h1, h2);
        order(a1, a3, h1, h3);
        order(a2, a3, h2, h3);
        const VF w1 = inverse_square(h1), u = hn::Sub(a2, a1), v = hn::Sub(a3, a1), w = hn::Sub(a3, a2);
        VF w2 = inverse_square(h2), w3 = inverse_square(h3);
        const auto two = hn::Lt(hn::Mul(hn::Mul(u, u), w1), one);
        const auto three =
            hn::And(two, hn::Lt(hn::MulAdd(hn::Mul(v, v), w1, hn::Mul(hn::Mul(w, w), w2)), one));
        w2 = hn::IfThenElseZero(two, w2);
        w3 = hn::IfThenElseZero(three, w3);
        // Vertices that are not used may be kFar away: their squares must not become infinite.
        const VF u_used = hn::IfThenElseZero(two, u), v_used = hn::IfThenElseZero(three, v);
        const VF sum = hn::Add(w1, hn::Add(w2, w3));
        const VF b = hn::MulAdd(w2, u_used, hn::Mul(w3, v_used));
        const VF c = hn::MulAdd(hn::Mul(w2, u_used), u_used, hn::Mul(hn::Mul(w3, v_used), v_used));
        const VF square = hn::NegMulAdd(sum, hn::Sub(c, one), hn::Mul(b, b));
        return hn::Add(a1, hn::Div(hn::Add(b, hn::Sqrt(hn::Max(square, hn::Zero(f)))), sum));
    }

  private:
    static HWY_INLINE VF inverse_square(VF h) { return hn::Div(hn::Set(F(), 1.0f), hn::Mul(h, h)); }
    static HWY_INLINE void order(VF& a, VF& b, VF& ha, VF& hb) {
        const auto swap = hn::Lt(b, a);
        const VF low = hn::Min(a, b), h = hn::IfThenElse(swap, hb, ha);
        b = hn::Max(a, b);
        hb = hn::IfThenElse(swap, ha, hb);
        a = low;
        ha = h;
    }
    VF hx, hy, hz;
};

// What a group's sweep reads and writes. Pointers are to vector 0, except where said.
struct GroupSweep {
    std::ptrdiff_t vectors = 0;       // of the group
    bool ascending = true;            // in t, that is in x
    float* distance = nullptr;        // of slice 0
    std::ptrdiff_t slice_stride = 0;  // floats
    float* below = nullptr;           // the last slice of the slab before: read, then replaced by this slab's
    float* border = nullptr;          // x = 0 of slice 0: the last row of the group before, likewise
    std::ptrdiff_t border_stride = 0;

    // Visibility; all as above.
    const float* tau = nullptr;  // transmittance / 3
    float* light_below = nullptr;
    float* light_border = nullptr;
    std::uint8_t* visibility = nullptr;  // kOctants: a byte a voxel
    float* sum = nullptr;                // kCombined: intensity * V is added
    float intensity = 1;
    std::size_t nx = 0, rows = 0;  // rows of the group that exist
    bool falling = true;           // the layout
};

// kUpward: rows in ascending order, lane l follows lane l - 1.
template<bool kUpward, Carried kCarried, class Solver>
HWY_INLINE void sweep_group(const GroupSweep& s, const Solver& solver) {
    constexpr std::ptrdiff_t kN = kLanes, kS = kSlices;
    constexpr bool kLight = kCarried != Carried::kNone;
    const F f;
    const hn::RebindToSigned<F> i32;
    using VI = hn::Vec<decltype(i32)>;
    const VI iota = hn::Iota(i32, 0);
    // The rotation by a lane; the lane that comes from another group is filled in.
    const auto turn = hn::IndicesFromVec(
        f, hn::And(hn::Add(iota, hn::Set(i32, kUpward ? kN - 1 : 1)), hn::Set(i32, kN - 1)));
    const auto entering = hn::RebindMask(f, hn::Eq(iota, hn::Set(i32, kUpward ? 0 : kN - 1)));
    const std::ptrdiff_t direction = s.ascending ? 1 : -1;
    const std::ptrdiff_t start = s.ascending ? 0 : s.vectors - 1;
    // Of the rows that enter and leave: x = t - offset.
    const std::ptrdiff_t enters = s.ascending ? 0 : kN - 1, leaves = kN - 1 - enters;
    const VI offsets = s.falling ? iota : hn::Sub(hn::Set(i32, kN - 1), iota);
    const auto row_exists = hn::Lt(iota, hn::Set(i32, static_cast<std::int32_t>(s.rows)));
    const VI nx = hn::Set(i32, static_cast<std::int32_t>(s.nx)), minus_one = hn::Set(i32, -1);
    const VF scale = hn::Set(f, kCarried == Carried::kOctants ? 255.0f / 3 : s.intensity / 3);
    const VF one = hn::Set(f, 1.0f);

    VF d[kSlices], light[kSlices];
    for (std::size_t p = 0; p < kSlices; ++p) {
        d[p] = hn::Set(f, kFar);
        light[p] = one;
    }
    const auto step = [&](std::ptrdiff_t i, auto is_edge) HWY_ATTR {
        constexpr bool kEdge = decltype(is_edge)::value;
#pragma GCC unroll 4
        for (std::ptrdiff_t p = kS - 1; p >= 0; --p) {
            const std::ptrdiff_t t = start + direction * (i - p);
            float* const border = s.border + p * s.border_stride;
            const VF turned = hn::TableLookupLanes(d[p], turn);
            border[t - direction - leaves] = hn::GetLane(kUpward ? turned : d[p]);
            const VF ay = hn::IfThenElse(entering, hn::Set(f, border[t - enters]), turned);
            const VF az = p > 0 ? d[p > 0 ? p - 1 : 0] : hn::Load(f, s.below + t * kN);
            float* const at = s.distance + p * s.slice_stride + t * kN;
            // Frozen vertices are negative, and stay what they are.
            const VF result = hn::Min(hn::Load(f, at), solver(d[p], ay, az));
            hn::Store(result, f, at);
            d[p] = hn::Abs(result);
            if (p == kS - 1) hn::Store(d[p], f, s.below + t * kN);

            if constexpr (kLight) {
                float* const edge = s.light_border + p * s.border_stride;
                const VF turned_light = hn::TableLookupLanes(light[p], turn);
                edge[t - direction - leaves] = hn::GetLane(kUpward ? turned_light : light[p]);
                const VF ly = hn::IfThenElse(entering, hn::Set(f, edge[t - enters]), turned_light);
                const VF lz = p > 0 ? light[p > 0 ? p - 1 : 0] : hn::Load(f, s.light_below + t * kN);
                const VF sum = hn::Add(hn::Add(light[p], ly), lz);  // equation 6 but for the third
                const std::ptrdiff_t voxel = p * s.slice_stride + t * kN;
                light[p] = hn::Mul(sum, hn::Load(f, s.tau + voxel));
                if constexpr (kEdge) {  // V = 1 outside the grid
                    const VI x = hn::Sub(hn::Set(i32, static_cast<std::int32_t>(t)), offsets);
                    const auto exists = hn::And(hn::And(hn::Gt(x, minus_one), hn::Lt(x, nx)), row_exists);
                    light[p] = hn::IfThenElse(hn::RebindMask(f, exists), light[p], one);
                }
                if (p == kS - 1) hn::Store(light[p], f, s.light_below + t * kN);
                if constexpr (kCarried == Carried::kOctants) {
                    const hn::Rebind<std::uint8_t, F> u8;
                    hn::StoreU(hn::DemoteTo(u8, hn::NearestInt(hn::Mul(sum, scale))), u8,
                               s.visibility + voxel);
                } else {
                    float* const total = s.sum + voxel;
                    hn::Store(hn::MulAdd(sum, scale, hn::Load(f, total)), f, total);
                }
            }
        }
    };
    const std::ptrdiff_t end = s.vectors + kS;  // one more step than slices lag: the last border is stored
    if constexpr (!kLight) {
        for (std::ptrdiff_t i = 0; i < end; ++i) step(i, std::false_type());
    } else {
        // All lanes of all slices lie within the grid from vector kN - 1 to nx - 1.
        const std::ptrdiff_t width = static_cast<std::ptrdiff_t>(s.nx);
        const bool whole = s.rows == kLanes && width > kN + kS;
        const std::ptrdiff_t first = whole ? kN - 1 + kS - 1 : end, last = whole ? width : end;
        for (std::ptrdiff_t i = 0; i < first; ++i) step(i, std::true_type());
        for (std::ptrdiff_t i = first; i < last; ++i) step(i, std::false_type());
        for (std::ptrdiff_t i = last; i < end; ++i) step(i, std::true_type());
    }
}

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
