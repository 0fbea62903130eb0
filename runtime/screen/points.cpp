// Sections 4.1 to 4.4 and the march of 3.2 for pixels side by side, each with the samples of its own place in
// the interleaved square. A point is seen or not, so that rounding would move a result by a sample's weight:
// columns, rows and heights are the reference's to the last bit, by the same operations in the same order and
// none fused.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "screen/points.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "rays/vector-inl.hpp"
#include "screen/points.hpp"
#include "screen/vector-inl.hpp"
#include "simd.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::screen::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET != HWY_SCALAR

using dfield::runtime::HWY_NAMESPACE::Packing;
using dfield::runtime::HWY_NAMESPACE::truncated;

// Sums of radiance and of weights for the lanes of a vector. Few of the surfaces that are looked up give
// light, less than a tenth in rooms, and each is a cache line of its own: they are listed, and dealt with
// many at a time.
class Light {
  public:
    // `quads`: those of a lattice from where indices count.
    explicit HWY_INLINE Light(const float* quads) : quads_(quads) {
        const F f;
        for (std::size_t i = 0; i < 4; ++i) hn::Store(hn::Zero(f), f, sums_ + i * kLanes);
    }
    // add_radiance() of the surfaces of some lanes at `point` from s, with its squared length < 1 and how far
    // it is in front of the tangent plane.
    HWY_INLINE void add(M lanes, const V3& point, V r2, V ahead, VI index) {
        const F f;
        const I i;
        const V one = set(1), fade = set(16);
        const Packing packed(lanes);
        const auto put = [&](V value, float* to) HWY_ATTR { hn::StoreU(packed(value), f, to + size_); };
        put(hn::Mul(fade, point.x), x_);
        put(hn::Mul(fade, point.y), y_);
        put(hn::Mul(fade, point.z), z_);
        put(hn::Mul(hn::NegMulAdd(r2, r2, one), hn::Min(hn::Mul(fade, ahead), one)), weight_);
        hn::StoreU(packed(index), i, place_ + size_);
        hn::StoreU(packed(hn::Iota(i, 0)), i, lane_ + size_);
        size_ += hn::CountTrue(f, lanes);
        if (size_ > kMost) add_listed();
    }
    HWY_INLINE void get(V& red, V& green, V& blue, V& weight) {
        add_listed();
        hn::LoadInterleaved4(F(), sums_, red, green, blue, weight);
    }

  private:
    static constexpr std::size_t kLanes = hn::MaxLanes(F()), kMost = 64;

    void add_listed() {
        const hn::CappedTag<float, 4> four;
        for (std::size_t i = 0; i < size_; ++i) {
            const float* const n = quads_ + 8 * std::ptrdiff_t{place_[i]};
            const float turned = -(n[0] * x_[i] + (n[1] * y_[i] + n[2] * z_[i]));
            const auto weight = hn::Set(four, weight_[i] * std::min(std::max(turned, 0.0f), 1.0f));
            float* const sum = sums_ + 4 * lane_[i];
            hn::Store(hn::MulAdd(weight, hn::LoadU(four, n + 4), hn::Load(four, sum)), four, sum);
        }
        size_ = 0;
    }

    const float* quads_;
    std::size_t size_ = 0;
    HWY_ALIGN float sums_[4 * kLanes];  // red, green, blue, weight of each lane
    float x_[kMost + kLanes], y_[kMost + kLanes], z_[kMost + kLanes], weight_[kMost + kLanes];
    std::int32_t place_[kMost + kLanes], lane_[kMost + kLanes];
};

// look_up() of points around some pixels, and v of them.
class Lookup {
  public:
    HWY_INLINE Lookup(const Frame& frame, const Lattice& lattice, const Pixels& pixels, std::int32_t column,
                      std::int32_t row)
        : lattice_(lattice), pixels_(pixels) {
        const F f;
        const V one = set(1), most = set(kMostPixels);
        per_x_ = hn::Min(hn::Div(one, pixels.pixel_x), most);
        per_y_ = hn::Neg(hn::Min(hn::Div(one, pixels.pixel_y), most));
        minus_pixel_y_ = hn::Neg(pixels.pixel_y);
        from_column_ = hn::Add(hn::Add(set(static_cast<float>(column)), hn::Iota(f, 0.0f)), set(1.5f));
        from_row_ = set(static_cast<float>(row) + 1.5f);
        last_column_ = set(static_cast<float>(lattice.width + 1));
        last_row_ = set(static_cast<float>(lattice.height + 1));
        stride_ = hn::Set(I(), static_cast<std::int32_t>(lattice.stride));
        origin_ = lattice.index(0, 0, -1, -1);
        per_radius_ = set(frame.per_radius);
    }
    HWY_INLINE V3 in_pixels(const V3& axis) const {
        return {hn::Mul(hn::Add(axis.x, hn::Mul(axis.z, pixels_.r_x)), per_x_),
                hn::Mul(hn::Add(axis.y, hn::Mul(axis.z, pixels_.r_y)), per_y_), axis.z};
    }
    // Which points the camera sees; their light, of lanes `where` that it does or does not see.
    template<bool kLight, bool kSeenToo>
    HWY_INLINE M seen(const V3& at, M where, Light& light) const {
        // A vector of a maximum and NaN is the second argument: 0.
        const V zero = set(0);
        const V column = hn::Min(hn::Max(hn::Add(at.x, from_column_), zero), last_column_);
        const V row = hn::Min(hn::Max(hn::Add(at.y, from_row_), zero), last_row_);
        const VI index = hn::Add(hn::Mul(truncated(row), stride_), truncated(column));
        const V rise = hn::Mul(hn::Sub(pixels_.depth, hn::GatherIndex(F(), lattice_.depth + origin_, index)),
                               per_radius_);
        const M open = hn::Gt(at.z, rise);
        if constexpr (kLight) {
            if constexpr (!kSeenToo) {
                where = hn::AndNot(open, where);
                if (hn::AllFalse(F(), where)) return open;
            }
            const V x = hn::Mul(at.x, pixels_.pixel_x), y = hn::Mul(at.y, minus_pixel_y_);
            const V along = hn::MulAdd(x, pixels_.r_x, hn::Mul(y, pixels_.r_y));
            const V r2 = hn::MulAdd(rise, hn::MulAdd(set(-2), along, hn::Mul(rise, pixels_.sight_2)),
                                    hn::MulAdd(x, x, hn::Mul(y, y)));
            const V ahead = hn::MulAdd(pixels_.facing, rise,
                                       hn::MulAdd(pixels_.normal.x, x, hn::Mul(pixels_.normal.y, y)));
            const M counts = hn::And(where, hn::And(hn::Lt(r2, set(1)), hn::Gt(ahead, set(0))));
            if (!hn::AllFalse(F(), counts))
                light.add(counts,
                          {hn::NegMulAdd(rise, pixels_.r_x, x), hn::NegMulAdd(rise, pixels_.r_y, y), rise},
                          r2, ahead, index);
        }
        return open;
    }

  private:
    const Lattice& lattice_;
    const Pixels& pixels_;
    V per_x_, per_y_, minus_pixel_y_, from_column_, from_row_, last_column_, last_row_, per_radius_;
    VI stride_;
    std::ptrdiff_t origin_;
};

// T and B of reference.cpp.
HWY_INLINE void tangents(const V3& n, V3& t, V3& b) {
    const V one = set(1);
    const V sign = hn::IfThenElse(hn::Lt(n.z, set(0)), set(-1), one);
    const V c = hn::Div(set(-1), hn::Add(sign, n.z)), d = hn::Mul(hn::Mul(n.x, n.y), c);
    t = {hn::Add(one, hn::Mul(hn::Mul(hn::Mul(sign, n.x), n.x), c)), hn::Mul(sign, d),
         hn::Mul(hn::Neg(sign), n.x)};
    b = {d, hn::Add(sign, hn::Mul(hn::Mul(n.y, n.y), c)), hn::Neg(n.y)};
}

template<bool kLight>
HWY_INLINE V march(const std::pmr::vector<PointSets::Step>& steps, const Lookup& lookup, const V3& end,
                   M going, Light& light) {
    const F f;
    V seen = set(0);
    for (const PointSets::Step& step : steps) {
        const V share = set(step.share);
        const V3 at{hn::Mul(share, end.x), hn::Mul(share, end.y), hn::Mul(share, end.z)};
        const M open = lookup.seen<kLight, false>(at, going, light);
        seen = hn::IfThenElse(hn::AndNot(open, going), set(step.value), seen);
        going = hn::And(going, open);
        if (hn::AllFalse(f, going)) return seen;
    }
    return hn::IfThenElse(going, set(1), seen);
}

template<bool kMarch, bool kLight>
void points_vector(const EstimateJob& job, const Lattice& lattice, std::int32_t column, std::int32_t row) {
    const F f;
    const Frame& frame = *job.frame;
    const V zero = set(0), one = set(1);
    const Pixels pixels(frame, lattice, lattice.index(0, 0, column, row), column, 1, row);
    const std::ptrdiff_t to = frame.layout.index(column, row);
    const auto plane = static_cast<std::ptrdiff_t>(frame.layout.size());
    if (job.slopes) {
        hn::StoreU(pixels.slope_x(frame.radius), f, job.slopes + to);
        hn::StoreU(pixels.slope_y(frame.radius), f, job.slopes + plane + to);
    }
    const M shaded = hn::Not(pixels.nothing);
    V visibility = one;
    Light light(kLight ? lattice.quads + 8 * lattice.index(0, 0, -1, -1) : nullptr);
    if (!hn::AllFalse(f, shaded)) {
        const PointSets& sets = *job.points;
        const std::uint32_t x = static_cast<std::uint32_t>(column) % sets.side();
        const Lookup lookup(frame, lattice, pixels, column, row);
        V3 t, b;
        tangents(pixels.normal, t, b);
        t = lookup.in_pixels(t);
        b = lookup.in_pixels(b);
        const V3 n = lookup.in_pixels(pixels.normal);
        V sum = zero;
        const float* values = sets.values(row) + x;
        const std::size_t width = sets.width();
        for (std::uint32_t k = 0; k < sets.count(); ++k, values += 4 * width) {
            const auto value = [&](std::size_t i) HWY_ATTR { return hn::LoadU(f, values + i * width); };
            const V3 around{value(0), value(1), value(2)};
            const V3 at{dot(around, {t.x, b.x, n.x}), dot(around, {t.y, b.y, n.y}),
                        dot(around, {t.z, b.z, n.z})};
            if constexpr (kMarch) {
                sum = hn::Add(sum, march<kLight>(job.points->steps(), lookup, at, shaded, light));
            } else {
                const M open = lookup.seen<kLight, true>(at, shaded, light);
                sum = hn::Add(sum, hn::IfThenElseZero(open, value(3)));
            }
        }
        const V divisor = hn::LoadU(f, sets.divisors(row) + x);
        const M defined = hn::And(shaded, hn::Gt(divisor, zero));
        visibility = hn::IfThenElse(defined, hn::Div(sum, divisor), one);
    }
    hn::StoreU(visibility, f, job.visibility + to);
    if constexpr (kLight) {
        const V darkness = set(kDarkness * static_cast<float>(job.points->count()));
        V red, green, blue, weight;
        light.get(red, green, blue, weight);
        hn::StoreU(red, f, job.light + to);
        hn::StoreU(green, f, job.light + plane + to);
        hn::StoreU(blue, f, job.light + 2 * plane + to);
        hn::StoreU(hn::IfThenElseZero(shaded, hn::Add(weight, darkness)), f, job.light + 3 * plane + to);
    }
}

void points(const EstimateJob& job, const Lattice& lattice, std::int32_t begin, std::int32_t end) {
    const bool march = job.settings->desc.estimator == DFIELD_ESTIMATOR_MARCH;
    const auto vector = march ? (job.indirect ? points_vector<true, true> : points_vector<true, false>)
                              : (job.indirect ? points_vector<false, true> : points_vector<false, false>);
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(F()));
    // A row's last vector reaches into the border on its right.
    for (std::int32_t row = begin; row < end; ++row)
        for (std::int32_t column = 0; column < lattice.width; column += lanes)
            vector(job, lattice, column, row);
}

#else
void points(const EstimateJob& job, const Lattice&, std::int32_t begin, std::int32_t end) {
    for (std::int32_t row = begin; row < end; ++row) estimate_reference(job, row);
}
#endif

}  // namespace dfield::runtime::screen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::screen {

HWY_EXPORT(points);

PointsFunction* points_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(points), targets, static_cast<PointsFunction*>(nullptr));
}

}  // namespace dfield::runtime::screen
#endif
