// Local ambient occlusion by the vectorised kernel, and how its rays are laid out.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/local.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd.hpp"
#include "volume/local_kernel-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {

void local(const LocalJob& job, const Tile& tile) {
#if HWY_TARGET != HWY_SCALAR
    constexpr WalkRays kWalks{walk_ray<false, false, false>, walk_ray<true, false, false>,
                              walk_ray<false, true, false>,  walk_ray<true, true, false>,
                              walk_ray<false, false, true>,  walk_ray<true, false, true>,
                              walk_ray<false, true, true>,   walk_ray<true, true, true>};
    local_of_tile(job, tile, kWalks);
#else
    local_reference(job, tile);
#endif
}

}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cmath>

#include "volume/local_air.hpp"

namespace dfield::runtime::volume {

HWY_EXPORT(local);

LocalFunction* local_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(local), targets, &local_reference);
}

LocalPlan::LocalPlan(std::pmr::memory_resource* memory, const LocalRays& from, const OpacityVolume& volume)
    : rays(&from),
      steps(memory),
      inside(memory),
      runs(memory),
      run_ends(memory),
      whole(from.count <= kMostExchanged) {
    // 2^24 quanta are what is open, or more: floats hold them all.
    int exponent = 0;
    if (std::frexp(from.open, &exponent) == 0.5f) --exponent;
    exponent = std::max(exponent - 24, -100);
    quantum = std::ldexp(1.0f, exponent);
    const float per_quantum = std::ldexp(1.0f, -exponent);
    open = from.open * per_quantum;
    steps.reserve(from.steps.size());
    inside.reserve(from.count);
    for (std::size_t k = 0; k < from.count; ++k) {
        std::uint8_t axes = 0;
        for (const RayStep& step : from.ray(k)) {
            const auto& [x, y, z] = step.offset;
            steps.push_back({x + y * volume.row_stride() + z * volume.slice_stride(),
                             volume.occupied().window_offset(step.offset),
                             {step.fraction[0], step.fraction[1], step.fraction[2]},
                             step.weight * per_quantum,
                             step.slope * per_quantum});
            for (unsigned axis = 0; axis < 3; ++axis)
                if (step.fraction[axis] != 0) axes = static_cast<std::uint8_t>(axes | 1u << axis);
        }
        inside.push_back(axes);
        const std::size_t begin = run_ends.empty() ? 0 : run_ends.back();
        for (std::size_t i = 0; i < from.per_ray; ++i) {
            const std::ptrdiff_t window = steps[k * from.per_ray + i].window;
            if (runs.size() == begin || runs.back().window != window)
                runs.push_back({window, static_cast<std::uint32_t>(i)});
        }
        run_ends.push_back(runs.size());
    }
}

void compute_local(dfield_context* context, const LocalJob& job) {
    const Grid& grid = job.opacity->grid();
    LocalFunction* const local = local_function(*context, *job.plan->rays);
    const auto for_tiles = [&](const auto& use) {
        context->for_ranges(tile_count(grid), [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) use(i, tile_at(grid, i));
        });
    };
    if (!job.plan->rays->approximate) {
        for_tiles([&](std::size_t, const Tile& tile) { local(job, tile); });
        return;
    }
    LocalFunction* const local_air = local_air_function(context->simd_targets);
    const Air air(context, *job.plan->rays, *job.opacity);
    for_tiles([&](std::size_t i, Tile tile) {
        const std::uint32_t in_air = air.blocks(i);
        tile.blocks = ~in_air;
        local(job, tile);
        tile.blocks = in_air;
        if (in_air != 0) local_air(job, tile);
    });
    air.interpolate(context, job.visibility);
}

}  // namespace dfield::runtime::volume
#endif
