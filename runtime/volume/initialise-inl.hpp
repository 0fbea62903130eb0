// The rows of the initial distance field (reference_distance.cpp says what is computed), in the order of the
// volume. Included once a target.
#if defined(DFIELD_VOLUME_INITIALISE_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_VOLUME_INITIALISE_INL_HPP
#undef DFIELD_VOLUME_INITIALISE_INL_HPP
#else
#define DFIELD_VOLUME_INITIALISE_INL_HPP
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "volume/layout-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

// How vectors of a type of sample are read as floats.
template<class Type>
struct Load {
    static HWY_INLINE VF at(const std::byte* row, std::size_t x) {
        const hn::Rebind<Type, F> narrow;
        const hn::Rebind<std::int32_t, F> wide;
        const auto values = hn::LoadU(narrow, reinterpret_cast<const Type*>(row) + x);
        return hn::ConvertTo(F(), hn::PromoteTo(wide, values));
    }
};
template<>
struct Load<float> {
    static HWY_INLINE VF at(const std::byte* row, std::size_t x) {
        return hn::LoadU(F(), reinterpret_cast<const float*>(row) + x);
    }
};

// A row of samples less the isovalue; the ends repeat once. False where one is not finite.
template<class Type>
HWY_INLINE bool load_row(const std::byte* row, std::size_t n, float isovalue, float* HWY_RESTRICT out) {
    const F f;
    const VF iso = hn::Set(f, isovalue), limit = hn::Set(f, 3.4e38f);
    auto finite = hn::Eq(iso, iso);
    bool all_finite = true;
    const auto vector = [&](std::size_t x) HWY_ATTR {
        const VF v = hn::Sub(Load<Type>::at(row, x), iso);
        if constexpr (std::is_same_v<Type, float>) finite = hn::And(finite, hn::Le(hn::Abs(v), limit));
        hn::StoreU(v, f, out + x);
    };
    if (n >= kLanes) {
        std::size_t x = 0;
        for (; x + kLanes <= n; x += kLanes) vector(x);
        if (x < n) vector(n - kLanes);
        all_finite = hn::AllTrue(f, finite);
    } else {
        for (std::size_t x = 0; x < n; ++x) {
            out[x] = Samples::at<Type>(row, x) - isovalue;
            all_finite = all_finite && std::abs(out[x]) <= 3.4e38f;
        }
    }
    out[-1] = out[0];
    out[n] = out[n - 1];
    return all_finite;
}

using LoadRow = bool(const std::byte* row, std::size_t n, float isovalue, float* HWY_RESTRICT out);
inline LoadRow* load_row_of(SampleType type) {
    switch (type) {
        case SampleType::kU8:
            return load_row<std::uint8_t>;
        case SampleType::kI8:
            return load_row<std::int8_t>;
        case SampleType::kU16:
            return load_row<std::uint16_t>;
        case SampleType::kI16:
            return load_row<std::int16_t>;
        default:
            return load_row<float>;
    }
}

// What a row and its neighbours say; missing neighbours are the row itself.
struct RowStencil {
    const float *here, *below_y, *above_y, *below_z, *above_z;  // below and above: smaller and larger index
    bool border_y, border_z;
};

// Distances of a row as sweeps have them (layout-inl.hpp): those of vertices on a crossing edge, kFar for
// others.
HWY_INLINE void initialise_row(const Grid& grid, const RowStencil& rows, float* HWY_RESTRICT out) {
    const F f;
    const VF zero = hn::Zero(f), far = hn::Set(f, kFar), half = hn::Set(f, 0.5f);
    const VF last = hn::Set(f, static_cast<float>(grid.nx - 1)), lanes = hn::Iota(f, 0);
    const float h = grid.h();
    const VF per_x = hn::Set(f, h / grid.hx), per_y = hn::Set(f, h / grid.hy),
             per_z = hn::Set(f, h / grid.hz);
    const VF weight_y = hn::Set(f, rows.border_y ? 1.0f : 0.5f);
    const VF weight_z = hn::Set(f, rows.border_z ? 1.0f : 0.5f);
    for (std::size_t x = 0; x < grid.nx; x += kLanes) {
        const VF here = hn::LoadU(f, rows.here + x);
        const VF x0 = hn::LoadU(f, rows.here + x - 1), x1 = hn::LoadU(f, rows.here + x + 1);
        const VF y0 = hn::LoadU(f, rows.below_y + x), y1 = hn::LoadU(f, rows.above_y + x);
        const VF z0 = hn::LoadU(f, rows.below_z + x), z1 = hn::LoadU(f, rows.above_z + x);
        const auto inside = hn::Ge(here, zero);
        const auto crosses = [&](VF there) HWY_ATTR { return hn::Xor(inside, hn::Ge(there, zero)); };
        const auto cx0 = crosses(x0), cx1 = crosses(x1), cy0 = crosses(y0), cy1 = crosses(y1),
                   cz0 = crosses(z0), cz1 = crosses(z1);
        const auto crossed = hn::Or(hn::Or(hn::Or(cx0, cx1), hn::Or(cy0, cy1)), hn::Or(cz0, cz1));
        VF result = far;
        if (!hn::AllFalse(f, crossed)) {
            const VF size = hn::Abs(here);
            const auto slope = [&](VF low, VF high, auto cross_low, auto cross_high, VF weight,
                                   VF per) HWY_ATTR {
                const VF rise = hn::Max(hn::IfThenElseZero(cross_low, hn::Abs(hn::Sub(here, low))),
                                        hn::IfThenElseZero(cross_high, hn::Abs(hn::Sub(here, high))));
                const VF tilt = hn::Min(size, hn::Mul(weight, hn::Abs(hn::Sub(high, low))));
                return hn::Mul(per, hn::IfThenElse(hn::Or(cross_low, cross_high), rise, tilt));
            };
            const VF at = hn::Add(hn::Set(f, static_cast<float>(x)), lanes);
            const auto border = hn::Or(hn::Eq(at, zero), hn::Eq(at, last));
            const VF weight_x = hn::IfThenElse(border, hn::Set(f, 1.0f), half);
            const VF sx = slope(x0, x1, cx0, cx1, weight_x, per_x);
            const VF sy = slope(y0, y1, cy0, cy1, weight_y, per_y);
            const VF sz = slope(z0, z1, cz0, cz1, weight_z, per_z);
            const VF steepness = hn::Sqrt(hn::MulAdd(sx, sx, hn::MulAdd(sy, sy, hn::Mul(sz, sz))));
            result = hn::IfThenElse(crossed, hn::Neg(hn::Div(size, steepness)), far);
        }
        const VF bit = hn::BitCast(f, hn::Set(hn::RebindToSigned<F>(), kInsideBit));
        const VF flag = hn::IfThenElseZero(inside, bit);
        hn::StoreU(select_bits(bit, flag, result), f, out + x);
    }
}

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
