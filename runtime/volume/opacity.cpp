#include "volume/opacity.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace dfield::runtime::volume {
namespace {

constexpr std::size_t kBrick[3] = {kBrickX, kBrickY, kBrickZ};

template<class Type>
void look_up(const std::byte* samples, std::size_t begin, std::size_t end, const float* table, float* out) {
    constexpr auto kLowest = static_cast<std::int32_t>(std::numeric_limits<Type>::min());
    for (std::size_t x = begin; x < end; ++x) {
        Type value;
        std::memcpy(&value, samples + x * sizeof value, sizeof value);
        *out++ = table[static_cast<std::int32_t>(value) - kLowest];
    }
}

}  // namespace

OpacityFunction::OpacityFunction(std::pmr::memory_resource* memory, std::span<const Point> points,
                                 float exponent, SampleType type)
    : points_(points.begin(), points.end(), memory), exponent_(exponent), type_(type), table_(memory) {
    const auto tabulate = [&](std::int32_t low, std::int32_t high) {
        for (std::int32_t value = low; value <= high; ++value)
            table_.push_back((*this)(static_cast<float>(value)));
    };
    if (type == SampleType::kU8) tabulate(0, 255);
    if (type == SampleType::kI8) tabulate(-128, 127);
    if (type == SampleType::kU16) tabulate(0, 65535);
    if (type == SampleType::kI16) tabulate(-32768, 32767);
}

float OpacityFunction::operator()(float value) const {
    const auto above = std::upper_bound(points_.begin(), points_.end(), value,
                                        [](float v, const Point& point) { return v < point.value; });
    float opacity;
    if (above == points_.begin()) {
        opacity = above->opacity;
    } else if (above == points_.end()) {
        opacity = points_.back().opacity;
    } else {
        const Point &low = *(above - 1), &high = *above;
        opacity = low.opacity + (value - low.value) / (high.value - low.value) * (high.opacity - low.opacity);
    }
    return exponent_ == 1 ? opacity : 1 - std::pow(1 - opacity, exponent_);
}

bool OpacityFunction::row(const std::byte* samples, std::size_t begin, std::size_t end, float* out) const {
    switch (type_) {
        case SampleType::kU8:
            look_up<std::uint8_t>(samples, begin, end, table_.data(), out);
            return true;
        case SampleType::kI8:
            look_up<std::int8_t>(samples, begin, end, table_.data(), out);
            return true;
        case SampleType::kU16:
            look_up<std::uint16_t>(samples, begin, end, table_.data(), out);
            return true;
        case SampleType::kI16:
            look_up<std::int16_t>(samples, begin, end, table_.data(), out);
            return true;
        case SampleType::kF32:
            break;
    }
    bool finite = true;
    for (std::size_t x = begin; x < end; ++x) {
        const float value = Samples::at<float>(samples, x);
        finite = finite && std::isfinite(value);
        *out++ = (*this)(value);
    }
    return finite;
}

BrickFlags::BrickFlags(dfield_context* context, const Grid& grid, const Offset& low, const Offset& high) {
    const std::size_t voxels[3] = {grid.nx, grid.ny, grid.nz}, block[3] = {kBlockX, kBlockY, kBlockZ};
    std::size_t all[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        n_[axis] = (voxels[axis] + kBrick[axis] - 1) / kBrick[axis];
        farthest_[axis] = static_cast<std::int32_t>(voxels[axis] + 2 * kBlockX);
        const auto bricks = [&](std::int32_t reach) {
            return static_cast<std::size_t>(std::min(reach, farthest_[axis])) / kBrick[axis];
        };
        // Five bricks for windows that begin before the first brick; one for rounding down.
        before_[axis] = bricks(-low[axis]) + 6;
        all[axis] =
            before_[axis] + round_up(voxels[axis], block[axis]) / kBrick[axis] + bricks(high[axis]) + 6;
    }
    row_ = static_cast<std::ptrdiff_t>(all[0]);
    slice_ = static_cast<std::ptrdiff_t>(all[0] * all[1]);
    size_ = all[0] * all[1] * all[2];
    bricks_ = Buffer<std::uint8_t>(context, size_, 0);
    windows_ = Buffer<std::uint8_t>(context, size_, 0);
}

Offset BrickFlags::window_step(const Offset& offset) const {
    Offset step;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int32_t at = std::clamp(offset[axis], -farthest_[axis], farthest_[axis]);
        const auto brick = static_cast<std::int32_t>(kBrick[axis]);
        step[axis] = at >= 0 ? at / brick : -((-at + brick - 1) / brick);  // rounds down
    }
    return step;
}

std::ptrdiff_t BrickFlags::window_offset(const Offset& offset) const {
    const auto [x, y, z] = window_step(offset);
    return x + y * row_ + z * slice_;
}

void BrickFlags::clear(std::uint8_t bits) const {
    const auto others = static_cast<std::uint8_t>(~bits);
    const std::size_t size = size_;  // no flag is part of it, which a compiler cannot know
    for (std::uint8_t* const flags : {bricks_.get(), windows_.get()})
        for (std::size_t i = 0; i < size; ++i) flags[i] &= others;
}

bool BrickFlags::bounds(std::uint8_t bits, std::size_t low[3], std::size_t high[3]) const {
    std::copy_n(n_, 3, low);
    std::fill_n(high, 3, std::size_t{0});
    for (std::size_t z = 0; z < n_[2]; ++z)
        for (std::size_t y = 0; y < n_[1]; ++y) {
            const std::uint8_t *const row = brick(0, y, z), *const end = row + n_[0];
            std::uint8_t all = 0;
            for (const std::uint8_t* flag = row; flag < end; ++flag) all |= *flag;
            if (!(all & bits)) continue;
            const auto set = [&](std::uint8_t flag) { return (flag & bits) != 0; };
            const auto first = static_cast<std::size_t>(std::find_if(row, end, set) - row);
            std::size_t last = n_[0];
            while (!set(row[last - 1])) --last;
            const std::size_t from[3] = {first, y, z}, to[3] = {last, y + 1, z + 1};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], from[axis]);
                high[axis] = std::max(high[axis], to[axis]);
            }
        }
    return high[0] > 0;
}

void BrickFlags::update_windows() const {
    const std::size_t low[3] = {0, 0, 0};
    update_windows(low, n_);
}

void BrickFlags::update_windows(const std::size_t low[3], const std::size_t high[3]) const {
    // Windows [low - (4, 1, 1), high).
    for (std::size_t z = low[2] + before_[2] - 1; z < high[2] + before_[2]; ++z)
        for (std::size_t y = low[1] + before_[1] - 1; y < high[1] + before_[1]; ++y) {
            const auto first = static_cast<std::ptrdiff_t>(low[0] + before_[0] - 4);
            const auto count = static_cast<std::ptrdiff_t>(high[0] - low[0]) + 4;
            const std::uint8_t* const from = bricks_ + (first + static_cast<std::ptrdiff_t>(y) * row_ +
                                                        static_cast<std::ptrdiff_t>(z) * slice_);
            std::uint8_t* const to = windows_ + (first + static_cast<std::ptrdiff_t>(y) * row_ +
                                                 static_cast<std::ptrdiff_t>(z) * slice_);
            const auto column = [&](std::ptrdiff_t x) {
                return static_cast<std::uint8_t>(from[x] | from[x + row_] | from[x + slice_] |
                                                 from[x + row_ + slice_]);
            };
            for (std::ptrdiff_t x = 0; x < count; ++x)
                to[x] = column(x) | column(x + 1) | column(x + 2) | column(x + 3) | column(x + 4);
        }
}

OpacityVolume::OpacityVolume(dfield_context* context, const Grid& grid, const Offset& low, const Offset& high,
                             std::size_t together)
    : grid_(grid), occupied_(context, grid, low, high) {
    const std::size_t pad_y = together * kPadY, pad_z = together * kPadZ;
    const std::size_t row = odd_lines(round_up(grid.nx, kBrickX) + kPadX),
                      slice = odd_lines(row * (round_up(grid.ny, kBrickY) + pad_y));
    row_ = static_cast<std::ptrdiff_t>(row);
    slice_ = static_cast<std::ptrdiff_t>(slice);
    static_assert(kPadX % 16 == 0, "rows begin on a cache line's border");
    // A slice's padding, and a row's, come before it; the last ones are followed by their own.
    const std::size_t first_row = pad_y * row + kPadX, slices = round_up(grid.nz, kBrickZ) + 2 * pad_z,
                      all = slices * slice + first_row;
    origin_ = static_cast<std::ptrdiff_t>(pad_z * slice + first_row);
    values_ = Buffer<float>(context, all);
    // Around the grid alone: the rest is written when the volume is filled. By all threads, since they touch
    // all pages of the memory by it.
    float* const values = values_.get();
    context->for_ranges(slices, [&](std::size_t begin, std::size_t end) {
        for (std::size_t z = begin; z < end; ++z) {
            float* at = values + z * slice;
            float* const next = at + slice;
            if (z >= pad_z && z - pad_z < grid.nz) {
                std::fill_n(at, first_row, 0.0f);
                at += first_row;
                for (std::size_t y = 0; y < grid.ny; ++y, at += row)
                    std::fill(at + grid.nx, at + std::min<std::ptrdiff_t>(row_, next - at), 0.0f);
            }
            if (at < next) std::fill(at, next, 0.0f);
        }
    });
    std::fill(values + slices * slice, values + all, 0.0f);
}

void OpacityVolume::update_occupied(dfield_context* context, const std::size_t low[3],
                                    const std::size_t high[3]) {
    std::size_t first[3], end[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (low[axis] >= high[axis]) return;
        first[axis] = low[axis] / kBrick[axis];
        end[axis] = (high[axis] + kBrick[axis] - 1) / kBrick[axis];
    }
    context->for_ranges(end[2] - first[2], [&](std::size_t from, std::size_t to) {
        for (std::size_t bz = first[2] + from; bz < first[2] + to; ++bz)
            for (std::size_t by = first[1]; by < end[1]; ++by) {
                std::uint8_t* const flags = occupied_.brick(0, by, bz);
                std::fill(flags + first[0], flags + end[0], std::uint8_t{0});
                for (std::size_t z = bz * kBrickZ; z < std::min((bz + 1) * kBrickZ, grid_.nz); ++z)
                    for (std::size_t y = by * kBrickY; y < std::min((by + 1) * kBrickY, grid_.ny); ++y) {
                        const float* const values = row(y, z);
                        for (std::size_t bx = first[0]; bx < end[0]; ++bx) {
                            const float* const v = values + bx * kBrickX;  // beyond the grid: padding, 0
                            flags[bx] = static_cast<std::uint8_t>(
                                flags[bx] | ((v[0] != 0) | (v[1] != 0) | (v[2] != 0) | (v[3] != 0)));
                        }
                    }
            }
    });
    occupied_.update_windows(first, end);
}

bool fill_opacity(dfield_context* context, const Samples& samples, const OpacityFunction& function,
                  OpacityVolume& volume) {
    const Grid& grid = volume.grid();
    std::atomic<bool> finite{true};
    context->for_ranges(grid.ny * grid.nz, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const std::size_t y = row % grid.ny, z = row / grid.ny;
            if (!function.row(samples.row(y, z), 0, grid.nx, volume.row(y, z)))
                finite.store(false, std::memory_order_relaxed);
        }
    });
    const std::size_t low[3] = {0, 0, 0}, high[3] = {grid.nx, grid.ny, grid.nz};
    volume.update_occupied(context, low, high);
    return finite.load(std::memory_order_relaxed);
}

}  // namespace dfield::runtime::volume
