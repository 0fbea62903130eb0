#include "screen/disk_patterns.hpp"

namespace dfield::runtime::screen {

void Offsets::make(const Lattice& lattice, const DiskSample* samples, std::uint32_t number,
                   const Pattern& pattern, std::int32_t x, std::int32_t y) {
    count = number;
    left = right = up = down = 0;
    // Into pictures of the lattice and the place in the square. What lies outside from everywhere is no
    // farther away than that needs, so that indices stay small.
    const auto split = [&](std::int32_t from, float by, std::int32_t most, std::int32_t& rest) {
        constexpr float kFar = 0x1p24f;
        const std::int32_t at = from + static_cast<std::int32_t>(std::clamp(by, -kFar, kFar));
        const std::int32_t whole = at >= 0 ? at / lattice.side : -((lattice.side - 1 - at) / lattice.side);
        rest = at - whole * lattice.side;
        return std::clamp(whole, -most, most);
    };
    const float aspect = pattern.radius_x / pattern.radius_y;
    for (std::uint32_t i = 0; i < count; ++i) {
        Offset& o = offsets[i];
        const float columns = pattern.columns(samples[i]), rows = pattern.rows(samples[i]);
        std::int32_t to_x = 0, to_y = 0;
        o.columns = split(x, columns, lattice.width + 2 * Lattice::kBorder, to_x);
        o.rows = split(y, rows, lattice.height + 2, to_y);
        o.index = static_cast<std::int32_t>(lattice.index(to_x, to_y, o.columns, o.rows));
        o.x = columns;
        o.y = -rows * aspect;
        o.distance2 = o.x * o.x + o.y * o.y;
        o.weight = samples[i].weight;
        left = std::min(left, o.columns);
        right = std::max(right, o.columns);
        up = std::min(up, o.rows);
        down = std::max(down, o.rows);
    }
}

void OffsetCache::make(Offsets& slot, std::uint64_t key, float radius, std::int32_t x, std::int32_t y,
                       std::uint32_t first) {
    slot.key = key;
    const DiskSample* const samples =
        sets_.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)) + first;
    slot.make(lattice_, samples, std::min(Offsets::kMost, sets_.count - first), Pattern(radius, aspect_), x,
              y);
}

}  // namespace dfield::runtime::screen
