// The gradient of a dense distance field along a row: central differences, one-sided at the border. Included
// once a target.
#if defined(DFIELD_VOLUME_ROW_GRADIENT_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_VOLUME_ROW_GRADIENT_INL_HPP
#undef DFIELD_VOLUME_ROW_GRADIENT_INL_HPP
#else
#define DFIELD_VOLUME_ROW_GRADIENT_INL_HPP
#endif

#include <hwy/highway.h>

#include "volume/layout-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

template<class V>
struct Gradient {
    V x, y, z, square;
};

class RowGradient {
  public:
    RowGradient(const Grid& grid, const float* distance, std::size_t y, std::size_t z)
        : here_(distance + grid.index(0, y, z)), nx_(grid.nx), per_x_(1 / grid.hx) {
        const auto row = static_cast<std::ptrdiff_t>(grid.nx),
                   slice = static_cast<std::ptrdiff_t>(grid.nx * grid.ny);
        low_y_ = here_ - (y > 0 ? row : 0);
        high_y_ = here_ + (y + 1 < grid.ny ? row : 0);
        low_z_ = here_ - (z > 0 ? slice : 0);
        high_z_ = here_ + (z + 1 < grid.nz ? slice : 0);
        per_y_ = (y > 0 && y + 1 < grid.ny ? 0.5f : 1.0f) / grid.hy;
        per_z_ = (z > 0 && z + 1 < grid.nz ? 0.5f : 1.0f) / grid.hz;
    }
    const float* here() const { return here_; }

    // At Lanes(tag) vertices from x on, which are either one or all between the row's ends.
    template<class Tag>
    HWY_INLINE Gradient<hn::Vec<Tag>> at(Tag tag, std::size_t x) const {
        const float* const low_x = here_ + x - (x > 0 ? 1 : 0);
        const float* const high_x = here_ + x + (x + hn::Lanes(tag) < nx_ ? 1 : 0);
        const float per_x = (x > 0 && x + hn::Lanes(tag) < nx_ ? 0.5f : 1.0f) * per_x_;
        const auto slope = [&](const float* high, const float* low, float per) HWY_ATTR {
            return hn::Mul(hn::Sub(hn::LoadU(tag, high), hn::LoadU(tag, low)), hn::Set(tag, per));
        };
        Gradient<hn::Vec<Tag>> g;
        g.x = slope(high_x, low_x, per_x);
        g.y = slope(high_y_ + x, low_y_ + x, per_y_);
        g.z = slope(high_z_ + x, low_z_ + x, per_z_);
        g.square = hn::MulAdd(g.x, g.x, hn::MulAdd(g.y, g.y, hn::Mul(g.z, g.z)));
        return g;
    }

    // Calls use(tag, x) for vectors, and single vertices, that cover the row and suit at(); some vertices
    // twice.
    template<class Use>
    HWY_INLINE void for_vertices(const Use& use) const {
        const hn::CappedTag<float, 1> single;
        use(single, 0);
        std::size_t x = 1;
        for (; x + kLanes < nx_; x += kLanes) use(F(), x);
        if (x > 1 && x + 1 < nx_) {
            use(F(), nx_ - 1 - kLanes);
            x = nx_ - 1;
        }
        for (; x < nx_; ++x) use(single, x);
    }

  private:
    const float *here_, *low_y_, *high_y_, *low_z_, *high_z_;
    std::size_t nx_;
    float per_x_, per_y_, per_z_;
};

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
