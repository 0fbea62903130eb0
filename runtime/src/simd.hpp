// Which compiled form of a kernel a context calls. Kernels are written once with Google Highway and compiled
// for SSE4, AVX2, AVX-512 (AVX3) and NEON; the choice is the context's own (dfield_context_desc.simd), never
// Highway's process-wide one, so two contexts in one process may run at different levels.
//
// A kernel's file, runtime/src/blur.cpp, declared in blur.hpp as a plain function
// `void blur(float* x, size_t n)`:
//
//     #undef HWY_TARGET_INCLUDE
//     #define HWY_TARGET_INCLUDE "blur.cpp"  // relative to an include directory, such as runtime/src
//     #include <hwy/foreach_target.h>        // compiles the file once a target
//     #include <hwy/highway.h>               // after foreach_target.h
//     #include "simd.hpp"                    // headers with include guards are seen by the first target
//                                            // alone: nothing in them may depend on the target
//     HWY_BEFORE_NAMESPACE();
//     namespace dfield::runtime::HWY_NAMESPACE {
//     void blur(float* x, std::size_t n) { ... }
//     }
//     HWY_AFTER_NAMESPACE();
//     #if HWY_ONCE
//     namespace dfield::runtime {
//     HWY_EXPORT(blur);
//     void blur_scalar(float* x, std::size_t n) { ... }   // the reference: reads like the paper
//     BlurFunction* blur_kernel(std::int64_t targets) {    // targets: dfield_context::simd_targets
//         return pick(HWY_DISPATCH_TABLE(blur), targets, &blur_scalar);
//     }
//     }
//     #endif
//
// The file is compiled for HWY_SCALAR too (one lane); that form is never picked. An operation that one lane
// cannot do goes behind `#if HWY_TARGET != HWY_SCALAR`. Choose once a call, not once a receiver.
#pragma once

#include <hwy/targets.h>

#include <cstddef>
#include <cstdint>

#include "dfield/dfield.h"

namespace dfield::runtime {

// Highway's targets that a cap lets run on this processor, 0 for none (the scalar references). Asks the
// processor, which takes microseconds in a virtual machine: called once, when the context is made. A cap of
// another processor family allows none.
inline std::int64_t allowed_targets(dfield_simd cap) {
    constexpr auto from = [](std::int64_t best, std::int64_t family) { return family & ~(best - 1); };
    // Lower bits are better targets.
    constexpr std::int64_t kX86 = (std::int64_t{1} << (HWY_HIGHEST_TARGET_BIT_X86 + 1)) - 1, kNeon = HWY_NEON;
    const std::int64_t supported = hwy::SupportedTargets() & (kX86 | kNeon);
    switch (cap) {
        case DFIELD_SIMD_BEST:
            return supported;
        case DFIELD_SIMD_SSE4:
            return supported & from(HWY_SSE4, kX86);
        case DFIELD_SIMD_AVX2:
            return supported & from(HWY_AVX2, kX86);
        case DFIELD_SIMD_AVX512:
            return supported & from(HWY_AVX3_DL, kX86);
        case DFIELD_SIMD_NEON:
            return supported & kNeon;
        default:
            return 0;
    }
}

// The best kernel of a table made by HWY_EXPORT among `targets`, or `reference` where none of them is
// compiled.
template<class Function, std::size_t kEntries>
Function* pick(Function* const (&table)[kEntries], std::int64_t targets, Function* reference) {
    if (!(targets & HWY_TARGETS & ~(HWY_SCALAR | HWY_EMU128))) return reference;
    if constexpr (kEntries == 1) return table[0];  // compiled for one target only
    hwy::ChosenTarget chosen;
    chosen.Update(targets & HWY_TARGETS);
    return table[chosen.GetIndex()];
}

}  // namespace dfield::runtime
