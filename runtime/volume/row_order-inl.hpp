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

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
