// What clipping changes of a block's rays: only those that meet a voxel that is not what it was are walked,
// as the volume is and as it was, and their sums exchanged. In whole quanta nothing is lost by that.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/local_exchange.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cstring>

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

// The first step of each ray that may differ; where there is none, the number of steps.
using Firsts = std::array<std::uint16_t, kMostExchanged>;
constexpr std::size_t kTileBlocks = kTileBlocksX * kTileBlocksY * kTileBlocksZ;

// Of the wanted ones of kTileBlocksX blocks side by side; of the others there is none.
void find_firsts(const LocalPlan& plan, const std::uint8_t* differs, std::uint32_t wanted, Firsts* firsts) {
    // A run's windows of all four blocks, kBlockX / kBrickX apart, with one load of two words.
    static_assert(kTileBlocksX == 4 && kBlockX / kBrickX == 4);
    std::uint8_t bytes[16] = {};
    for (std::size_t b = 0; b < kTileBlocksX; ++b)
        if (wanted >> b & 1) bytes[4 * b] = kDiffers;
    std::uint64_t all[2];
    std::memcpy(all, bytes, sizeof all);
    const auto none = static_cast<std::uint16_t>(plan.rays->per_ray);
    std::size_t run = 0;
    for (std::size_t k = 0; k < plan.rays->count; ++k) {
        for (std::size_t b = 0; b < kTileBlocksX; ++b) firsts[b][k] = none;
        std::uint64_t open[2] = {all[0], all[1]};
        for (; run < plan.run_ends[k]; ++run) {
            std::uint64_t found[2];
            std::memcpy(found, differs + plan.runs[run].window, sizeof found);
            found[0] &= open[0];
            found[1] &= open[1];
            if ((found[0] | found[1]) == 0) continue;
            std::memcpy(bytes, found, sizeof found);
            for (std::size_t b = 0; b < kTileBlocksX; ++b)
                if (bytes[4 * b]) firsts[b][k] = static_cast<std::uint16_t>(plan.runs[run].first);
            open[0] &= ~found[0];
            open[1] &= ~found[1];
            if ((open[0] | open[1]) == 0) break;
        }
        run = plan.run_ends[k];
    }
}

// A block whose rays are exchanged.
struct Exchanged {
    std::size_t bit, x, y, z;
    const std::uint8_t *occupied, *differs;  // its windows
    const float *now, *was;                  // its lowest voxel
};

// Ray by ray, so that what a ray's steps read is at hand for all of the blocks.
std::uint32_t exchange(const ExchangeJob& job, const Tile& tile) {
    const F f;
    const LocalPlan& plan = *job.plan;
    const LocalRays& rays = *plan.rays;
    const Grid& grid = job.now->grid();
    std::array<Firsts, kTileBlocks> firsts;
    std::array<Exchanged, kTileBlocks> blocks;
    std::size_t count = 0, found = SIZE_MAX;  // the row of blocks whose firsts are known
    std::uint32_t left = 0;
    for_blocks(grid, tile, [&](std::size_t bit, std::size_t x, std::size_t y, std::size_t z) {
        if (const std::size_t row = bit / kTileBlocksX * kTileBlocksX; row != found) {
            find_firsts(plan, job.flags->window(tile.x, y, z), tile.blocks >> row, &firsts[row]);
            found = row;
        }
        std::size_t work = 0;
        for (std::size_t k = 0; k < rays.count; ++k)
            if (firsts[bit][k] < rays.per_ray) work += 2 * rays.per_ray - firsts[bit][k];
        if (work > rays.count * rays.per_ray) {
            left |= 1u << bit;
            return;
        }
        blocks[count++] = {bit,
                           x,
                           y,
                           z,
                           job.now->occupied().window(x, y, z),
                           job.flags->window(x, y, z),
                           job.now->row(y, z) + x,
                           job.before->at(static_cast<std::ptrdiff_t>(x), static_cast<std::ptrdiff_t>(y),
                                          static_cast<std::ptrdiff_t>(z))};
    });
    HWY_ALIGN float gains[kTileBlocks * kBlock];
    std::fill_n(gains, count * kBlock, 0.0f);
    Walk walk(rays, *job.now);
    for (std::size_t k = 0; k < rays.count; ++k) {
        walk.steps = plan.steps.data() + k * rays.per_ray;
        ExchangeRay* const exchange_one = kExchanges[plan.inside[k]];
        for (std::size_t i = 0; i < count; ++i) {
            const Exchanged& block = blocks[i];
            const std::size_t first = firsts[block.bit][k];
            if (first == rays.per_ray) continue;
            walk.windows = block.occupied;
            Before before{block.differs, rays.ray(k).data(), nullptr, job.before->row_stride(),
                          job.before->slice_stride()};
            for_rows([&](std::ptrdiff_t gx, std::ptrdiff_t gy, std::ptrdiff_t gz, std::size_t row) {
                before.at = block.was + (gx + gy * before.row + gz * before.slice);
                exchange_one(walk, block.now + (gx + gy * walk.row + gz * walk.slice), first, before,
                             gains + i * kBlock + row);
            });
        }
    }
    const V quantum = hn::Set(f, plan.quantum);
    for (std::size_t i = 0; i < count; ++i) {
        const Exchanged& block = blocks[i];
        float* const factors = gains + i * kBlock;
        const float* const unclipped = job.unclipped[block.bit];
        for (std::size_t r = 0; r < kBlock; r += hn::Lanes(f)) {
            const V gain = hn::Mul(hn::Load(f, factors + r), quantum);
            hn::Store(hn::Add(hn::LoadU(f, unclipped + r), gain), f, factors + r);
        }
        store_block(grid, block.x, block.y, block.z, factors, job.visibility);
    }
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
