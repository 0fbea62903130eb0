// Local ambient occlusion, kLanes voxels of some rows at a time. A sample lies at the same offset from each
// of them, so its trilinear weights are constants and its eight voxels lie in two rows of two slices: no
// gathers. Rows side by side share what is interpolated along x, and pairs of them what is interpolated along
// y.
//
// With T_i the light that reaches sample i and d_i = T_i a_i what the sample takes of it, equation 2 is
//     M A = sum_m T_m = M - sum_i (M - i) d_i,
// in which an empty sample changes nothing at all, to the last bit: it need not be taken.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/local.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "simd.hpp"
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
    std::size_t kept;
    std::ptrdiff_t row, slice;
    const std::uint8_t* windows;  // the block's
};

// kX, kY, kZ: whether fractions along this axis are other than 0.
template<bool kX, bool kY, bool kZ>
HWY_INLINE void take_sample(const LocalPlan::Step& step, const float* HWY_RESTRICT at, std::ptrdiff_t row,
                            std::ptrdiff_t slice, V (&light)[kRowsZ][kRowsY], V (&dark)[kRowsZ][kRowsY]) {
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
                V& t = light[z - kBack][y];
                const V taken = hn::Mul(t, opacity);
                t = hn::Sub(t, taken);
                dark[z - kBack][y] = hn::MulAdd(taken, weight, dark[z - kBack][y]);
            }
        }
#pragma GCC unroll 8
        for (std::size_t y = 0; y < kRowsY; ++y) below[y] = here[y];
    }
}

// One ray of kRowsY x kRowsZ rows from the vector of voxels at `at` on; adds what it finds to `dark`.
template<bool kX, bool kY, bool kZ>
void walk_ray(const Walk& walk, const float* HWY_RESTRICT at, float* HWY_RESTRICT dark_rows) {
    const F f;
    V light[kRowsZ][kRowsY], dark[kRowsZ][kRowsY];
#pragma GCC unroll 8
    for (std::size_t z = 0; z < kRowsZ; ++z)
#pragma GCC unroll 8
        for (std::size_t y = 0; y < kRowsY; ++y) {
            light[z][y] = hn::Set(f, 1.0f);
            dark[z][y] = hn::Zero(f);
        }
    for (std::size_t first = 0; first < walk.kept; first += kCheck) {
        const LocalPlan::Step* const steps = walk.steps + first;
        const std::size_t count = std::min(kCheck, walk.kept - first);
        unsigned wanted = 0;
        for (std::size_t i = 0; i < count; ++i)
            wanted |= static_cast<unsigned>(walk.windows[steps[i].window]) << i;
        if (wanted == 0) continue;
        do {
            const LocalPlan::Step& step = steps[hwy::Num0BitsBelowLS1Bit_Nonzero32(wanted)];
            take_sample<kX, kY, kZ>(step, at + step.offset, walk.row, walk.slice, light, dark);
            wanted &= wanted - 1;
        } while (wanted != 0);
        const V limit = hn::Set(f, kOpaque);
        V most = hn::Zero(f);
#pragma GCC unroll 8
        for (std::size_t z = 0; z < kRowsZ; ++z)
#pragma GCC unroll 8
            for (std::size_t y = 0; y < kRowsY; ++y) {
                light[z][y] = hn::IfThenElseZero(hn::Ge(light[z][y], limit), light[z][y]);
                most = hn::Max(most, light[z][y]);
            }
        if (hn::AllTrue(f, hn::Eq(most, hn::Zero(f)))) break;
    }
#pragma GCC unroll 8
    for (std::size_t z = 0; z < kRowsZ; ++z)
#pragma GCC unroll 8
        for (std::size_t y = 0; y < kRowsY; ++y) {
            float* const sum = dark_rows + (z * kBlockY + y) * kBlockX;
            hn::Store(hn::Add(hn::Load(f, sum), dark[z][y]), f, sum);
        }
}

using WalkRay = void(const Walk& walk, const float* HWY_RESTRICT at, float* HWY_RESTRICT dark_rows);
constexpr WalkRay* kWalks[] = {walk_ray<false, false, false>, walk_ray<true, false, false>,
                               walk_ray<false, true, false>,  walk_ray<true, true, false>,
                               walk_ray<false, false, true>,  walk_ray<true, false, true>,
                               walk_ray<false, true, true>,   walk_ray<true, true, true>};

void local(const LocalJob& job, const Tile& tile) {
    constexpr std::size_t kBlock = kBlockX * kBlockY * kBlockZ;
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
    for (std::size_t bz = 0; bz < kTileBlocksZ; ++bz)
        for (std::size_t by = 0; by < kTileBlocksY; ++by)
            for (std::size_t bx = 0; bx < kTileBlocksX; ++bx) {
                const std::size_t x = tile.x + bx * kBlockX, y = tile.y + by * kBlockY,
                                  z = tile.z + bz * kBlockZ;
                if (!(tile.blocks >> block_bit(bx, by, bz) & 1) || x >= grid.nx || y >= grid.ny ||
                    z >= grid.nz)
                    continue;
                Place& place = places[count];
                place = {
                    x, y, z, volume.row(y, z) + x, volume.occupied().window(x, y, z), dark + count * kBlock};
                std::fill_n(place.dark, kBlock, 0.0f);
                ++count;
            }
    for (std::size_t k = 0; k < rays.count; ++k) {
        Walk walk{plan.steps.data() + k * rays.kept(), rays.kept(), volume.row_stride(),
                  volume.slice_stride(), nullptr};
        WalkRay* const walk_one = kWalks[plan.inside[k]];
        for (std::size_t i = 0; i < count; ++i) {
            const Place& place = places[i];
            walk.windows = place.windows;
            for (std::size_t z = 0; z < kBlockZ; z += kRowsZ)
                for (std::size_t y = 0; y < kBlockY; y += kRowsY)
                    for (std::size_t x = 0; x < kBlockX; x += hn::Lanes(f))
                        walk_one(walk,
                                 place.at + x + static_cast<std::ptrdiff_t>(y) * walk.row +
                                     static_cast<std::ptrdiff_t>(z) * walk.slice,
                                 place.dark + (z * kBlockY + y) * kBlockX + x);
        }
    }
    const V open = hn::Set(f, rays.open);
    for (std::size_t i = 0; i < count; ++i) {
        const Place& place = places[i];
        const std::size_t columns = std::min(kBlockX, grid.nx - place.x);
        for (std::size_t r = 0; r < kBlock; r += hn::Lanes(f))
            hn::Store(hn::Max(hn::Zero(f), hn::Sub(open, hn::Load(f, place.dark + r))), f, place.dark + r);
        for (std::size_t z = 0; z < std::min(kBlockZ, grid.nz - place.z); ++z)
            for (std::size_t y = 0; y < std::min(kBlockY, grid.ny - place.y); ++y)
                std::copy_n(place.dark + (z * kBlockY + y) * kBlockX, columns,
                            job.visibility + grid.index(place.x, place.y + y, place.z + z));
    }
}

#else
void local(const LocalJob& job, const Tile& tile) {
    local_reference(job, tile);
}
#endif

}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::volume {

HWY_EXPORT(local);

LocalFunction* local_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(local), targets, &local_reference);
}

LocalPlan::LocalPlan(std::pmr::memory_resource* memory, const LocalRays& from, const OpacityVolume& volume)
    : rays(&from), steps(memory), inside(memory) {
    steps.reserve(from.steps.size());
    inside.reserve(from.count);
    for (std::size_t k = 0; k < from.count; ++k) {
        std::uint8_t axes = 0;
        for (const RayStep& step : from.ray(k)) {
            const auto& [x, y, z] = step.offset;
            steps.push_back({x + y * volume.row_stride() + z * volume.slice_stride(),
                             volume.occupied().window_offset(step.offset),
                             {step.fraction[0], step.fraction[1], step.fraction[2]},
                             step.weight});
            for (unsigned axis = 0; axis < 3; ++axis)
                if (step.fraction[axis] != 0) axes = static_cast<std::uint8_t>(axes | 1u << axis);
        }
        inside.push_back(axes);
    }
}

void compute_local(dfield_context* context, const LocalJob& job) {
    const Grid& grid = job.opacity->grid();
    const std::size_t nx = (grid.nx + kTileX - 1) / kTileX, ny = (grid.ny + kTileY - 1) / kTileY,
                      nz = (grid.nz + kTileZ - 1) / kTileZ;
    LocalFunction* const local = local_function(*context, *job.plan->rays);
    context->for_ranges(nx * ny * nz, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            local(job, {static_cast<std::uint32_t>(i % nx * kTileX),
                        static_cast<std::uint32_t>(i / nx % ny * kTileY),
                        static_cast<std::uint32_t>(i / (nx * ny) * kTileZ), ~0u});
    });
}

}  // namespace dfield::runtime::volume
#endif
