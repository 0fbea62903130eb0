// Sections 4.1 to 4.4 and the march of 3.2 for pixels side by side, each with the samples of its own place in
// the interleaved square. A point is seen or not, so that rounding would move a result by a sample's weight:
// columns, rows and heights are the reference's to the last bit, by the same operations in the same order and
// none fused.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "screen/points.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "screen/points.hpp"
#include "screen/vector-inl.hpp"
#include "simd.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::screen::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET != HWY_SCALAR

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
        const F f;
        // A vector of a maximum and NaN is the second argument: 0.
        const V zero = set(0);
        const V column = hn::Min(hn::Max(hn::Add(at.x, from_column_), zero), last_column_);
        const V row = hn::Min(hn::Max(hn::Add(at.y, from_row_), zero), last_row_);
        const I i;
        const VI index = hn::Add(hn::Mul(hn::ConvertTo(i, row), stride_), hn::ConvertTo(i, column));
        const auto fetch = [&](const float* plane)
                               HWY_ATTR { return hn::GatherIndex(f, plane + origin_, index); };
        const V rise = hn::Mul(hn::Sub(pixels_.depth, fetch(lattice_.depth)), per_radius_);
        const M open = hn::Gt(at.z, rise);
        if constexpr (kLight) {
            const V x = hn::Mul(at.x, pixels_.pixel_x), y = hn::Neg(hn::Mul(at.y, pixels_.pixel_y));
            const V3 point{hn::Sub(x, hn::Mul(rise, pixels_.r_x)), hn::Sub(y, hn::Mul(rise, pixels_.r_y)),
                           rise};
            if constexpr (!kSeenToo) where = hn::AndNot(open, where);
            const V ahead = hn::IfThenElseZero(where, dot(pixels_.normal, point));
            add_light(lattice_, point, dot(point, point), ahead, fetch, light);
        }
        return open;
    }

  private:
    const Lattice& lattice_;
    const Pixels& pixels_;
    V per_x_, per_y_, from_column_, from_row_, last_column_, last_row_, per_radius_;
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
    Light light;
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
        for (std::uint32_t k = 0; k < sets.count(); ++k) {
            const auto value = [&](std::uint32_t i) HWY_ATTR { return hn::LoadU(f, sets.at(row, k, i) + x); };
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
        hn::StoreU(light.red, f, job.light + to);
        hn::StoreU(light.green, f, job.light + plane + to);
        hn::StoreU(light.blue, f, job.light + 2 * plane + to);
        hn::StoreU(hn::IfThenElseZero(shaded, hn::Add(light.weight, darkness)), f,
                   job.light + 3 * plane + to);
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
