// Contexts that count what is allocated through their hooks.
#pragma once

#include <cstddef>
#include <new>

#include "dfield/dfield.h"

namespace dfield::test {

inline dfield_context_desc counting_hooks(std::size_t& allocations) {
    dfield_context_desc hooks{};
    hooks.struct_size = sizeof hooks;
    hooks.user = &allocations;
    hooks.allocate = [](void* user, std::size_t size, std::size_t alignment) -> void* {
        ++*static_cast<std::size_t*>(user);
        return ::operator new (size, std::align_val_t{alignment});
    };
    hooks.deallocate = [](void*, void* memory, std::size_t, std::size_t alignment) {
        ::operator delete (memory, std::align_val_t{alignment});
    };
    return hooks;
}

}  // namespace dfield::test
