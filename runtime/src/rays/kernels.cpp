// The ray kernels with Highway. reference.cpp says what they compute.
#include "rays/kernels.hpp"

#include <algorithm>

#include "simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rays/kernels.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target
#include <hwy/highway.h>

#include "rays/line_kernels-inl.hpp"
#include "rays/map_kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

const RayLookups& lookups_of_target() {
    static constexpr RayLookups kLookups{
        {maps_any_hits, maps_distances, maps_ray_any_hits, maps_ray_distances},
        {lines_any_hits, lines_distances, lines_ray_any_hits, lines_ray_distances}};
    return kLookups;
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime {
namespace {

const RayLookups& reference_lookups() {
    return kRayLookupsReference;
}

}  // namespace

HWY_EXPORT(lookups_of_target);

const RayLookups& ray_lookups(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(lookups_of_target), targets, &reference_lookups)();
}

}  // namespace dfield::runtime
#endif
