// Section 4.5 for a vector of pixels that use the same samples and lie `side` pixels apart. Pixels of about
// the same depth share a pattern, so that a sample's depths are a plain load from the lattice; those of
// another are done in another turn. Seen once a target.
//
// Along a pipe z' = z |r|^2, r being the ray of sight, so that with g = (x, y).(rx, ry), e = (x, y).(nx, ny):
//     sphere           g -+ sqrt(g^2 + |r|^2 (1 - x^2 - y^2))
//     (o - s).N        e + z' b, b = N.(-r) / |r|^2
//     tangent plane    -e / b
// h is a measure's affair: see disk.cpp and disk_measures.cpp.
#include <hwy/cache_control.h>

#include "screen/disk.hpp"
#include "screen/disk_patterns.hpp"
#include "screen/vector-inl.hpp"

#if defined(DFIELD_SCREEN_DISK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_SCREEN_DISK_INL
#undef DFIELD_SCREEN_DISK_INL
#else
#define DFIELD_SCREEN_DISK_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::screen::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

// What a vector of pixels needs for all of its samples. Lengths in units of R.
struct Lanes : Pixels {
    V per_depth;           // z' = (depth - that of a pixel) per_depth
    V sight_x, sight_y;    // of a pixel's length: g = x sight_x + y sight_y
    V normal_x, normal_y;  // likewise
    V across2;             // |r|^2 (1 - distance^2 pixel^2) = |r|^2 - distance2 across2
    V slope, tangent;      // b, -1 / b
    V per_sight_2;

    HWY_INLINE Lanes(const Frame& frame, const Lattice& lattice, std::int32_t x, std::int32_t y,
                     std::int32_t column, std::int32_t row)
        : Pixels(frame, lattice, lattice.index(x, y, column, row), column * lattice.side + x, lattice.side,
                 row * lattice.side + y) {
        per_depth = hn::Mul(sight_2, set(frame.per_radius));
        sight_x = hn::Mul(pixel_x, r_x);
        sight_y = hn::Mul(pixel_x, r_y);
        normal_x = hn::Mul(pixel_x, normal.x);
        normal_y = hn::Mul(pixel_x, normal.y);
        across2 = hn::Mul(sight_2, hn::Mul(pixel_x, pixel_x));
        per_sight_2 = hn::Div(set(1), sight_2);
        slope = hn::Mul(facing, per_sight_2);
        tangent = hn::Div(set(-1), slope);
    }
};

struct Light {
    V red, green, blue, weight;
    HWY_INLINE Light() : red(set(0)), green(red), blue(red), weight(red) {}
};

// add_radiance() of the surfaces from a place of the lattice on, of lanes `counts`: those between the tangent
// plane and the sphere's end.
HWY_INLINE void add_light(const Lattice& lattice, const Lanes& p, std::ptrdiff_t there, M counts, V x, V y,
                          V g, V e, V rise, Light& sums) {
    const F f;
    const V one = set(1), fade = set(16), zero = set(0), z = hn::Mul(rise, p.per_sight_2);
    const V at_x = hn::Mul(x, p.pixel_x), at_y = hn::Mul(y, p.pixel_x);
    const V r2 = hn::MulAdd(hn::MulAdd(set(-2), g, rise), z, hn::MulAdd(at_x, at_x, hn::Mul(at_y, at_y)));
    const V ahead = hn::Mul(fade, hn::MulAdd(rise, p.slope, e));
    const auto plane = static_cast<std::ptrdiff_t>(lattice.size());
    const float* HWY_RESTRICT normal = lattice.normals + there;
    const float* HWY_RESTRICT radiance = lattice.radiance + there;
    const V towards = hn::MulAdd(hn::LoadU(f, normal), hn::NegMulAdd(z, p.r_x, at_x),
                                 hn::MulAdd(hn::LoadU(f, normal + plane), hn::NegMulAdd(z, p.r_y, at_y),
                                            hn::Mul(hn::LoadU(f, normal + 2 * plane), z)));
    const V turned = hn::Mul(hn::Neg(fade), towards);
    // Beyond a picture's end radiance is whatever memory holds.
    const M lights = hn::And(counts, hn::Gt(turned, zero));
    const V near = hn::NegMulAdd(r2, r2, one);
    const V weight =
        hn::IfThenElseZero(lights, hn::Mul(near, hn::Mul(hn::Min(ahead, one), hn::Min(turned, one))));
    const auto add = [&](V& sum, const float* from) HWY_ATTR {
        sum = hn::MulAdd(weight, hn::IfThenElseZero(lights, hn::LoadU(f, from)), sum);
    };
    add(sums.red, radiance);
    add(sums.green, radiance + plane);
    add(sums.blue, radiance + 2 * plane);
    sums.weight = hn::Add(sums.weight, weight);
}

struct Sums {
    V seen, open;
    Light light;
    HWY_INLINE Sums() : seen(set(0)), open(seen) {}
};

template<class Measure, bool kLight>
HWY_INLINE void add_sample(const Lattice& lattice, const Lanes& p, const Measure& measure,
                           const Offsets::Offset& o, std::ptrdiff_t there, Sums& sums) {
    const F f;
    const V x = set(o.x), y = set(o.y);
    const V g = hn::MulAdd(x, p.sight_x, hn::Mul(y, p.sight_y));
    const V e = hn::MulAdd(x, p.normal_x, hn::Mul(y, p.normal_y));
    const V inside = hn::NegMulAdd(set(o.distance2), p.across2, hn::MulAdd(g, g, p.sight_2));
    const V root = hn::Sqrt(hn::Max(inside, set(0)));
    const V high = hn::Add(g, root);
    const V low = hn::Min(hn::Max(hn::Sub(g, root), hn::Mul(e, p.tangent)), high);
    // Of the next pixels: more streams than processors follow by themselves.
    hwy::Prefetch(lattice.depth + there + 2 * hn::Lanes(f) - 1);
    const V rise = hn::Mul(hn::Sub(p.depth, hn::LoadU(f, lattice.depth + there)), p.per_depth);
    const V ground = hn::Min(hn::Max(low, rise), high);
    const V weight = set(o.weight);
    V open, seen;
    measure.integrals(p, o, g, e, low, ground, high, open, seen);
    sums.open = hn::MulAdd(weight, open, sums.open);
    sums.seen = hn::MulAdd(weight, seen, sums.seen);
    if constexpr (kLight) {
        const M counts = hn::And(hn::Gt(rise, low), hn::Lt(rise, high));
        if (!hn::AllFalse(f, counts)) add_light(lattice, p, there, counts, x, y, g, e, rise, sums.light);
    }
}

// The pixels from (column, row) on of picture (x, y) of the lattice.
template<class Measure, bool kLight>
HWY_INLINE void add_pattern(const Lattice& lattice, const Lanes& p, const Measure& measure,
                            const Offsets& offsets, std::int32_t column, std::int32_t row, Sums& sums) {
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(F()));
    const bool inside = column + offsets.left >= -Lattice::kBorder &&
                        column + offsets.right + lanes <= lattice.width + Lattice::kBorder &&
                        row + offsets.up >= -1 && row + offsets.down <= lattice.height;
    if (inside) {
        const std::ptrdiff_t at = row * lattice.stride + column;
        for (std::uint32_t i = 0; i < offsets.count; ++i)
            add_sample<Measure, kLight>(lattice, p, measure, offsets.offsets[i],
                                        at + offsets.offsets[i].index, sums);
        return;
    }
    for (std::uint32_t i = 0; i < offsets.count; ++i) {
        const Offsets::Offset& o = offsets.offsets[i];
        const std::int32_t to = std::clamp(column + o.columns, -Lattice::kBorder, lattice.width);
        const std::int32_t to_row = std::clamp(row + o.rows, -1, lattice.height);
        const std::ptrdiff_t moved = (to_row - o.rows) * lattice.stride + to - o.columns;
        add_sample<Measure, kLight>(lattice, p, measure, o, o.index + moved, sums);
    }
}

struct Results {
    static constexpr std::int32_t kChannels = 7;  // visibility, light, slopes
    HWY_ALIGN float values[kChannels][8][Lattice::kBorder];
};

template<class Measure, bool kLight>
void disk_block(const EstimateJob& job, const Lattice& lattice, OffsetCache& cache, std::int32_t x,
                std::int32_t y, std::int32_t column, std::int32_t row, Results& results) {
    const F f;
    const U u;
    const V one = set(1), zero = set(0);
    const float frame_radius = job.frame->radius;
    const Lanes p(*job.frame, lattice, x, y, column, row);
    const Measure measure(*job.settings, p);

    // As Pattern has it, to the last bit.
    const auto steps = hn::BitCast(u, hn::Min(hn::Max(p.reach, set(0.5f)), set(Pattern::kMost)));
    const auto rounded = hn::ShiftLeft<Pattern::kDropped>(
        hn::ShiftRight<Pattern::kDropped>(hn::Add(steps, hn::Set(u, (1u << Pattern::kDropped) - 1))));
    const V patterns = hn::BitCast(f, rounded);

    Sums all;
    M left = hn::Not(p.nothing);
    while (!hn::AllFalse(f, left)) {
        const float radius = hn::GetLane(hn::MaxOfLanes(f, hn::IfThenElseZero(left, patterns)));
        const M turn = hn::And(left, hn::Eq(patterns, set(radius)));
        Sums sums;
        for (std::uint32_t first = 0; first < job.disk->count; first += Offsets::kMost)
            add_pattern<Measure, kLight>(lattice, p, measure, cache.get(radius, x, y, first), column, row,
                                         sums);
        const auto merge = [&](V& to, V from) HWY_ATTR { to = hn::IfThenElse(turn, from, to); };
        merge(all.seen, sums.seen);
        merge(all.open, sums.open);
        if constexpr (kLight) {
            merge(all.light.red, sums.light.red);
            merge(all.light.green, sums.light.green);
            merge(all.light.blue, sums.light.blue);
            merge(all.light.weight, sums.light.weight);
        }
        left = hn::AndNot(turn, left);
    }
    V visibility;
    if (job.settings->ratio()) {
        visibility = hn::IfThenElse(hn::Gt(all.open, zero), hn::Div(all.seen, all.open), one);
    } else {  // the mean of h times the pattern's area, across the ray of sight, over pi
        const V area = hn::Mul(hn::Mul(patterns, patterns), hn::Mul(p.pixel_x, p.pixel_x));
        const V scale = hn::Mul(Measure::scale(p), set(1 / static_cast<float>(job.disk->count)));
        visibility = hn::Mul(all.seen, hn::Mul(area, scale));
    }
    visibility = hn::IfThenElse(p.nothing, one, visibility);
    const auto put = [&](std::size_t channel, V value)
                         HWY_ATTR { hn::Store(value, f, results.values[channel][x]); };
    put(0, visibility);
    if constexpr (kLight) {
        put(1, all.light.red);
        put(2, all.light.green);
        put(3, all.light.blue);
        const V darkness = set(kDarkness * static_cast<float>(job.disk->count));
        put(4, hn::IfThenElseZero(hn::Not(p.nothing), hn::Add(all.light.weight, darkness)));
    }
    if (job.slopes) {
        put(5, p.slope_x(frame_radius));
        put(6, p.slope_y(frame_radius));
    }
}

template<class Measure>
void disk_rows(const EstimateJob& job, const Lattice& lattice, std::int32_t begin, std::int32_t end) {
    const F f;
    const Frame& frame = *job.frame;
    const Layout& layout = frame.layout;
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(f));
    OffsetCache cache(lattice, *job.disk, frame.camera.step_x / frame.camera.step_y);
    const auto plane = static_cast<std::ptrdiff_t>(layout.size());
    float* const out[Results::kChannels] = {job.visibility,
                                            job.indirect ? job.light : nullptr,
                                            job.indirect ? job.light + plane : nullptr,
                                            job.indirect ? job.light + 2 * plane : nullptr,
                                            job.indirect ? job.light + 3 * plane : nullptr,
                                            job.slopes,
                                            job.slopes ? job.slopes + plane : nullptr};
    Results results;
    for (std::int32_t row = begin; row < end; ++row) {
        const std::int32_t y = row % lattice.side, row_there = row / lattice.side;
        for (std::int32_t column = 0; column < lattice.width; column += lanes) {
            for (std::int32_t x = 0; x < lattice.side; ++x)
                (job.indirect ? disk_block<Measure, true> : disk_block<Measure, false>)(job, lattice, cache,
                                                                                        x, y, column,
                                                                                        row_there, results);
            const std::int32_t first = column * lattice.side;
            const std::int32_t count = std::min(lanes * lattice.side, layout.width - first);
            for (std::int32_t channel = 0; channel < Results::kChannels; ++channel) {
                if (!out[channel]) continue;
                float* const to = out[channel] + layout.index(first, row);
                if (lattice.side == 4 && count == 4 * lanes) {
                    const auto& from = results.values[channel];
                    hn::StoreInterleaved4(hn::Load(f, from[0]), hn::Load(f, from[1]), hn::Load(f, from[2]),
                                          hn::Load(f, from[3]), f, to);
                    continue;
                }
                for (std::int32_t i = 0; i < count; ++i)
                    to[i] = results.values[channel][i % lattice.side][i / lattice.side];
            }
        }
    }
}

#endif
}  // namespace dfield::runtime::screen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
