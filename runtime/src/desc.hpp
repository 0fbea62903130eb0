// Create-structs of callers that were compiled against an older header.
#pragma once

#include <cstddef>
#include <cstring>
#include <initializer_list>

#include "status.hpp"

namespace dfield::runtime {

// An older version's struct: its sizeof, and the bytes of it that hold members (what follows is padding).
struct OlderDesc {
    std::size_t size, used;
};

// The caller's struct as this version has it: members that it does not know of are zero. Refuses other sizes.
template<class Desc>
Desc read_desc(const Desc* given, std::initializer_list<OlderDesc> older, const char* message) {
    Desc desc{};
    std::size_t used = given->struct_size == sizeof(Desc) ? sizeof(Desc) : 0;
    for (const OlderDesc& version : older)
        if (given->struct_size == version.size) used = version.used;
    require(used > 0, message);
    std::memcpy(&desc, given, used);
    return desc;
}

}  // namespace dfield::runtime
