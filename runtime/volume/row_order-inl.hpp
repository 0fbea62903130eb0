// The neighbour in y of a vector of rows. Included once a target.
#if defined(DFIELD_VOLUME_ROW_ORDER_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_VOLUME_ROW_ORDER_INL_HPP
#undef DFIELD_VOLUME_ROW_ORDER_INL_HPP
#else
#define DFIELD_VOLUME_ROW_ORDER_INL_HPP
#endif

#include <hwy/highway.h>

#include "volume/layout-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

using I32 = hn::RebindToSigned<F>;
using VI = hn::Vec<I32>;

// Lane l of a vector of rows follows lane l - 1 (upward) or l + 1; the lane that comes from another group is
// filled in.
template<bool kUpward>
class RowOrder {
  public:
    HWY_INLINE RowOrder()
        : turn(hn::IndicesFromVec(F(),
                                  hn::And(hn::Add(hn::Iota(I32(), 0), hn::Set(I32(), kUpward ? kN - 1 : 1)),
                                          hn::Set(I32(), kN - 1)))),
          entering(hn::RebindMask(F(), hn::Eq(hn::Iota(I32(), 0), hn::Set(I32(), kUpward ? 0 : kN - 1)))) {}

    // The previous row's values, given this vector's predecessor. Its last lane leaves for the next group.
    HWY_INLINE VF previous_row(VF last, float* leaves, const float* enters) const {
        const VF turned = hn::TableLookupLanes(last, turn);
        *leaves = hn::GetLane(kUpward ? turned : last);
        return hn::IfThenElse(entering, hn::Set(F(), *enters), turned);
    }

  private:
    static constexpr std::int32_t kN = kLanes;
    decltype(hn::IndicesFromVec(F(), VI())) turn;
    hn::Mask<F> entering;
};

using I16 = hn::Repartition<std::int16_t, F>;
using VH = hn::Vec<I16>;

// The same for a vector of twice as many rows of 16-bit numbers: row l in the lower half of lane l, row
// l + kLanes in the upper half.
template<bool kUpward>
class HalvesOrder {
  public:
    HWY_INLINE HalvesOrder()
        : turn_(hn::IndicesFromVec(I32(),
                                   hn::And(hn::Add(hn::Iota(I32(), 0), hn::Set(I32(), kUpward ? kN - 1 : 1)),
                                           hn::Set(I32(), kN - 1)))),
          at_turn_(hn::Eq(hn::Iota(I32(), 0), hn::Set(I32(), kUpward ? 0 : kN - 1))),
          entering_(hn::Eq(hn::Iota(I16(), 0), hn::Set(I16(), kUpward ? 0 : 2 * kN - 1))) {}

    HWY_INLINE VH previous_row(VH last, std::int16_t* leaves, const std::int16_t* enters) const {
        const VI turned = hn::TableLookupLanes(hn::BitCast(I32(), last), turn_);
        // In the lane that turned from one end to the other, one half goes on to the other half's rows.
        if constexpr (kUpward) {
            *leaves = static_cast<std::int16_t>(hn::GetLane(turned) >> 16);
            return enter(hn::IfThenElse(at_turn_, hn::ShiftLeft<16>(turned), turned), *enters);
        } else {
            *leaves = hn::GetLane(last);
            return enter(hn::IfThenElse(at_turn_, hn::ShiftRight<16>(turned), turned), *enters);
        }
    }

  private:
    HWY_INLINE VH enter(VI rows, std::int16_t value) const {
        return hn::IfThenElse(entering_, hn::Set(I16(), value), hn::BitCast(I16(), rows));
    }
    static constexpr std::int32_t kN = kLanes;
    decltype(hn::IndicesFromVec(I32(), VI())) turn_;
    hn::Mask<I32> at_turn_;
    hn::Mask<I16> entering_;
};

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
