// The context: the caller's hooks as a memory resource and a parallel loop, shared by everything made from
// it.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <utility>

#include "dfield/dfield.h"
#include "simd.hpp"

// Opaque handles derive from this; the last release destroys the object through its context's memory.
struct dfield_context final : std::pmr::memory_resource {
    explicit dfield_context(const dfield_context_desc& desc)
        : hooks(desc), simd_targets(dfield::runtime::allowed_targets(static_cast<dfield_simd>(desc.simd))) {}

    // Calls body(begin, end) over disjoint ranges that cover [0, count).
    template<class Body>
    void for_ranges(std::size_t count, const Body& body) const {
        if (count == 0) return;
        if (!hooks.parallel_for) return body(std::size_t{0}, count);
        hooks.parallel_for(
            hooks.user, count,
            [](void* data, std::size_t begin, std::size_t end) {
                (*static_cast<const Body*>(data))(begin, end);
            },
            const_cast<void*>(static_cast<const void*>(&body)));
    }

    void retain() noexcept { references.fetch_add(1, std::memory_order_relaxed); }
    void release() noexcept;

    // Says something to whoever set the hook; not for queries.
    void log(dfield_log_level level, const char* message) const {
        if (hooks.log) hooks.log(hooks.user, level, message);
    }

    dfield_context_desc hooks;
    const std::int64_t simd_targets;  // Highway's, that kernels may use (simd.hpp)
    std::atomic<std::size_t> references{1};

  private:
    void* do_allocate(std::size_t size, std::size_t alignment) override;
    void do_deallocate(void* memory, std::size_t size, std::size_t alignment) override;
    bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
        return this == &other;
    }
};

namespace dfield::runtime {

// Reference-counted object that lives in its context's memory and keeps the context alive.
template<class Object>
class Shared {
  public:
    explicit Shared(dfield_context* context) : context_(context) { context_->retain(); }
    Shared(const Shared&) = delete;
    Shared& operator=(const Shared&) = delete;

    template<class... Arguments>
    static Object* make(dfield_context* context, Arguments&&... arguments) {
        std::pmr::polymorphic_allocator<> allocator(context);
        return allocator.new_object<Object>(context, std::forward<Arguments>(arguments)...);
    }
    void retain() noexcept { references_.fetch_add(1, std::memory_order_relaxed); }
    void release() noexcept {
        if (references_.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
        dfield_context* context = context_;
        context->retain();  // the object's own reference goes with it, before its memory does
        std::pmr::polymorphic_allocator<>(context).delete_object(static_cast<Object*>(this));
        context->release();
    }
    dfield_context* context() const noexcept { return context_; }

  protected:
    ~Shared() { context_->release(); }

  private:
    dfield_context* context_;
    std::atomic<std::size_t> references_{1};
};

}  // namespace dfield::runtime
