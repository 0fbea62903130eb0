// Moves results near the surface off it (move_off_surface of occlusion.hpp), in place. Included once a
// target.
#if defined(DFIELD_VOLUME_OFF_SURFACE_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_VOLUME_OFF_SURFACE_INL_HPP
#undef DFIELD_VOLUME_OFF_SURFACE_INL_HPP
#else
#define DFIELD_VOLUME_OFF_SURFACE_INL_HPP
#endif

#include <hwy/highway.h>

#include <cmath>

#include "volume/buffer.hpp"
#include "volume/occlusion.hpp"
#include "volume/row_gradient-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

class OffSurface {
  public:
    OffSurface(const Grid& grid, const float* distance, float* visibility)
        : grid_(grid),
          distance_(distance),
          visibility_(visibility),
          offset_(kImprovedOffset * grid.h()),
          deepest_(-kImprovedDepth * grid.h()) {}

    void run(dfield_context* context) const {
        // The new values of the voxels near the surface wait in a list until all have been read.
        const std::size_t rows = grid_.ny * grid_.nz;
        Buffer<std::size_t> first(context, rows + 1, 0);  // of each row in the list
        const auto for_rows = [&](const auto& body) {
            context->for_ranges(rows, [&](std::size_t begin, std::size_t end) {
                for (std::size_t row = begin; row < end; ++row)
                    body(row % grid_.ny, row / grid_.ny, first + row);
            });
        };
        for_rows([this](std::size_t y, std::size_t z, std::size_t* at) { at[1] = count(y, z); });
        for (std::size_t row = 0; row < rows; ++row) first.get()[row + 1] += first.get()[row];
        Buffer<float> moved(context, first.get()[rows]);
        for_rows([&](std::size_t y, std::size_t z, std::size_t* at) { move(y, z, moved + *at); });
        for_rows([&](std::size_t y, std::size_t z, std::size_t* at) { put(y, z, moved + *at); });
    }

  private:
    template<class Tag>
    HWY_INLINE hn::Mask<Tag> is_near(Tag tag, hn::Vec<Tag> d) const {
        return hn::And(hn::Ge(d, hn::Set(tag, deepest_)), hn::Lt(d, hn::Set(tag, offset_)));
    }

    std::size_t count(std::size_t y, std::size_t z) const {
        std::size_t result = 0;
        const RowGradient row(grid_, distance_, y, z);
        row.for_vertices([&](auto tag, std::size_t x) HWY_ATTR {
            result += hn::CountTrue(tag, is_near(tag, hn::LoadU(tag, row.here() + x)));
        });
        return result;
    }

    void put(std::size_t y, std::size_t z, const float* moved) const {
        const std::size_t first = grid_.index(0, y, z);
        for (std::size_t i = first; i < first + grid_.nx; ++i)
            if (distance_[i] >= deepest_ && distance_[i] < offset_) visibility_[i] = *moved++;
    }

    void move(std::size_t y, std::size_t z, float* moved) const {
        const RowGradient row(grid_, distance_, y, z);
        row.for_vertices([&](auto tag, std::size_t x) HWY_ATTR {
            const auto d = hn::LoadU(tag, row.here() + x);
            const auto chosen = is_near(tag, d);
            if (hn::AllFalse(tag, chosen)) return;
            const auto g = row.at(tag, x);
            const auto some = hn::Gt(g.square, hn::Zero(tag));
            const auto step = hn::Min(hn::Sub(hn::Set(tag, offset_), d), hn::Set(tag, 2 * offset_));
            const auto scale = hn::IfThenElseZero(some, hn::Div(step, hn::Sqrt(g.square)));
            const auto from = [&](std::size_t at, auto along, float h) HWY_ATTR {  // in voxels
                return hn::MulAdd(hn::IfThenElseZero(some, hn::Mul(along, scale)), hn::Set(tag, 1 / h),
                                  hn::Set(tag, static_cast<float>(at)));
            };
            // Few lanes of a vector are near, and gathers are no faster than loads: one by one from here.
            HWY_ALIGN float px[kLanes], py[kLanes], pz[kLanes];
            // Compressing straight to memory is slow on some processors.
            hn::Store(hn::Compress(hn::Add(from(x, g.x, grid_.hx), hn::Iota(tag, 0)), chosen), tag, px);
            hn::Store(hn::Compress(from(y, g.y, grid_.hy), chosen), tag, py);
            hn::Store(hn::Compress(from(z, g.z, grid_.hz), chosen), tag, pz);
            const std::size_t n = hn::CountTrue(tag, chosen);
            for (std::size_t i = 0; i < n; ++i) *moved++ = blend(px[i], py[i], pz[i]);
        });
    }

    // Trilinear, at a point in voxels.
    HWY_INLINE float blend(float x, float y, float z) const {
        struct Axis {
            std::size_t low, step;  // offset of the lower corner, and from there to the upper
            float fraction;
        };
        const auto axis = [](float at, std::size_t n, std::size_t stride) {
            const float inside = std::min(std::max(at, 0.0f), static_cast<float>(n - 1));
            const std::size_t low =
                std::min(static_cast<std::size_t>(static_cast<std::int32_t>(inside)), n > 1 ? n - 2 : 0);
            return Axis{low * stride, n > 1 ? stride : 0, inside - static_cast<float>(low)};
        };
        const Axis ax = axis(x, grid_.nx, 1), ay = axis(y, grid_.ny, grid_.nx),
                   az = axis(z, grid_.nz, grid_.nx * grid_.ny);
        const float* const corner = visibility_ + ax.low + ay.low + az.low;
        const auto along_x = [&](const float* p) { return p[0] + ax.fraction * (p[ax.step] - p[0]); };
        const auto along_y = [&](const float* p) {
            const float low = along_x(p);
            return low + ay.fraction * (along_x(p + ay.step) - low);
        };
        const float low = along_y(corner);
        return low + az.fraction * (along_y(corner + az.step) - low);
    }

    const Grid grid_;
    const float* const distance_;
    float* const visibility_;
    const float offset_, deepest_;
};

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
