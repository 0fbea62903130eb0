// The base disk with the quartic measure.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "screen/disk.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "screen/disk-inl.hpp"
#include "simd.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::screen::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET != HWY_SCALAR

// h = 2 / |r| (high - low) (2 e + b (high + low)), the factor left out.
struct Quartic {
    HWY_INLINE Quartic(const Settings&, const Lanes&) {}
    HWY_INLINE void integrals(const Lanes& p, const Offsets::Offset&, V, V e, V low, V ground, V high,
                              V& open, V& seen) const {
        const V twice = hn::Add(e, e);
        open = hn::Mul(hn::Sub(high, low), hn::MulAdd(p.slope, hn::Add(high, low), twice));
        seen = hn::Mul(hn::Sub(high, ground), hn::MulAdd(p.slope, hn::Add(high, ground), twice));
    }
    static HWY_INLINE V scale(const Lanes& p) { return hn::Div(set(2), p.sight_2); }
};

void disk(const EstimateJob& job, const Lattice& lattice, std::int32_t begin, std::int32_t end) {
    disk_rows<Quartic>(job, lattice, begin, end);
}

#else
void disk(const EstimateJob& job, const Lattice&, std::int32_t begin, std::int32_t end) {
    for (std::int32_t row = begin; row < end; ++row) estimate_reference(job, row);
}
#endif

}  // namespace dfield::runtime::screen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::screen {

HWY_EXPORT(disk);

DiskFunction* disk_function(std::int64_t targets, dfield_fuzzy_measure measure) {
    if (measure != DFIELD_MEASURE_QUARTIC) return disk_measures_function(targets);
    return pick(HWY_DISPATCH_TABLE(disk), targets, static_cast<DiskFunction*>(nullptr));
}

}  // namespace dfield::runtime::screen
#endif
