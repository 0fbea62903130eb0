// Local ambient occlusion whose far samples stand for three.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/local_approximate.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd.hpp"
#include "volume/local_kernel-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {

void local_approximate(const LocalJob& job, const Tile& tile) {
#if HWY_TARGET != HWY_SCALAR
    local_of_tile<true>(job, tile);
#else
    local_reference(job, tile);
#endif
}

}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::volume {

HWY_EXPORT(local_approximate);

LocalFunction* local_approximate_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(local_approximate), targets, &local_reference);
}

}  // namespace dfield::runtime::volume
#endif
