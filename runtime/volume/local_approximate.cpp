// Local ambient occlusion whose far samples stand for two or four: of blocks, and of groups of blocks in the
// air, every second row and slice.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/local_approximate.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd.hpp"
#include "volume/local_air.hpp"
#include "volume/local_kernel-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR

struct NearlyOne : One {
    static constexpr std::size_t kCheck = kNearlyCheck;
    static constexpr float kOpaque = kNearlyOpaque;
    static constexpr bool kRestIsTaken = true;
};
// That stands for 2^kDoublings.
template<int kDoublings>
struct Some : NearlyOne {
    static HWY_INLINE void take(const LocalPlan::Step& step, V opacity, V& light, V& dark) {
        const F f;
        V pass = hn::Sub(hn::Set(f, 1.0f), opacity);
        for (int i = 0; i < kDoublings; ++i) pass = hn::Mul(pass, pass);
        const V left = hn::Mul(light, pass), taken = hn::Sub(light, left);
        light = left;
        dark = hn::MulAdd(taken, hn::NegMulAdd(hn::Set(f, step.slope), pass, hn::Set(f, step.weight)), dark);
    }
};

// The rows of a group: a block's, two rows and two slices apart. They share nothing.
struct Apart {
    static std::uint8_t occupied(const Walk& walk, std::size_t i) {
        const std::uint8_t* const window = walk.windows + walk.steps[i].window;
        return window[0] | window[walk.next_y] | window[walk.next_z] | window[walk.next_y + walk.next_z];
    }
    template<bool kX, bool kY, bool kZ, class Sample>
    HWY_INLINE void take(const Walk& walk, const float* HWY_RESTRICT at, std::size_t i, Lanes& lanes) const {
        const F f;
        const LocalPlan::Step& step = walk.steps[i];
        const V fx = hn::Set(f, step.fraction[0]), fy = hn::Set(f, step.fraction[1]),
                fz = hn::Set(f, step.fraction[2]);
        const auto along_y = [&](const float* p) HWY_ATTR {
            if constexpr (kY) return lerp(along_x<kX>(p, fx), along_x<kX>(p + walk.row, fx), fy);
            return along_x<kX>(p, fx);
        };
#pragma GCC unroll 8
        for (std::size_t z = 0; z < kRowsZ; ++z)
#pragma GCC unroll 8
            for (std::size_t y = 0; y < kRowsY; ++y) {
                const float* HWY_RESTRICT p = at + step.offset +
                                              static_cast<std::ptrdiff_t>(2 * y) * walk.row +
                                              static_cast<std::ptrdiff_t>(2 * z) * walk.slice;
                V opacity = along_y(p);
                if constexpr (kZ) opacity = lerp(opacity, along_y(p + walk.slice), fz);
                Sample::take(step, opacity, lanes.light[z][y], lanes.dark[z][y]);
            }
    }
};

template<class Where, bool kX, bool kY, bool kZ>
void walk_groups(const Walk& walk, const float* HWY_RESTRICT at, bool whole, float* HWY_RESTRICT sums) {
    const std::size_t ones = walk.groups.ones, twos = ones + walk.groups.twos;
    Lanes lanes;
    begin(lanes);
    if (walk_steps<kX, kY, kZ, NearlyOne, Where>(walk, at, 0, ones, lanes) &&
        walk_steps<kX, kY, kZ, Some<1>, Where>(walk, at, ones, twos, lanes))
        walk_steps<kX, kY, kZ, Some<2>, Where>(walk, at, twos, walk.count, lanes);
    add_lost(lanes, whole, sums);
}

template<class Where>
constexpr WalkRays kWalks{walk_groups<Where, false, false, false>, walk_groups<Where, true, false, false>,
                          walk_groups<Where, false, true, false>,  walk_groups<Where, true, true, false>,
                          walk_groups<Where, false, false, true>,  walk_groups<Where, true, false, true>,
                          walk_groups<Where, false, true, true>,   walk_groups<Where, true, true, true>};

void local_approximate(const LocalJob& job, const Tile& tile) {
    local_of_tile(job, tile, kWalks<Throughout>);
}

void local_air(const LocalJob& job, const Tile& tile) {
    Corners corners;
    for_groups(job.opacity->grid(), tile,
               [&](std::uint32_t blocks, std::size_t x, std::size_t y, std::size_t z) {
                   if (tile.blocks & blocks) corners.add(x, y, z);
               });
    walk_blocks<2>(job, corners, kWalks<Apart>);
}

#else
void local_approximate(const LocalJob& job, const Tile& tile) {
    local_reference(job, tile);
}
void local_air(const LocalJob& job, const Tile& tile) {
    local_air_reference(job, tile);
}
#endif

}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::volume {

HWY_EXPORT(local_approximate);
HWY_EXPORT(local_air);

LocalFunction* local_approximate_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(local_approximate), targets, &local_reference);
}
LocalFunction* local_air_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(local_air), targets, &local_air_reference);
}

}  // namespace dfield::runtime::volume
#endif
