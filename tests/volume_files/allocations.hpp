// The largest block that operator new of this executable was asked for, to hold allocations against files.
#pragma once

#include <cstddef>

namespace dfield::test {

extern std::size_t largest_allocation;

}  // namespace dfield::test
