// The batch kernels with Highway: one direction's map stays in registers while it meets blocks of sixteen
// receivers. reference.cpp says what they compute.
#include "batch/chunk.hpp"
#include "batch/confirm.hpp"
#include "simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "batch/kernels.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a target
#include <hwy/highway.h>

#include "batch/kernels-inl.hpp"
#include "batch/load-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

const BatchKernels& kernels_of_target() {
    static constexpr BatchKernels kKernels{load_packed, find_cells,   bound_block,      find_pairs,
                                           add_ground,  add_caster,   keep_open,        find_touched,
                                           mark_along,  add_occluded, finish_visibility};
    return kKernels;
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime {

HWY_EXPORT(kernels_of_target);

const BatchKernels& reference_kernels() {
    return kReferenceKernels;
}

const BatchKernels& batch_kernels(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(kernels_of_target), targets, &reference_kernels)();
}

}  // namespace dfield::runtime
#endif
