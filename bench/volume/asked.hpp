// What the project asks of sweeping, as data: every measured figure is printed beside it.
#pragma once

#include <span>

#include "bench/common/asked.hpp"

namespace dfield::volumes {

struct Asked {
    const char* figure;  // where among the figures, a JSON pointer that begins with the piece
    const char* what;
    bench::Bound bound;
    const char* needs;  // why it may be missing
};
std::span<const Asked> asked();

}  // namespace dfield::volumes
