#include "volume/opacity_box.hpp"

#include <algorithm>

namespace dfield::runtime::volume {
namespace {

constexpr std::size_t kBrick[3] = {kBrickX, kBrickY, kBrickZ}, kPad[3] = {kPadX, kPadY, kPadZ};
// More than is needed, so that a clip that moves does not need another box in every frame.
constexpr std::size_t kSpare[3] = {0, kBrickY, 2 * kBrickZ};

}  // namespace

void OpacityBox::cover(dfield_context* context, const OpacityVolume& clipped, const BrickFlags& flags,
                       std::uint8_t bit, const Samples& samples, const OpacityFunction& function, bool same) {
    std::size_t first[3], end[3];
    if (!flags.bounds(bit, first, end)) {
        *this = {};
        return;
    }
    const Grid& grid = clipped.grid();
    const std::size_t voxels[3] = {grid.nx, grid.ny, grid.nz};
    std::array<std::ptrdiff_t, 3> low, high, least, most;
    bool within = same && values_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto pad = static_cast<std::ptrdiff_t>(kPad[axis]),
                   spare = static_cast<std::ptrdiff_t>(kSpare[axis]);
        low[axis] = static_cast<std::ptrdiff_t>(first[axis] * kBrick[axis]) - pad;
        high[axis] = static_cast<std::ptrdiff_t>(end[axis] * kBrick[axis]) + pad;
        within = within && low[axis] >= low_[axis] && high[axis] <= high_[axis];
        // Farther out there is nothing to be read.
        least[axis] = std::max(low[axis] - spare, -pad);
        most[axis] = std::min(high[axis] + spare,
                              static_cast<std::ptrdiff_t>(round_up(voxels[axis], kBrick[axis])) + pad);
    }
    const std::size_t row = odd_lines(static_cast<std::size_t>(most[0] - least[0])),
                      slice = odd_lines(row * static_cast<std::size_t>(most[1] - least[1])),
                      all = slice * static_cast<std::size_t>(most[2] - least[2]);
    const bool fits = all <= size_ && all >= size_ / 2;
    if (within && fits) return;
    if (!fits) {
        *this = {};  // before there is another one
        values_ = Buffer<float>(context, all);
        size_ = all;
    }
    low_ = least;
    high_ = most;
    row_ = static_cast<std::ptrdiff_t>(row);
    slice_ = static_cast<std::ptrdiff_t>(slice);
    fill(context, clipped, flags, bit, samples, function);
}

void OpacityBox::fill(dfield_context* context, const OpacityVolume& clipped, const BrickFlags& flags,
                      std::uint8_t bit, const Samples& samples, const OpacityFunction& function) const {
    const Grid& grid = clipped.grid();
    const auto nx = static_cast<std::ptrdiff_t>(grid.nx), ny = static_cast<std::ptrdiff_t>(grid.ny),
               nz = static_cast<std::ptrdiff_t>(grid.nz);
    const auto brick_x = static_cast<std::ptrdiff_t>(kBrickX);
    context->for_ranges(
        static_cast<std::size_t>(high_[2] - low_[2]), [&](std::size_t begin, std::size_t end) {
            for (auto z = low_[2] + static_cast<std::ptrdiff_t>(begin);
                 z < low_[2] + static_cast<std::ptrdiff_t>(end); ++z)
                for (std::ptrdiff_t y = low_[1]; y < high_[1]; ++y) {
                    float* const out = values_ + ((y - low_[1]) * row_ + (z - low_[2]) * slice_);
                    std::copy_n(
                        clipped.row(0, 0) + low_[0] + y * clipped.row_stride() + z * clipped.slice_stride(),
                        high_[0] - low_[0], out);
                    if (y < 0 || y >= ny || z < 0 || z >= nz) continue;
                    const auto row_y = static_cast<std::size_t>(y), row_z = static_cast<std::size_t>(z);
                    const std::uint8_t* const differs = flags.brick(0, row_y / kBrickY, row_z / kBrickZ);
                    const std::ptrdiff_t to = std::min(high_[0], nx);
                    for (std::ptrdiff_t x = std::max(low_[0], std::ptrdiff_t{0}); x < to;) {
                        if (!(differs[x / brick_x] & bit)) {
                            x += brick_x;
                            continue;
                        }
                        std::ptrdiff_t last = x;
                        while (last < to && differs[last / brick_x] & bit) last += brick_x;
                        last = std::min(last, to);
                        // Finite, as the volume was when it was filled.
                        (void)function.row(samples.row(row_y, row_z), static_cast<std::size_t>(x),
                                           static_cast<std::size_t>(last), out + (x - low_[0]));
                        x = last;
                    }
                }
        });
}

}  // namespace dfield::runtime::volume
