#include "context.hpp"

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "desc.hpp"
#include "status.hpp"

void* dfield_context::do_allocate(std::size_t size, std::size_t alignment) {
    void* memory = hooks.allocate ? hooks.allocate(hooks.user, size, alignment)
                                  : ::operator new (size, std::align_val_t{alignment}, std::nothrow);
    if (!memory) throw std::bad_alloc();
    return memory;
}

void dfield_context::do_deallocate(void* memory, std::size_t size, std::size_t alignment) {
    if (hooks.deallocate)
        hooks.deallocate(hooks.user, memory, size, alignment);
    else
        ::operator delete (memory, std::align_val_t{alignment});
}

void dfield_context::release() noexcept {
    if (references.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    // The context lies in the memory of its own hooks: copy them out before it ends.
    const dfield_context_desc copy = hooks;
    this->~dfield_context();
    if (copy.deallocate)
        copy.deallocate(copy.user, this, sizeof(dfield_context), alignof(dfield_context));
    else
        ::operator delete (this, std::align_val_t{alignof(dfield_context)});
}

namespace {
constexpr const char* kSimdNames[] = {"the best", "none (scalar)", "SSE4",
                                      "AVX2",     "AVX-512",       "NEON"};  // by dfield_simd
}

extern "C" {

dfield_status dfield_context_create(const dfield_context_desc* desc, dfield_context** context) {
    return dfield::runtime::guarded([&] {
        using dfield::runtime::require;
        require(context, "dfield_context_create: context is null");
        dfield_context_desc hooks{};
        if (desc) {
            constexpr std::size_t kSize01 = offsetof(dfield_context_desc, log);
            hooks = dfield::runtime::read_desc(
                desc, {{kSize01, kSize01}},
                "dfield_context_create: desc->struct_size is of no known version; header and library are of "
                "different versions, or the field was not set");
            require(!hooks.allocate == !hooks.deallocate,
                    "dfield_context_create: set both allocate and deallocate, or neither");
            require(hooks.simd <= DFIELD_SIMD_NEON, "dfield_context_create: unknown simd level");
        }
        void* memory = hooks.allocate
                           ? hooks.allocate(hooks.user, sizeof(dfield_context), alignof(dfield_context))
                           : ::operator new (sizeof(dfield_context),
                                             std::align_val_t{alignof(dfield_context)}, std::nothrow);
        if (!memory) throw std::bad_alloc();
        auto* const made = new (memory) dfield_context(hooks);
        *context = made;
        const dfield_simd level = dfield_context_get_simd(made);
        char line[160];
        std::snprintf(line, sizeof line, "dfield %d.%d.%d, instruction set: %s", DFIELD_VERSION_MAJOR,
                      DFIELD_VERSION_MINOR, DFIELD_VERSION_PATCH, kSimdNames[level]);
        made->log(DFIELD_LOG_INFO, line);
        if (hooks.simd != DFIELD_SIMD_BEST && level != static_cast<dfield_simd>(hooks.simd)) {
            std::snprintf(line, sizeof line,
                          "this machine has no %s: queries run at %s; cap at DFIELD_SIMD_BEST",
                          kSimdNames[hooks.simd], kSimdNames[level]);
            made->log(DFIELD_LOG_WARNING, line);
        }
    });
}

dfield_simd dfield_context_get_simd(const dfield_context* context) {
    if (!context) return DFIELD_SIMD_SCALAR;
    const std::int64_t compiled = context->simd_targets & HWY_TARGETS;
    const std::int64_t best = compiled & -compiled;  // lower bits are better targets
    if (best == HWY_AVX3 || best == HWY_AVX3_DL) return DFIELD_SIMD_AVX512;
    if (best == HWY_AVX2) return DFIELD_SIMD_AVX2;
    if (best == HWY_SSE4) return DFIELD_SIMD_SSE4;
    return best == HWY_NEON ? DFIELD_SIMD_NEON : DFIELD_SIMD_SCALAR;
}

void dfield_context_release(dfield_context* context) {
    if (context) context->release();
}
}
