// Section 4.5 for a vector of pixels that use the same samples and lie `side` pixels apart. Pixels of about
// the same depth share a pattern, so that a sample's depths are a plain load from the lattice; those of
// another are done in another turn.
//
// Along a pipe z' = z |r|^2, r being the ray of sight, so that with g = (x, y).(rx, ry), e = (x, y).(nx, ny):
//     sphere           g -+ sqrt(g^2 + |r|^2 (1 - x^2 - y^2))
//     (o - s).N        e + z' b, b = N.(-r) / |r|^2
//     tangent plane    -e / b
//     h                2 / |r| (high - low) (2 e + b (high + low))          quartic measure
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "screen/disk.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "screen/disk.hpp"
#include "screen/disk_patterns.hpp"
#include "simd.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::screen::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET != HWY_SCALAR

using F = hn::CappedTag<float, Lattice::kBorder>;
using U = hn::RebindToUnsigned<F>;
using V = hn::Vec<F>;
using M = hn::Mask<F>;

// What a vector of pixels needs for all of its samples. Lengths in units of R.
struct Lanes {
    V depth, per_depth;    // z' = (depth - that of a pixel) per_depth
    V sight_x, sight_y;    // of a pixel's length: g = x sight_x + y sight_y
    V normal_x, normal_y;  // likewise
    V across2, around;     // |r|^2 (1 - distance^2 pixel^2) = around - distance2 across2
    V slope, tangent;      // b, -1 / b
    V n_x, n_y, n_z, r_x, r_y, pixel, sight_2, per_sight_2;
};

struct Sums {
    V seen, open, red, green, blue, weight;
};

// Radiance of the pixels `there` where it counts (add_radiance in reference.cpp).
HWY_INLINE void add_light(const Lattice& lattice, const Lanes& p, std::ptrdiff_t there, V x, V y, V g, V e,
                          V rise, Sums& sums) {
    const F f;
    const V one = hn::Set(f, 1.0f), fade = hn::Set(f, 16.0f), zero = hn::Zero(f);
    const V z = hn::Mul(rise, p.per_sight_2);
    const V r2 = hn::MulAdd(hn::MulAdd(hn::Set(f, -2.0f), g, rise), z, hn::MulAdd(x, x, hn::Mul(y, y)));
    const V ahead = hn::Mul(fade, hn::MulAdd(rise, p.slope, e));
    const M counts = hn::And(hn::Lt(r2, one), hn::Gt(ahead, zero));
    if (hn::AllFalse(f, counts)) return;
    const auto plane = static_cast<std::ptrdiff_t>(lattice.size());
    const float* HWY_RESTRICT normal = lattice.normals + there;
    const float* HWY_RESTRICT radiance = lattice.radiance + there;
    const V px = hn::NegMulAdd(z, p.r_x, x), py = hn::NegMulAdd(z, p.r_y, y);
    const V towards = hn::MulAdd(
        hn::LoadU(f, normal), px,
        hn::MulAdd(hn::LoadU(f, normal + plane), py, hn::Mul(hn::LoadU(f, normal + 2 * plane), z)));
    const V turned = hn::Mul(hn::Neg(fade), towards);
    const V near = hn::NegMulAdd(r2, r2, one);
    V weight = hn::Mul(near, hn::Mul(hn::Min(ahead, one), hn::Min(turned, one)));
    // Beyond a picture's end radiance is whatever memory holds.
    const M lights = hn::And(counts, hn::Gt(turned, zero));
    weight = hn::IfThenElseZero(lights, weight);
    sums.red = hn::MulAdd(weight, hn::IfThenElseZero(lights, hn::LoadU(f, radiance)), sums.red);
    sums.green = hn::MulAdd(weight, hn::IfThenElseZero(lights, hn::LoadU(f, radiance + plane)), sums.green);
    sums.blue = hn::MulAdd(weight, hn::IfThenElseZero(lights, hn::LoadU(f, radiance + 2 * plane)), sums.blue);
    sums.weight = hn::Add(sums.weight, weight);
}

template<bool kLight>
HWY_INLINE void add_sample(const Lattice& lattice, const Lanes& p, const Offsets::Offset& o,
                           std::ptrdiff_t there, Sums& sums) {
    const F f;
    const V x = hn::Set(f, o.x), y = hn::Set(f, o.y);
    const V g = hn::MulAdd(x, p.sight_x, hn::Mul(y, p.sight_y));
    const V e = hn::MulAdd(x, p.normal_x, hn::Mul(y, p.normal_y));
    const V inside = hn::NegMulAdd(hn::Set(f, o.distance2), p.across2, hn::MulAdd(g, g, p.around));
    const V root = hn::Sqrt(hn::Max(inside, hn::Zero(f)));
    const V high = hn::Add(g, root);
    const V low = hn::Min(hn::Max(hn::Sub(g, root), hn::Mul(e, p.tangent)), high);
    const V rise = hn::Mul(hn::Sub(p.depth, hn::LoadU(f, lattice.depth + there)), p.per_depth);
    const V ground = hn::Min(hn::Max(low, rise), high);
    const V twice = hn::Add(e, e), weight = hn::Set(f, o.weight);
    const V open = hn::Mul(hn::Sub(high, low), hn::MulAdd(p.slope, hn::Add(high, low), twice));
    const V seen = hn::Mul(hn::Sub(high, ground), hn::MulAdd(p.slope, hn::Add(high, ground), twice));
    sums.open = hn::MulAdd(weight, open, sums.open);
    sums.seen = hn::MulAdd(weight, seen, sums.seen);
    if constexpr (kLight)
        add_light(lattice, p, there, hn::Mul(x, p.pixel), hn::Mul(y, p.pixel), g, e, rise, sums);
}

// The pixels from (column, row) on of picture (x, y) of the lattice.
template<bool kLight>
HWY_INLINE void add_pattern(const Lattice& lattice, const Lanes& p, const Offsets& offsets,
                            std::int32_t column, std::int32_t row, Sums& sums) {
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(F()));
    const bool inside = column + offsets.left >= -Lattice::kBorder &&
                        column + offsets.right + lanes <= lattice.width + Lattice::kBorder &&
                        row + offsets.up >= -1 && row + offsets.down <= lattice.height;
    if (inside) {
        const std::ptrdiff_t at = row * lattice.stride + column;
        for (std::uint32_t i = 0; i < offsets.count; ++i)
            add_sample<kLight>(lattice, p, offsets.offsets[i], at + offsets.offsets[i].index, sums);
        return;
    }
    for (std::uint32_t i = 0; i < offsets.count; ++i) {
        const Offsets::Offset& o = offsets.offsets[i];
        const std::int32_t to = std::clamp(column + o.columns, -Lattice::kBorder, lattice.width);
        const std::int32_t to_row = std::clamp(row + o.rows, -1, lattice.height);
        const std::ptrdiff_t moved = (to_row - o.rows) * lattice.stride + to - o.columns;
        add_sample<kLight>(lattice, p, o, o.index + moved, sums);
    }
}

struct Results {
    static constexpr std::int32_t kChannels = 7;  // visibility, light, slopes
    HWY_ALIGN float values[kChannels][8][Lattice::kBorder];
};

template<bool kLight>
void disk_block(const EstimateJob& job, const Lattice& lattice, OffsetCache& cache, std::int32_t x,
                std::int32_t y, std::int32_t column, std::int32_t row, Results& results) {
    const F f;
    const U u;
    const Frame& frame = *job.frame;
    const V one = hn::Set(f, 1.0f), zero = hn::Zero(f);
    const auto plane = static_cast<std::ptrdiff_t>(lattice.size());
    const std::ptrdiff_t at = lattice.index(x, y, column, row);

    // As shaded_at() and Pattern have it, to the last bit where the pattern depends on it.
    Lanes p;
    p.depth = hn::LoadU(f, lattice.depth + at);
    const M sky = hn::Not(hn::Lt(p.depth, hn::Set(f, kSky)));
    const float place = static_cast<float>(column * lattice.side + x);
    const V columns =
        hn::Add(hn::Set(f, place), hn::Mul(hn::Iota(f, 0.0f), hn::Set(f, static_cast<float>(lattice.side))));
    p.r_x = hn::Add(hn::Set(f, frame.sight.left), hn::Mul(columns, hn::Set(f, frame.sight.step_x)));
    p.r_y = hn::Set(f, frame.sight.at_y(row * lattice.side + y));
    p.sight_2 = hn::Add(hn::Mul(p.r_x, p.r_x), hn::Add(hn::Mul(p.r_y, p.r_y), one));
    const V scale = hn::Div(frame.camera.perspective ? p.depth : one, hn::Set(f, frame.radius));
    p.pixel = hn::Mul(hn::Set(f, frame.camera.step_x), scale);
    const V pixel_y = hn::Mul(hn::Set(f, frame.camera.step_y), scale);
    const V length = hn::Sqrt(p.sight_2);
    const V reach = hn::Div(length, p.pixel);
    const M empty = hn::Not(hn::Gt(hn::Max(reach, hn::Div(length, pixel_y)), hn::Set(f, 0.5f)));

    const auto steps = hn::BitCast(u, hn::Min(hn::Max(reach, hn::Set(f, 0.5f)), hn::Set(f, Pattern::kMost)));
    const auto rounded = hn::ShiftLeft<Pattern::kDropped>(
        hn::ShiftRight<Pattern::kDropped>(hn::Add(steps, hn::Set(u, (1u << Pattern::kDropped) - 1))));
    const V patterns = hn::BitCast(f, rounded);

    p.n_x = hn::LoadU(f, lattice.normals + at);
    p.n_y = hn::LoadU(f, lattice.normals + plane + at);
    p.n_z = hn::LoadU(f, lattice.normals + 2 * plane + at);
    const V facing = hn::Sub(p.n_z, hn::Add(hn::Mul(p.n_x, p.r_x), hn::Mul(p.n_y, p.r_y)));
    p.per_sight_2 = hn::Div(one, p.sight_2);
    p.slope = hn::Mul(facing, p.per_sight_2);
    p.tangent = hn::Div(hn::Set(f, -1.0f), p.slope);
    p.per_depth = hn::Mul(p.sight_2, hn::Set(f, 1 / frame.radius));
    p.sight_x = hn::Mul(p.pixel, p.r_x);
    p.sight_y = hn::Mul(p.pixel, p.r_y);
    p.normal_x = hn::Mul(p.pixel, p.n_x);
    p.normal_y = hn::Mul(p.pixel, p.n_y);
    p.around = p.sight_2;
    p.across2 = hn::Mul(p.sight_2, hn::Mul(p.pixel, p.pixel));

    Sums all{zero, zero, zero, zero, zero, zero};
    M left = hn::Not(hn::Or(sky, empty));
    while (!hn::AllFalse(f, left)) {
        const float radius = hn::GetLane(hn::MaxOfLanes(f, hn::IfThenElseZero(left, patterns)));
        const M turn = hn::And(left, hn::Eq(patterns, hn::Set(f, radius)));
        Sums sums{zero, zero, zero, zero, zero, zero};
        for (std::uint32_t first = 0; first < job.disk->count; first += Offsets::kMost)
            add_pattern<kLight>(lattice, p, cache.get(radius, x, y, first), column, row, sums);
        const auto merge = [&](V& to, V from) HWY_ATTR { to = hn::IfThenElse(turn, from, to); };
        merge(all.seen, sums.seen);
        merge(all.open, sums.open);
        if constexpr (kLight) {
            merge(all.red, sums.red);
            merge(all.green, sums.green);
            merge(all.blue, sums.blue);
            merge(all.weight, sums.weight);
        }
        left = hn::AndNot(turn, left);
    }
    const M nothing = hn::Or(sky, empty);
    V visibility;
    if (job.settings->ratio()) {
        visibility = hn::IfThenElse(hn::Gt(all.open, zero), hn::Div(all.seen, all.open), one);
    } else {  // 2 / |r| from h, the pattern's area across the ray of sight, over n
        const V area = hn::Mul(hn::Mul(patterns, patterns), hn::Mul(p.pixel, p.pixel));
        const V per = hn::Div(hn::Set(f, 2 / static_cast<float>(job.disk->count)), p.sight_2);
        visibility = hn::Mul(all.seen, hn::Mul(area, per));
    }
    visibility = hn::IfThenElse(nothing, one, visibility);
    const auto put = [&](std::size_t channel, V value)
                         HWY_ATTR { hn::Store(value, f, results.values[channel][x]); };
    put(0, visibility);
    if constexpr (kLight) {
        put(1, all.red);
        put(2, all.green);
        put(3, all.blue);
        const V darkness = hn::Set(f, kDarkness * static_cast<float>(job.disk->count));
        put(4, hn::IfThenElseZero(hn::Not(nothing), hn::Add(all.weight, darkness)));
    }
    if (job.slopes) {
        const V steep = hn::Div(hn::Set(f, frame.radius), facing);
        put(5, hn::IfThenElse(sky, zero, hn::Mul(hn::Mul(p.n_x, p.pixel), steep)));
        put(6, hn::IfThenElse(sky, zero, hn::Neg(hn::Mul(hn::Mul(p.n_y, pixel_y), steep))));
    }
}

void disk(const EstimateJob& job, const Lattice& lattice, std::int32_t begin, std::int32_t end) {
    const Frame& frame = *job.frame;
    const Layout& layout = frame.layout;
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(F()));
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
                (job.indirect ? disk_block<true> : disk_block<false>)(job, lattice, cache, x, y, column,
                                                                      row_there, results);
            const std::int32_t first = column * lattice.side;
            const std::int32_t count = std::min(lanes * lattice.side, layout.width - first);
            for (std::int32_t channel = 0; channel < Results::kChannels; ++channel) {
                if (!out[channel]) continue;
                float* const to = out[channel] + layout.index(first, row);
                if (lattice.side == 4 && count == 4 * lanes) {
                    const F f;
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

#else
void disk(const EstimateJob& job, const Lattice&, std::int32_t begin, std::int32_t end) {
    for (std::int32_t row = begin; row < end; ++row) estimate_reference(job, row);
}
#endif

}  // namespace dfield::runtime::screen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::screen {

HWY_EXPORT(disk);

DiskFunction* disk_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(disk), targets, static_cast<DiskFunction*>(nullptr));
}

}  // namespace dfield::runtime::screen
#endif
