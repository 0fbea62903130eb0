// What clipping changes of a block's rays: only those that meet a voxel that is not what it was are walked,
// as the volume is and as it was, and their sums exchanged. In whole quanta nothing is lost by that.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/local_exchange.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd.hpp"
#include "volume/local_kernel-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR

// What was there before: where it may differ it is in a box, elsewhere as it is now.
struct Before {
    const std::uint8_t* differs;  // the block's window, of flags
    const RayStep* steps;         // the ray's
    const float* at;              // the voxel that a walk's `at` is, in the box
    std::ptrdiff_t row, slice;    // of the box

    std::uint8_t occupied(const Walk& walk, std::size_t i) const {
        const std::ptrdiff_t window = walk.steps[i].window;
        static_assert(kDiffers == 1, "as windows that are occupied");
        return static_cast<std::uint8_t>(walk.windows[window] | (differs[window] & kDiffers));
    }
    template<bool kX, bool kY, bool kZ, class Sample>
    HWY_INLINE void take(const Walk& walk, const float* HWY_RESTRICT now, std::size_t i, Lanes& lanes) const {
        const LocalPlan::Step& step = walk.steps[i];
        const Offset& offset = steps[i].offset;
        const bool other = differs[step.window] & kDiffers;
        take_sample<kX, kY, kZ, Sample>(
            step, other ? at + (offset[0] + offset[1] * row + offset[2] * slice) : now + step.offset,
            other ? row : walk.row, other ? slice : walk.slice, lanes);
    }
};

// A ray's steps up to the first one that may differ are the same in both volumes.
template<bool kX, bool kY, bool kZ>
void exchange_ray(const Walk& walk, const float* HWY_RESTRICT at, std::size_t differs, const Before& before,
                  float* HWY_RESTRICT gains) {
    const F f;
    Lanes lanes;
    begin(lanes);
    if (!walk_steps<kX, kY, kZ>(walk, at, 0, differs, lanes)) return;
    Lanes was = lanes;
    walk_steps<kX, kY, kZ, One>(walk, at, differs, walk.count, was, before);
    walk_steps<kX, kY, kZ>(walk, at, differs, walk.count, lanes);
    for (std::size_t z = 0; z < kRowsZ; ++z)
        for (std::size_t y = 0; y < kRowsY; ++y) {
            float* const gain = gains + (z * kBlockY + y) * kBlockX;
            const V more = hn::Sub(hn::Round(was.dark[z][y]), hn::Round(lanes.dark[z][y]));
            hn::Store(hn::Add(hn::Load(f, gain), more), f, gain);
        }
}

using ExchangeRay = void(const Walk& walk, const float* HWY_RESTRICT at, std::size_t differs,
                         const Before& before, float* HWY_RESTRICT gains);
constexpr ExchangeRay* kExchanges[] = {exchange_ray<false, false, false>, exchange_ray<true, false, false>,
                                       exchange_ray<false, true, false>,  exchange_ray<true, true, false>,
                                       exchange_ray<false, false, true>,  exchange_ray<true, false, true>,
                                       exchange_ray<false, true, true>,   exchange_ray<true, true, true>};

std::uint32_t exchange(const ExchangeJob& job, const Tile& tile) {
    const F f;
    const LocalPlan& plan = *job.plan;
    const LocalRays& rays = *plan.rays;
    const Grid& grid = job.now->grid();
    HWY_ALIGN float gains[kBlock];
    std::uint32_t left = 0;
    for_blocks(grid, tile, [&](std::size_t bit, std::size_t x, std::size_t y, std::size_t z) {
        const std::uint8_t* const differs = job.flags->window(x, y, z);
        std::uint16_t first[kMostExchanged];  // step of each ray; all of them where there is none
        std::size_t work = 0, run = 0;
        for (std::size_t k = 0; k < rays.count; ++k) {
            while (run < plan.run_ends[k] && !(differs[plan.runs[run].window] & kDiffers)) ++run;
            const std::size_t i = run < plan.run_ends[k] ? plan.runs[run].first : rays.per_ray;
            first[k] = static_cast<std::uint16_t>(i);
            if (i < rays.per_ray) work += 2 * rays.per_ray - i;
            run = plan.run_ends[k];
        }
        if (work > rays.count * rays.per_ray) {
            left |= 1u << bit;
            return;
        }
        std::fill_n(gains, kBlock, 0.0f);
        Walk walk(rays, *job.now);
        walk.windows = job.now->occupied().window(x, y, z);
        const float *const now = job.now->row(y, z) + x, *const was =
                                                             job.before->at(static_cast<std::ptrdiff_t>(x),
                                                                            static_cast<std::ptrdiff_t>(y),
                                                                            static_cast<std::ptrdiff_t>(z));
        Before before{differs, nullptr, nullptr, job.before->row_stride(), job.before->slice_stride()};
        for (std::size_t k = 0; k < rays.count; ++k) {
            if (first[k] == rays.per_ray) continue;
            walk.steps = plan.steps.data() + k * rays.per_ray;
            before.steps = rays.ray(k).data();
            for_rows([&](std::ptrdiff_t gx, std::ptrdiff_t gy, std::ptrdiff_t gz, std::size_t row) {
                before.at = was + (gx + gy * before.row + gz * before.slice);
                kExchanges[plan.inside[k]](walk, now + (gx + gy * walk.row + gz * walk.slice), first[k],
                                           before, gains + row);
            });
        }
        const V quantum = hn::Set(f, plan.quantum);
        for (std::size_t r = 0; r < kBlock; r += hn::Lanes(f))
            hn::Store(hn::Mul(hn::Load(f, gains + r), quantum), f, gains + r);
        for (std::size_t i = 0; i < kBlock; ++i) gains[i] += job.unclipped[bit][i];
        store_block(grid, x, y, z, gains, job.visibility);
    });
    return left;
}

#else
std::uint32_t exchange(const ExchangeJob&, const Tile& tile) {
    return tile.blocks;
}
#endif

}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::volume {

HWY_EXPORT(exchange);

ExchangeFunction* exchange_function(const dfield_context& context, const LocalRays& rays) {
    if (rays.jitter.most > 0 || rays.count > kMostExchanged) return nullptr;
    return pick(HWY_DISPATCH_TABLE(exchange), context.simd_targets, static_cast<ExchangeFunction*>(nullptr));
}

}  // namespace dfield::runtime::volume
#endif
