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
#include <array>

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
    RayGroups groups;
    std::size_t count;  // of the ray's steps
    std::ptrdiff_t row, slice;
    std::ptrdiff_t next_y, next_z;  // from a block's windows to those of the block after it
    const LocalPlan::Step* steps = nullptr;
    const std::uint8_t* windows = nullptr;  // the block's

    Walk(const LocalRays& rays, const OpacityVolume& volume)
        : groups(rays.groups),
          count(rays.per_ray),
          row(volume.row_stride()),
          slice(volume.slice_stride()),
          next_y(volume.occupied().window_offset({0, kBlockY, 0})),
          next_z(volume.occupied().window_offset({0, 0, kBlockZ})) {}
};

// The light of some rows' rays, and what was lost of it.
struct Lanes {
    V light[kRowsZ][kRowsY], dark[kRowsZ][kRowsY];
};

// What a sample takes of the light.
struct One {
    static constexpr std::size_t kCheck = volume::kCheck;
    static constexpr float kOpaque = volume::kOpaque;
    static constexpr bool kRestIsTaken = false;  // what is not seen any more, by the next sample

    static HWY_INLINE void take(const LocalPlan::Step& step, V opacity, V& light, V& dark) {
        const V taken = hn::Mul(light, opacity);
        light = hn::Sub(light, taken);
        dark = hn::MulAdd(taken, hn::Set(F(), step.weight), dark);
    }
};

HWY_INLINE V lerp(V low, V high, V t) {
    return hn::MulAdd(hn::Sub(high, low), t, low);
}
template<bool kX>
HWY_INLINE V along_x(const float* p, V fraction) {
    const F f;
    if constexpr (kX) return lerp(loaded_once(hn::LoadU(f, p)), hn::LoadU(f, p + 1), fraction);
    return hn::LoadU(f, p);
}

// kX, kY, kZ: whether fractions along this axis are other than 0.
template<bool kX, bool kY, bool kZ, class Sample>
HWY_INLINE void take_sample(const LocalPlan::Step& step, const float* HWY_RESTRICT at, std::ptrdiff_t row,
                            std::ptrdiff_t slice, Lanes& lanes) {
    const F f;
    const V fx = hn::Set(f, step.fraction[0]), fy = hn::Set(f, step.fraction[1]),
            fz = hn::Set(f, step.fraction[2]);
    V below[kRowsY];
#pragma GCC unroll 8
    for (std::size_t z = 0; z < kRowsZ + (kZ ? 1 : 0); ++z) {
        const float* HWY_RESTRICT p = at + static_cast<std::ptrdiff_t>(z) * slice;
        V here[kRowsY];
        if constexpr (kY) {
            V low = along_x<kX>(p, fx);
#pragma GCC unroll 8
            for (std::size_t y = 0; y < kRowsY; ++y) {
                p += row;
                const V high = along_x<kX>(p, fx);
                here[y] = lerp(low, high, fy);
                low = high;
            }
        } else {
#pragma GCC unroll 8
            for (std::size_t y = 0; y < kRowsY; ++y, p += row) here[y] = along_x<kX>(p, fx);
        }
        if (!kZ || z > 0) {
            constexpr std::size_t kBack = kZ ? 1 : 0;
#pragma GCC unroll 8
            for (std::size_t y = 0; y < kRowsY; ++y) {
                const V opacity = kZ ? lerp(below[y], here[y], fz) : here[y];
                Sample::take(step, opacity, lanes.light[z - kBack][y], lanes.dark[z - kBack][y]);
            }
        }
#pragma GCC unroll 8
        for (std::size_t y = 0; y < kRowsY; ++y) below[y] = here[y];
    }
}

// Where a step's samples are, and whether there can be matter: those of a walk's own volume.
struct Throughout {
    static std::uint8_t occupied(const Walk& walk, std::size_t i) {
        return walk.windows[walk.steps[i].window];
    }
    template<bool kX, bool kY, bool kZ, class Sample>
    HWY_INLINE void take(const Walk& walk, const float* HWY_RESTRICT at, std::size_t i, Lanes& lanes) const {
        const LocalPlan::Step& step = walk.steps[i];
        take_sample<kX, kY, kZ, Sample>(step, at + step.offset, walk.row, walk.slice, lanes);
    }
};

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
template<bool kX, bool kY, bool kZ, class Sample = One, class Where = Throughout>
HWY_INLINE bool walk_steps(const Walk& walk, const float* HWY_RESTRICT at, std::size_t first,
                           std::size_t last, Lanes& lanes, const Where& where = {}) {
    const F f;
    while (first < last) {
        const std::size_t check =
                              std::min(first / Sample::kCheck * Sample::kCheck + Sample::kCheck, walk.count),
                          end = std::min(check, last);
        unsigned wanted = 0;
        for (std::size_t i = first; i < end; ++i)
            wanted |= static_cast<unsigned>(where.occupied(walk, i)) << (i - first);
        const std::size_t begin = first;
        first = end;
        if (wanted == 0 && begin % Sample::kCheck == 0) continue;
        while (wanted != 0) {
            const std::size_t i = begin + hwy::Num0BitsBelowLS1Bit_Nonzero32(wanted);
            where.template take<kX, kY, kZ, Sample>(walk, at, i, lanes);
            wanted &= wanted - 1;
        }
        if (end != check) break;
        const V limit = hn::Set(f, Sample::kOpaque);
        V most = hn::Zero(f);
#pragma GCC unroll 8
        for (std::size_t z = 0; z < kRowsZ; ++z)
#pragma GCC unroll 8
            for (std::size_t y = 0; y < kRowsY; ++y) {
                V& light = lanes.light[z][y];
                const auto seen = hn::Ge(light, limit);
                if constexpr (Sample::kRestIsTaken) {
                    const float next = check < walk.count ? walk.steps[check].weight : 0;
                    V& dark = lanes.dark[z][y];
                    dark = hn::MulAdd(hn::IfThenZeroElse(seen, light), hn::Set(f, next), dark);
                }
                light = hn::IfThenElseZero(seen, light);
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

HWY_INLINE void add_lost(const Lanes& lanes, bool whole, float* HWY_RESTRICT sums) {
    const F f;
#pragma GCC unroll 8
    for (std::size_t z = 0; z < kRowsZ; ++z)
#pragma GCC unroll 8
        for (std::size_t y = 0; y < kRowsY; ++y) {
            float* const sum = sums + (z * kBlockY + y) * kBlockX;
            hn::Store(hn::Add(hn::Load(f, sum), in_quanta(whole, lanes.dark[z][y])), f, sum);
        }
}

// All of a ray; adds what was lost of it to `sums`.
template<bool kX, bool kY, bool kZ>
void walk_ray(const Walk& walk, const float* HWY_RESTRICT at, bool whole, float* HWY_RESTRICT sums) {
    Lanes lanes;
    begin(lanes);
    walk_steps<kX, kY, kZ>(walk, at, 0, walk.count, lanes);
    add_lost(lanes, whole, sums);
}

using WalkRay = void(const Walk& walk, const float* HWY_RESTRICT at, bool whole, float* HWY_RESTRICT sums);
// One for each set of axes along which a ray's fractions are other than 0.
using WalkRays = std::array<WalkRay*, 8>;

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

// What of a block lies in the grid, a row of kBlockX floats after the other; the rows of a group's, kApart
// rows and slices apart.
template<std::size_t kApart = 1>
void store_block(const Grid& grid, std::size_t x, std::size_t y, std::size_t z, const float* from,
                 float* visibility) {
    const std::size_t columns = std::min(kBlockX, grid.nx - x);
    for (std::size_t k = 0; k < kBlockZ && z + kApart * k < grid.nz; ++k)
        for (std::size_t j = 0; j < kBlockY && y + kApart * j < grid.ny; ++j)
            std::copy_n(from + (k * kBlockY + j) * kBlockX, columns,
                        visibility + grid.index(x, y + kApart * j, z + kApart * k));
}

// What is left of a block's light.
inline void to_factors(const LocalPlan& plan, float* block) {
    const F f;
    const V open = hn::Set(f, plan.open), quantum = hn::Set(f, plan.quantum);
    for (std::size_t r = 0; r < kBlock; r += hn::Lanes(f)) {
        const V left = hn::Max(hn::Zero(f), hn::Sub(open, hn::Load(f, block + r)));
        hn::Store(hn::Mul(left, quantum), f, block + r);
    }
}

// Blocks by their lowest voxels, at most a tile's; of kApart 2 groups of 1 x 2 x 2.
struct Corners {
    std::array<std::array<std::size_t, 3>, kTileBlocksX * kTileBlocksY * kTileBlocksZ> at;
    std::size_t count = 0;

    void add(std::size_t x, std::size_t y, std::size_t z) { at[count++] = {x, y, z}; }
};

// Ray by ray, so that a ray's steps are at hand for all of the blocks.
template<std::size_t kApart>
void walk_blocks(const LocalJob& job, const Corners& corners, const WalkRays& walks) {
    HWY_ALIGN float dark[std::tuple_size_v<decltype(Corners::at)> * kBlock];
    const OpacityVolume& volume = *job.opacity;
    const LocalPlan& plan = *job.plan;
    const LocalRays& rays = *plan.rays;
    std::fill_n(dark, corners.count * kBlock, 0.0f);
    Walk walk(rays, volume);
    for (std::size_t k = 0; k < rays.count; ++k) {
        walk.steps = plan.steps.data() + k * rays.per_ray;
        WalkRay* const walk_one = walks[plan.inside[k]];
        for (std::size_t i = 0; i < corners.count; ++i) {
            const auto [x, y, z] = corners.at[i];
            const float* const first = volume.row(y, z) + x;
            walk.windows = volume.occupied().window(x, y, z);
            for_rows([&](std::ptrdiff_t gx, std::ptrdiff_t gy, std::ptrdiff_t gz, std::size_t row) {
                constexpr auto apart = static_cast<std::ptrdiff_t>(kApart);
                walk_one(walk, first + (gx + apart * (gy * walk.row + gz * walk.slice)), plan.whole,
                         dark + i * kBlock + row);
            });
        }
    }
    for (std::size_t i = 0; i < corners.count; ++i) {
        const auto [x, y, z] = corners.at[i];
        to_factors(plan, dark + i * kBlock);
        store_block<kApart>(volume.grid(), x, y, z, dark + i * kBlock, job.visibility);
    }
}

inline void local_of_tile(const LocalJob& job, const Tile& tile, const WalkRays& walks) {
    Corners corners;
    for_blocks(job.opacity->grid(), tile,
               [&](std::size_t, std::size_t x, std::size_t y, std::size_t z) { corners.add(x, y, z); });
    walk_blocks<1>(job, corners, walks);
}

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
