#include "volume/local_air.hpp"

#include <algorithm>

namespace dfield::runtime::volume {
namespace {

// A row between `low` and `high`, from those beside them as well: what cubic polynomials have there. These
// are rows [0, n) of the grid's; where there is no third one to a side, its neighbour stands for it.
template<class Row>
void interpolate_row(std::size_t at, std::size_t n, std::size_t count, const Row& row) {
    const float *const low = row(at - 1), *const high = row(at + 1),
                       *const lower = at >= 3 ? row(at - 3) : low,
                       *const higher = at + 3 < n ? row(at + 3) : high;
    float* const out = row(at);
    for (std::size_t i = 0; i < count; ++i)
        out[i] = 0.5625f * (low[i] + high[i]) - 0.0625f * (lower[i] + higher[i]);
}

}  // namespace

Air::Air(dfield_context* context, const LocalRays& rays, const OpacityVolume& volume)
    : grid_(volume.grid()), blocks_(tile_count(volume.grid()), 0u, context) {
    // Nearer to matter than this factors are not smooth enough.
    const std::size_t clear = rays.groups.ones;
    std::pmr::vector<Offset> offsets(context);
    for (std::size_t k = 0; k < rays.count; ++k)
        for (const RayStep& step : rays.ray(k).first(clear)) offsets.push_back(step.offset);
    std::pmr::vector<std::uint32_t> near(blocks_.size(), 0u, context);
    Stencil(context, volume.occupied(), offsets).mark(context, grid_, volume.occupied(), 1, near);
    for (std::size_t i = 0; i < blocks_.size(); ++i)
        for_groups(grid_, tile_at(grid_, i), [&](std::uint32_t group, auto, auto, auto) {
            if (!(near[i] & group)) blocks_[i] |= group;
        });
}

template<class Use>
void Air::for_air(dfield_context* context, const Use& use) const {
    context->for_ranges(blocks_.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            if (blocks_[i] != 0) {
                for_groups(grid_, tile_at(grid_, i),
                           [&](std::uint32_t blocks, std::size_t x, std::size_t y, std::size_t z) {
                               if (blocks_[i] & blocks) use(x, y, z);
                           });
            }
    });
}

void Air::interpolate(dfield_context* context, float* visibility) const {
    const Grid& grid = grid_;
    // Even rows of even slices are there everywhere.
    for_air(context, [&](std::size_t x, std::size_t y, std::size_t z) {
        for (std::size_t k = z; k < z + kGroupZ; k += 2)
            for (std::size_t j = y + 1; j < y + kGroupY; j += 2)
                interpolate_row(j, grid.ny, std::min(kBlockX, grid.nx - x),
                                [&](std::size_t at) { return visibility + grid.index(x, at, k); });
    });
    // Now all rows of even slices are.
    for_air(context, [&](std::size_t x, std::size_t y, std::size_t z) {
        for (std::size_t k = z + 1; k < z + kGroupZ; k += 2)
            for (std::size_t j = y; j < y + kGroupY; ++j)
                interpolate_row(k, grid.nz, std::min(kBlockX, grid.nx - x),
                                [&](std::size_t at) { return visibility + grid.index(x, j, at); });
    });
}

}  // namespace dfield::runtime::volume
