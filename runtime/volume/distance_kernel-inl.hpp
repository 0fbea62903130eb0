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
#include "volume/octant_words-inl.hpp"
#include "volume/row_order-inl.hpp"
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

    // (1 - V tau) / 3; all as above.
    float alpha = 1;  // equation 8
    float* dark_below = nullptr;
    float* dark_border = nullptr;
    // kOctants: a word a vertex of slice 0. Byte p belongs to slice p, which lags: to its vertex p vectors
    // before.
    std::uint32_t* visibility = nullptr;
    float* sum = nullptr;  // kCombined: intensity * V is added
    float intensity = 1;
};

// Equations 7 and 8 of a vertex's distance as sweeps have it, times a weight: 1 - (1 - tau) alpha with
// tau = D / h + shift within [0, 1].
struct Transmittance {
    VF slope, at_zero, darkest, brightest;
    HWY_INLINE Transmittance(float alpha, float shift, float weight)
        : slope(hn::Set(F(), weight * alpha)),
          at_zero(hn::Set(F(), weight * (1 - (1 - shift) * alpha))),
          darkest(hn::Set(F(), weight * (1 - alpha))),
          brightest(hn::Set(F(), weight)) {}
    HWY_INLINE VF operator()(VF distance) const {
        const VF sign = hn::BitCast(F(), hn::ShiftLeft<31>(hn::BitCast(I32(), distance)));
        const VF tau = hn::MulAdd(hn::Xor(distance, sign), slope, at_zero);
        return hn::Min(hn::Max(tau, darkest), brightest);
    }
};

// kUpward: rows in ascending order.
template<bool kUpward, Carried kCarried, class Solver>
class GroupKernel {
  public:
    HWY_INLINE GroupKernel(const GroupSweep& sweep, const Solver& solver)
        : s_(sweep),
          solver_(solver),
          order_(),
          direction_(sweep.ascending ? 1 : -1),
          start_(sweep.ascending ? 0 : sweep.vectors - 1),
          enters_(sweep.ascending ? 0 : kN - 1),
          leaves_(kN - 1 - enters_ + direction_),
          tau_(sweep.alpha, 0.5f, 1.0f / 3),
          scale_(hn::Set(F(), kCarried == Carried::kOctants ? 255.0f : sweep.intensity)),
          inside_bit_(hn::BitCast(F(), hn::Set(I32(), kInsideBit))) {
        for (std::size_t p = 0; p < kSlices; ++p) {
            d_[p] = hn::Set(F(), kFar);
            dark_[p] = hn::Zero(F());
        }
    }

    HWY_INLINE void run() {
        const std::ptrdiff_t end =
            s_.vectors + kS;  // one more step than slices lag: the last border is stored
        for (std::ptrdiff_t i = 0; i < end; ++i) step(i);
    }

  private:
    static constexpr std::ptrdiff_t kN = kLanes, kS = kSlices;

    // Vector i of the first slice, i - 1 of the second, ...
    HWY_INLINE void step(std::ptrdiff_t i) {
#pragma GCC unroll 4
        for (std::ptrdiff_t p = kS - 1; p >= 0; --p) {
            const std::ptrdiff_t t = start_ + direction_ * (i - p), voxel = p * s_.slice_stride + t * kN;
            const std::ptrdiff_t border = p * s_.border_stride + t;
            const F f;
            float* const at = s_.distance + voxel;
            const VF ay =
                order_.previous_row(d_[p], s_.border + border - leaves_, s_.border + border - enters_);
            const VF az = p > 0 ? d_[p > 0 ? p - 1 : 0] : hn::Load(f, s_.below + t * kN);
            // Frozen vertices are negative, and stay what they are.
            const VF before = hn::Load(f, at);
            const VF result = hn::Min(before, select_bits(inside_bit_, before, solver_(d_[p], ay, az)));
            hn::Store(result, f, at);
            d_[p] = hn::Abs(result);
            if (p == kS - 1) hn::Store(d_[p], f, s_.below + t * kN);
            if constexpr (kCarried != Carried::kNone) carry(p, t, voxel, border);
        }
    }

    // Equation 6 for 1 - V, which is 0 outside the grid: what vertices there are given, and pass on, without
    // a mask.
    HWY_INLINE void carry(std::ptrdiff_t p, std::ptrdiff_t t, std::ptrdiff_t voxel, std::ptrdiff_t border) {
        const F f;
        const VF y = order_.previous_row(dark_[p], s_.dark_border + border - leaves_,
                                         s_.dark_border + border - enters_);
        const VF z = p > 0 ? dark_[p > 0 ? p - 1 : 0] : hn::Load(f, s_.dark_below + t * kN);
        const VF v = hn::Sub(hn::Sub(hn::Sub(hn::Set(f, 1.0f), dark_[p]), y), z);
        dark_[p] = hn::NegMulAdd(v, tau_(d_[p]), hn::Set(f, 1.0f / 3));
        if (p == kS - 1) hn::Store(dark_[p], f, s_.dark_below + t * kN);
        if constexpr (kCarried == Carried::kOctants) {
            bytes_.push(v, scale_);
            if (p == 0) hn::Store(bytes_.word, U32(), s_.visibility + t * kN);
        } else {
            float* const total = s_.sum + voxel;
            hn::Store(hn::MulAdd(v, scale_, hn::Load(f, total)), f, total);
        }
    }

    const GroupSweep s_;
    const Solver solver_;
    const RowOrder<kUpward> order_;
    const std::ptrdiff_t direction_, start_;
    // Of the rows that enter and leave: x = t less this.
    const std::ptrdiff_t enters_, leaves_;
    const Transmittance tau_;
    const VF scale_, inside_bit_;
    VF d_[kSlices], dark_[kSlices];
    SliceBytes bytes_;
};

template<bool kUpward, Carried kCarried, class Solver>
void sweep_group(const GroupSweep& sweep, const Solver& solver) {
    GroupKernel<kUpward, kCarried, Solver>(sweep, solver).run();
}

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
