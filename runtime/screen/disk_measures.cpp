// The base disk with the other measures, as pipe.cpp has them.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "screen/disk_measures.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After them.
#include <hwy/contrib/math/math-inl.h>

#include "screen/disk-inl.hpp"
#include "screen/pipe.hpp"
#include "simd.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::screen::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET != HWY_SCALAR

// A pipe: its points lie at r = sqrt(rho^2 + t^2) and (o - s).N = a + b t.
struct Pipes {
    V rho2, a, b;
};

// h by an integral of Integral(settings), between two t.
template<class Integral>
struct Other {
    HWY_INLINE Other(const Settings& settings, const Lanes& p) : integral(settings) {
        per_length = hn::Div(set(1), p.length);
        own = hn::Mul(hn::Mul(p.pixel_x, p.pixel_y), set(own_rho2(1, 1)));
        pixel2 = hn::Mul(p.pixel_x, p.pixel_x);
        b = hn::Mul(p.facing, per_length);
    }
    HWY_INLINE void integrals(const Lanes& p, const Offsets::Offset& o, V g, V e, V low, V ground, V high,
                              V& open, V& seen) const {
        const V along = hn::Mul(g, per_length);
        const V rho2 = hn::NegMulAdd(along, along, hn::Mul(set(o.distance2), pixel2));
        const Pipes pipes{hn::Max(rho2, own), hn::MulAdd(g, p.slope, e), b};
        const auto t = [&](V z) HWY_ATTR { return hn::Mul(hn::Sub(z, g), per_length); };
        integral(pipes, t(low), t(ground), t(high), open, seen);
    }
    static HWY_INLINE V scale(const Lanes& p) { return hn::Div(set(1), p.length); }

    Integral integral;
    V per_length, own, pixel2, b;
};

// a t / (rho^2 r) - b / r
struct Linear {
    explicit HWY_INLINE Linear(const Settings&) {}
    HWY_INLINE void operator()(const Pipes& p, V low, V ground, V high, V& open, V& seen) const {
        const V a = hn::Div(p.a, p.rho2);
        const auto at = [&](V t) HWY_ATTR {
            return hn::Div(hn::MulSub(a, t, p.b), hn::Sqrt(hn::MulAdd(t, t, p.rho2)));
        };
        const V end = at(high);
        open = hn::Sub(end, at(low));
        seen = hn::Sub(end, at(ground));
    }
};

// 2 a / rho atan(t / rho) + b ln r^2
struct Quadratic {
    explicit HWY_INLINE Quadratic(const Settings&) {}
    HWY_INLINE void operator()(const Pipes& p, V low, V ground, V high, V& open, V& seen) const {
        const F f;
        const V per_rho = hn::Div(set(1), hn::Sqrt(p.rho2)), a = hn::Mul(hn::Add(p.a, p.a), per_rho);
        const auto at = [&](V t) HWY_ATTR {
            return hn::MulAdd(a, hn::Atan(f, hn::Mul(t, per_rho)),
                              hn::Mul(p.b, hn::Log(f, hn::MulAdd(t, t, p.rho2))));
        };
        const V end = at(high);
        open = hn::Sub(end, at(low));
        seen = hn::Sub(end, at(ground));
    }
};

// pipe.cpp's eight points in theta, t = rho tan(theta).
struct Exponential {
    explicit HWY_INLINE Exponential(const Settings& settings)
        : sigma(set(settings.measure.sigma)),
          factor(set(-settings.measure.sigma / std::expm1(-settings.measure.sigma))) {}
    HWY_INLINE void operator()(const Pipes& p, V low, V ground, V high, V& open, V& seen) const {
        const F f;
        const V rho = hn::Sqrt(p.rho2), per_rho = hn::Div(set(1), rho);
        const auto theta = [&](V t) HWY_ATTR { return hn::Atan(f, hn::Mul(t, per_rho)); };
        const V end = theta(high), scale = hn::Mul(factor, hn::Mul(per_rho, per_rho));
        const V extinction = hn::Neg(hn::Mul(sigma, rho)), b = hn::Mul(p.b, rho);
        const auto between = [&](V from) HWY_ATTR {
            const V middle = hn::Mul(hn::Add(from, end), set(0.5f)),
                    half = hn::Mul(hn::Sub(end, from), set(0.5f));
            V sine, cosine, sum = set(0);
            turn(middle, sine, cosine);
            const auto add = [&](float weight, V s, V c) HWY_ATTR {
                const V at = hn::Exp(f, hn::Div(extinction, c));
                sum = hn::MulAdd(hn::Mul(set(weight), at), hn::MulAdd(p.a, c, hn::Mul(b, s)), sum);
            };
            for (int i = 0; i < 4; ++i) {
                V s, c;
                turn(hn::Mul(set(kGaussNodes[i]), half), s, c);
                const V cc = hn::Mul(cosine, c), ss = hn::Mul(sine, s), sc = hn::Mul(sine, c),
                        cs = hn::Mul(cosine, s);
                add(kGaussWeights[i], hn::Sub(sc, cs), hn::Add(cc, ss));
                add(kGaussWeights[i], hn::Add(sc, cs), hn::Sub(cc, ss));
            }
            return hn::Mul(hn::Mul(scale, half), sum);
        };
        open = between(theta(low));
        seen = between(theta(ground));
    }

  private:
    // Between -pi/2 and pi/2; Taylor's series end below 5e-7.
    static HWY_INLINE void turn(V x, V& sine, V& cosine) {
        const V y = hn::Mul(x, x);
        V s = set(-1.0f / 39916800), c = set(-1.0f / 3628800);
        for (const float next : {1.0f / 362880, -1.0f / 5040, 1.0f / 120, -1.0f / 6, 1.0f})
            s = hn::MulAdd(s, y, set(next));
        for (const float next : {1.0f / 40320, -1.0f / 720, 1.0f / 24, -1.0f / 2, 1.0f})
            c = hn::MulAdd(c, y, set(next));
        sine = hn::Mul(s, x);
        cosine = c;
    }

    V sigma, factor;
};

void disk_measures(const EstimateJob& job, const Lattice& lattice, std::int32_t begin, std::int32_t end) {
    switch (job.settings->measure.kind) {
        case DFIELD_MEASURE_LINEAR:
            return disk_rows<Other<Linear>>(job, lattice, begin, end);
        case DFIELD_MEASURE_QUADRATIC:
            return disk_rows<Other<Quadratic>>(job, lattice, begin, end);
        default:
            return disk_rows<Other<Exponential>>(job, lattice, begin, end);
    }
}

#else
void disk_measures(const EstimateJob& job, const Lattice&, std::int32_t begin, std::int32_t end) {
    for (std::int32_t row = begin; row < end; ++row) estimate_reference(job, row);
}
#endif

}  // namespace dfield::runtime::screen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::screen {

HWY_EXPORT(disk_measures);

DiskFunction* disk_measures_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(disk_measures), targets, static_cast<DiskFunction*>(nullptr));
}

}  // namespace dfield::runtime::screen
#endif
