#include "volume/stencil.hpp"

#include <algorithm>

namespace dfield::runtime::volume {

Stencil::Stencil(std::pmr::memory_resource* memory, const BrickFlags& flags, std::span<const Offset> offsets)
    : words_(memory) {
    std::pmr::vector<std::ptrdiff_t> windows(memory);
    windows.reserve(offsets.size());
    for (const Offset& offset : offsets) windows.push_back(flags.window_offset(offset));
    std::sort(windows.begin(), windows.end());
    for (const std::ptrdiff_t window : windows) {
        if (words_.empty() || window >= words_.back().offset + 8) words_.push_back({window, 0});
        const std::uint8_t set = 0xff;
        std::memcpy(reinterpret_cast<std::uint8_t*>(&words_.back().mask) + (window - words_.back().offset),
                    &set, 1);
    }
    // Near windows are met more often.
    std::stable_sort(words_.begin(), words_.end(),
                     [](const Word& a, const Word& b) { return std::abs(a.offset) < std::abs(b.offset); });
}

}  // namespace dfield::runtime::volume
