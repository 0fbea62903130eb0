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

// A ray's steps up to the first one that may differ are the same in both volumes.
template<bool kX, bool kY, bool kZ>
void exchange_ray(const Walk& now, const Walk& before, std::size_t differs, const float* HWY_RESTRICT at_now,
                  const float* HWY_RESTRICT at_before, float* HWY_RESTRICT gains) {
    const F f;
    Lanes lanes;
    begin(lanes);
    if (!walk_steps<kX, kY, kZ, false>(now, at_now, 0, differs, lanes)) return;
    Lanes was = lanes;
    walk_steps<kX, kY, kZ, false>(before, at_before, differs, before.count, was);
    walk_steps<kX, kY, kZ, false>(now, at_now, differs, now.count, lanes);
    for (std::size_t z = 0; z < kRowsZ; ++z)
        for (std::size_t y = 0; y < kRowsY; ++y) {
            float* const gain = gains + (z * kBlockY + y) * kBlockX;
            const V more = hn::Sub(hn::Round(was.dark[z][y]), hn::Round(lanes.dark[z][y]));
            hn::Store(hn::Add(hn::Load(f, gain), more), f, gain);
        }
}

using ExchangeRay = void(const Walk& now, const Walk& before, std::size_t differs, const float* HWY_RESTRICT,
                         const float* HWY_RESTRICT, float* HWY_RESTRICT gains);
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
        const std::uint8_t* const differs = job.differs->window(x, y, z);
        std::uint16_t first[kMostExchanged];  // step of each ray; all of them where there is none
        std::size_t work = 0, run = 0;
        for (std::size_t k = 0; k < rays.count; ++k) {
            while (run < plan.run_ends[k] && !differs[plan.runs[run].window]) ++run;
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
        Walk now{nullptr, rays.per_ray, job.now->row_stride(), job.now->slice_stride(),
                 job.now->occupied().window(x, y, z)};
        Walk before = now;
        before.windows = job.before->occupied().window(x, y, z);
        const float *const at_now = job.now->row(y, z) + x, *const at_before = job.before->row(y, z) + x;
        for (std::size_t k = 0; k < rays.count; ++k) {
            if (first[k] == rays.per_ray) continue;
            now.steps = before.steps = plan.steps.data() + k * rays.per_ray;
            for_row_groups(now.row, now.slice, [&](std::ptrdiff_t at, std::size_t row) {
                kExchanges[plan.inside[k]](now, before, first[k], at_now + at, at_before + at, gains + row);
            });
        }
        const V quantum = hn::Set(f, plan.quantum);
        for (std::size_t r = 0; r < kBlock; r += hn::Lanes(f))
            hn::Store(hn::Mul(hn::Load(f, gains + r), quantum), f, gains + r);
        const std::size_t columns = std::min(kBlockX, grid.nx - x);
        for (std::size_t k = 0; k < std::min(kBlockZ, grid.nz - z); ++k)
            for (std::size_t j = 0; j < std::min(kBlockY, grid.ny - y); ++j) {
                const float* const gain = gains + (k * kBlockY + j) * kBlockX;
                const std::size_t at = grid.index(x, y + j, z + k);
                for (std::size_t i = 0; i < columns; ++i)
                    job.visibility[at + i] = job.unclipped[at + i] + gain[i];
            }
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
