// Allocator hooks that know how much was held at most.
#pragma once

#include <atomic>
#include <cstdlib>

#include "dfield/dfield.h"

namespace dfield::bench {

struct Meter {
    std::atomic<std::size_t> held{0}, peak{0};

    dfield_context_desc hooks() {
        dfield_context_desc desc{};
        desc.user = this;
        desc.allocate = [](void* user, std::size_t size, std::size_t alignment) {
            Meter& meter = *static_cast<Meter*>(user);
            const std::size_t now = meter.held += size;
            for (std::size_t peak = meter.peak; now > peak && !meter.peak.compare_exchange_weak(peak, now);)
                ;
            return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
        };
        desc.deallocate = [](void* user, void* memory, std::size_t size, std::size_t) {
            static_cast<Meter*>(user)->held -= size;
            std::free(memory);
        };
        return desc;
    }
};

}  // namespace dfield::bench
