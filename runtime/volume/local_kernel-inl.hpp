// Walking rays, kLanes voxels of some rows at a time. A sample lies at the same offset from each of them, so
// its trilinear weights are constants and its eight voxels lie in two rows of two slices: no gathers. Rows
// side by side share what is interpolated along x, and pairs of them what is interpolated along y. Included
// once a target.
//
// With T_i the light that reaches sample i and d_i = T_i a_i what the sample takes of it, equation 2 is
//     M A = sum_m T_m = M - sum_i (M - i) d_i,
// in which an empty sample changes nothing at all, to the last bit: it need not be taken.
#if defined(DFIELD_VOLUME_LOCAL_KERNEL_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_VOLUME_LOCAL_KERNEL_INL_HPP
#undef DFIELD_VOLUME_LOCAL_KERNEL_INL_HPP
#else
#define DFIELD_VOLUME_LOCAL_KERNEL_INL_HPP
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "volume/local.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET != HWY_SCALAR

using F = hn::CappedTag<float, kBlockX>;
using V = hn::Vec<F>;

// Rows whose sums are kept in registers: 8 where there are 32 registers, 4 where there are 16.
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4
constexpr std::size_t kRowsY = 2, kRowsZ = 2;
#else
constexpr std::size_t kRowsY = 4, kRowsZ = 2;
#endif

// A value that stays in its register: folded into both instructions that use it, it would be loaded twice,
// and loads of rows that straddle cache lines are what limits this kernel.
HWY_INLINE V loaded_once(V v) {
#if HWY_ARCH_X86 && (HWY_COMPILER_GCC || HWY_COMPILER_CLANG)
    asm("" : "+v"(v.raw));
#endif
    return v;
}

struct Walk {
    const LocalPlan::Step* steps;
    std::size_t count;  // of the ray's steps
    std::ptrdiff_t row, slice;
    const std::uint8_t* windows;  // the block's
};

// Where a step's samples are: by a walk's own volume for all steps.
struct Throughout {
    static std::uint8_t occupied(const Walk& walk, std::size_t i) {
        return walk.windows[walk.steps[i].window];
    }
    struct Place {
        const float* at;
        std::ptrdiff_t row, slice;
    };
    HWY_INLINE Place place(const Walk& walk, const float* at, std::size_t i) const {
        return {at + walk.steps[i].offset, walk.row, walk.slice};
    }
};

// The light of some rows' rays, and what was lost of it.
struct Lanes {
    V light[kRowsZ][kRowsY], dark[kRowsZ][kRowsY];
};

// kX, kY, kZ: whether fractions along this axis are other than 0. kSlopes: whether steps have slopes.
template<bool kX, bool kY, bool kZ, bool kSlopes>
HWY_INLINE void take_sample(const LocalPlan::Step& step, const float* HWY_RESTRICT at, std::ptrdiff_t row,
                            std::ptrdiff_t slice, Lanes& lanes) {
    const F f;
    const V fx = hn::Set(f, step.fraction[0]), fy = hn::Set(f, step.fraction[1]),
            fz = hn::Set(f, step.fraction[2]), weight = hn::Set(f, step.weight);
    const auto lerp = [](V low, V high, V t) HWY_ATTR { return hn::MulAdd(hn::Sub(high, low), t, low); };
    const auto along_x = [&](const float* p) HWY_ATTR {
        if constexpr (kX) return lerp(loaded_once(hn::LoadU(f, p)), hn::LoadU(f, p + 1), fx);
        return hn::LoadU(f, p);
    };
    V below[kRowsY];
#pragma GCC unroll 8
    for (std::size_t z = 0; z < kRowsZ + (kZ ? 1 : 0); ++z) {
        const float* HWY_RESTRICT p = at + static_cast<std::ptrdiff_t>(z) * slice;
        V here[kRowsY];
        if constexpr (kY) {
            V low = along_x(p);
#pragma GCC unroll 8
            for (std::size_t y = 0; y < kRowsY; ++y) {
                p += row;
                const V high = along_x(p);
                here[y] = lerp(low, high, fy);
                low = high;
            }
        } else {
#pragma GCC unroll 8
            for (std::size_t y = 0; y < kRowsY; ++y, p += row) here[y] = along_x(p);
        }
        if (!kZ || z > 0) {
            constexpr std::size_t kBack = kZ ? 1 : 0;
#pragma GCC unroll 8
            for (std::size_t y = 0; y < kRowsY; ++y) {
                const V opacity = kZ ? lerp(below[y], here[y], fz) : here[y];
                V &t = lanes.light[z - kBack][y], &d = lanes.dark[z - kBack][y];
                const V taken = hn::Mul(t, opacity);
                t = hn::Sub(t, taken);
                if constexpr (kSlopes)
                    d = hn::MulAdd(taken, hn::MulAdd(opacity, hn::Set(f, step.slope), weight), d);
                else
                    d = hn::MulAdd(taken, weight, d);
            }
        }
#pragma GCC unroll 8
        for (std::size_t y = 0; y < kRowsY; ++y) below[y] = here[y];
    }
}

HWY_INLINE void begin(Lanes& lanes) {
    const F f;
#pragma GCC unroll 8
    for (std::size_t z = 0; z < kRowsZ; ++z)
#pragma GCC unroll 8
        for (std::size_t y = 0; y < kRowsY; ++y) {
            lanes.light[z][y] = hn::Set(f, 1.0f);
            lanes.dark[z][y] = hn::Zero(f);
        }
}

// Steps [first, last) of a ray of kRowsY x kRowsZ rows from the vector of voxels at `at` on. False where no
// light is left. Rays may be walked in parts: what is left is looked at where it would be if they were not.
template<bool kX, bool kY, bool kZ, bool kSlopes, class Where = Throughout>
HWY_INLINE bool walk_steps(const Walk& walk, const float* HWY_RESTRICT at, std::size_t first,
                           std::size_t last, Lanes& lanes, const Where& where = {}) {
    const F f;
    while (first < last) {
        const std::size_t check = std::min(first / kCheck * kCheck + kCheck, walk.count),
                          end = std::min(check, last);
        unsigned wanted = 0;
        for (std::size_t i = first; i < end; ++i)
            wanted |= static_cast<unsigned>(where.occupied(walk, i)) << (i - first);
        const std::size_t begin = first;
        first = end;
        if (wanted == 0 && begin % kCheck == 0) continue;
        while (wanted != 0) {
            const std::size_t i = begin + hwy::Num0BitsBelowLS1Bit_Nonzero32(wanted);
            const auto place = where.place(walk, at, i);
            take_sample<kX, kY, kZ, kSlopes>(walk.steps[i], place.at, place.row, place.slice, lanes);
            wanted &= wanted - 1;
        }
        if (end != check) break;
        const V limit = hn::Set(f, kOpaque);
        V most = hn::Zero(f);
#pragma GCC unroll 8
        for (std::size_t z = 0; z < kRowsZ; ++z)
#pragma GCC unroll 8
            for (std::size_t y = 0; y < kRowsY; ++y) {
                V& light = lanes.light[z][y];
                light = hn::IfThenElseZero(hn::Ge(light, limit), light);
                most = hn::Max(most, light);
            }
        if (hn::AllTrue(f, hn::Eq(most, hn::Zero(f)))) return false;
    }
    return true;
}

// What a ray lost is kept in whole quanta, so that sums of rays can be taken apart again, to the last bit.
HWY_INLINE V in_quanta(bool whole, V dark) {
    return whole ? hn::Round(dark) : dark;
}

// All of a ray; adds what was lost of it to `sums`.
template<bool kX, bool kY, bool kZ, bool kSlopes>
void walk_ray(const Walk& walk, const float* HWY_RESTRICT at, bool whole, float* HWY_RESTRICT sums) {
    const F f;
    Lanes lanes;
    begin(lanes);
    walk_steps<kX, kY, kZ, kSlopes>(walk, at, 0, walk.count, lanes);
#pragma GCC unroll 8
    for (std::size_t z = 0; z < kRowsZ; ++z)
#pragma GCC unroll 8
        for (std::size_t y = 0; y < kRowsY; ++y) {
            float* const sum = sums + (z * kBlockY + y) * kBlockX;
            hn::Store(hn::Add(hn::Load(f, sum), in_quanta(whole, lanes.dark[z][y])), f, sum);
        }
}

using WalkRay = void(const Walk& walk, const float* HWY_RESTRICT at, bool whole, float* HWY_RESTRICT sums);
template<bool kSlopes>
constexpr WalkRay* kWalks[] = {walk_ray<false, false, false, kSlopes>, walk_ray<true, false, false, kSlopes>,
                               walk_ray<false, true, false, kSlopes>,  walk_ray<true, true, false, kSlopes>,
                               walk_ray<false, false, true, kSlopes>,  walk_ray<true, false, true, kSlopes>,
                               walk_ray<false, true, true, kSlopes>,   walk_ray<true, true, true, kSlopes>};

// Calls use(x, y, z, row) for the vectors of a block's rows that are walked together: their first voxel, and
// where it is among a block's own floats.
template<class Use>
HWY_INLINE void for_rows(const Use& use) {
    for (std::size_t z = 0; z < kBlockZ; z += kRowsZ)
        for (std::size_t y = 0; y < kBlockY; y += kRowsY)
            for (std::size_t x = 0; x < kBlockX; x += hn::Lanes(F()))
                use(static_cast<std::ptrdiff_t>(x), static_cast<std::ptrdiff_t>(y),
                    static_cast<std::ptrdiff_t>(z), (z * kBlockY + y) * kBlockX + x);
}

// What of a block lies in the grid, a row of kBlockX floats after the other.
inline void store_block(const Grid& grid, std::size_t x, std::size_t y, std::size_t z, const float* from,
                        float* visibility) {
    const std::size_t columns = std::min(kBlockX, grid.nx - x);
    for (std::size_t k = 0; k < std::min(kBlockZ, grid.nz - z); ++k)
        for (std::size_t j = 0; j < std::min(kBlockY, grid.ny - y); ++j)
            std::copy_n(from + (k * kBlockY + j) * kBlockX, columns,
                        visibility + grid.index(x, y + j, z + k));
}

template<bool kSlopes>
void local_of_tile(const LocalJob& job, const Tile& tile) {
    constexpr std::size_t kBlocks = kTileBlocksX * kTileBlocksY * kTileBlocksZ;
    HWY_ALIGN float dark[kBlocks * kBlock];
    const F f;
    const OpacityVolume& volume = *job.opacity;
    const LocalPlan& plan = *job.plan;
    const LocalRays& rays = *plan.rays;
    const Grid& grid = volume.grid();
    struct Place {
        std::size_t x, y, z;
        const float* at;
        const std::uint8_t* windows;
        float* dark;
    } places[kBlocks];
    std::size_t count = 0;
    for_blocks(grid, tile, [&](std::size_t, std::size_t x, std::size_t y, std::size_t z) {
        Place& place = places[count];
        place = {x, y, z, volume.row(y, z) + x, volume.occupied().window(x, y, z), dark + count * kBlock};
        std::fill_n(place.dark, kBlock, 0.0f);
        ++count;
    });
    for (std::size_t k = 0; k < rays.count; ++k) {
        Walk walk{plan.steps.data() + k * rays.per_ray, rays.per_ray, volume.row_stride(),
                  volume.slice_stride(), nullptr};
        WalkRay* const walk_one = kWalks<kSlopes>[plan.inside[k]];
        for (std::size_t i = 0; i < count; ++i) {
            const Place& place = places[i];
            walk.windows = place.windows;
            for_rows([&](std::ptrdiff_t x, std::ptrdiff_t y, std::ptrdiff_t z, std::size_t row) {
                walk_one(walk, place.at + (x + y * walk.row + z * walk.slice), plan.whole, place.dark + row);
            });
        }
    }
    const V open = hn::Set(f, plan.open), quantum = hn::Set(f, plan.quantum);
    for (std::size_t i = 0; i < count; ++i) {
        const Place& place = places[i];
        for (std::size_t r = 0; r < kBlock; r += hn::Lanes(f)) {
            const V left = hn::Max(hn::Zero(f), hn::Sub(open, hn::Load(f, place.dark + r)));
            hn::Store(hn::Mul(left, quantum), f, place.dark + r);
        }
        store_block(grid, place.x, place.y, place.z, place.dark, job.visibility);
    }
}

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
