// Takes results near the surface a little off it, along the normal: the last mend of occlusion.hpp. Included
// once a target.
#if defined(DFIELD_VOLUME_OFF_SURFACE_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_VOLUME_OFF_SURFACE_INL_HPP
#undef DFIELD_VOLUME_OFF_SURFACE_INL_HPP
#else
#define DFIELD_VOLUME_OFF_SURFACE_INL_HPP
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "volume/occlusion.hpp"
#include "volume/row_gradient-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

class OffSurface {
  public:
    // Slices on either side that a result may come from: steps are measured in voxels.
    static constexpr std::size_t kReach = 2;
    static_assert(kImprovedOffset + kImprovedDepth < static_cast<float>(kReach));
    // Swept visibility of the slices from z - kReach to z + kReach; those outside the grid are not read.
    using Slices = std::array<const float*, 2 * kReach + 1>;

    OffSurface(const Grid& grid, const float* distance)
        : grid_(grid), distance_(distance), widest_(std::max({grid.hx, grid.hy, grid.hz})) {}

    void move_row(std::size_t y, std::size_t z, const Slices& slices, float* out) const {
        const RowGradient row(grid_, distance_, y, z);
        const float* const swept = slices[kReach] + y * grid_.nx;
        // Copies, which stores through `out` cannot change.
        const Grid grid = grid_;
        const float widest = widest_, per_hx = 1 / grid.hx, per_hy = 1 / grid.hy, per_hz = 1 / grid.hz;
        row.for_vertices([&](auto tag, std::size_t x) HWY_ATTR {
            const auto d = hn::LoadU(tag, row.here() + x), unmoved = hn::LoadU(tag, swept + x);
            const auto is_near = [&](auto h) HWY_ATTR {
                return hn::And(hn::Ge(d, hn::Mul(h, hn::Set(tag, -kImprovedDepth))),
                               hn::Lt(d, hn::Mul(h, hn::Set(tag, kImprovedOffset))));
            };
            if (hn::AllFalse(tag, is_near(hn::Set(tag, widest)))) return hn::StoreU(unmoved, tag, out + x);
            // In voxels: v = the gradient over the spacings, and |g| / |v| is the spacing along the normal.
            const auto g = row.at(tag, x);
            const auto some = hn::Gt(g.square, hn::Zero(tag));
            const auto vx = hn::Mul(g.x, hn::Set(tag, per_hx)), vy = hn::Mul(g.y, hn::Set(tag, per_hy)),
                       vz = hn::Mul(g.z, hn::Set(tag, per_hz));
            const auto inverse = hn::ApproximateReciprocalSqrt(g.square);
            const auto square = hn::MulAdd(vx, vx, hn::MulAdd(vy, vy, hn::Mul(vz, vz)));
            const auto h = grid.isotropic() ? hn::Set(tag, grid.hx) : hn::Sqrt(hn::Div(g.square, square));
            const auto chosen = hn::And(some, is_near(h));
            const auto step = hn::Mul(hn::MulSub(h, hn::Set(tag, kImprovedOffset), d), inverse);
            const auto scale = hn::IfThenElseZero(chosen, step);
            const auto moved = blend(tag, chosen, x, y, z, hn::Mul(vx, scale), hn::Mul(vy, scale),
                                     hn::Mul(vz, scale), slices);
            hn::StoreU(hn::IfThenElse(chosen, moved, unmoved), tag, out + x);
        });
    }

  private:
    // Where points lie among the voxels of an axis.
    template<class Tag>
    struct Axis {
        HWY_ALIGN std::int32_t low[hn::MaxLanes(Tag())];
        hn::Vec<Tag> fraction;
        HWY_INLINE Axis(Tag tag, hn::Vec<Tag> at, std::size_t n) {
            const hn::RebindToSigned<Tag> i32;
            const auto last = static_cast<std::int32_t>(n - 1);
            const auto inside = hn::Min(hn::Max(at, hn::Zero(tag)), hn::Set(tag, static_cast<float>(n - 1)));
            const auto cell =
                hn::Min(hn::ConvertTo(i32, inside), hn::Set(i32, std::max<std::int32_t>(last - 1, 0)));
            fraction = hn::Sub(inside, hn::ConvertTo(tag, cell));
            hn::Store(cell, i32, low);
        }
    };

    // Trilinear, shifted by so many voxels, for the lanes that are chosen; a chosen lane's shift is finite.
    template<class Tag, class V = hn::Vec<Tag>>
    HWY_INLINE V blend(Tag tag, hn::Mask<Tag> chosen, std::size_t x, std::size_t y, std::size_t z, V shift_x,
                       V shift_y, V shift_z, const Slices& slices) const {
        const auto from = [&](std::size_t at, V shift)
                              HWY_ATTR { return hn::Add(shift, hn::Set(tag, static_cast<float>(at))); };
        const Axis<Tag> ax(tag, hn::Add(from(x, shift_x), hn::Iota(tag, 0)), grid_.nx),
            ay(tag, from(y, shift_y), grid_.ny), az(tag, from(z, shift_z), grid_.nz);
        constexpr std::size_t kCount = hn::MaxLanes(Tag());
        HWY_ALIGN float along_z[kCount];
        hn::Store(az.fraction, tag, along_z);
        // The corners with the lowest and the highest x, of the lower and the upper y: blended along z one
        // lane after the other, as gathers are no faster, and then all lanes at once.
        const hn::FixedTag<float, 4> four;
        HWY_ALIGN float corners[4 * kCount] = {};
        const std::size_t step_x = grid_.nx > 1 ? 1 : 0, step_y = grid_.ny > 1 ? grid_.nx : 0,
                          step_z = grid_.nz > 1 ? 1 : 0;
        std::uint64_t lanes = 0;
        hn::StoreMaskBits(tag, chosen, reinterpret_cast<std::uint8_t*>(&lanes));
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(lanes));
            const std::size_t slice = static_cast<std::size_t>(az.low[lane]) + kReach - z;
            const std::size_t corner =
                static_cast<std::size_t>(ay.low[lane]) * grid_.nx + static_cast<std::size_t>(ax.low[lane]);
            const auto plane = [&](const float* p) HWY_ATTR {
                p += corner;
                if constexpr (kCount == 1) {
                    HWY_ALIGN const float values[4] = {p[0], p[step_x], p[step_y], p[step_y + step_x]};
                    return hn::Load(four, values);
                } else {  // between the ends of a row: two voxels side by side
                    const hn::Half<decltype(four)> two;
                    return hn::Combine(four, hn::LoadU(two, p + step_y), hn::LoadU(two, p));
                }
            };
            const auto low = plane(slices[slice]), high = plane(slices[slice + step_z]);
            hn::Store(hn::MulAdd(hn::Set(four, along_z[lane]), hn::Sub(high, low), low), four,
                      corners + 4 * lane);
        }
        V a, b, c, d;
        hn::LoadInterleaved4(tag, corners, a, b, c, d);
        const V low = hn::MulAdd(ax.fraction, hn::Sub(b, a), a),
                high = hn::MulAdd(ax.fraction, hn::Sub(d, c), c);
        return hn::MulAdd(ay.fraction, hn::Sub(high, low), low);
    }

    const Grid grid_;
    const float* const distance_;
    const float widest_;  // spacing
};

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
