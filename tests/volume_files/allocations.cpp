#include "tests/volume_files/allocations.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

std::size_t dfield::test::largest_allocation = 0;

void* operator new(std::size_t size) {
    using dfield::test::largest_allocation;
    largest_allocation = std::max(largest_allocation, size);
    if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
    throw std::bad_alloc();
}
void* operator new(std::size_t size,
                   const std::nothrow_t&) noexcept {  // or the sanitizer's own would be used
    return std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
