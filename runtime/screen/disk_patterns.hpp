// Where the samples of a pattern lie in a lattice, kept for the next pixels that have the same pattern.
#pragma once

#include <array>
#include <cstdint>

#include "screen/estimate.hpp"
#include "screen/lattice.hpp"

namespace dfield::runtime::screen {

// The place in the lattice of some samples of a pattern, from pixels of one class, and their distances in
// pixels of a row.
struct Offsets {
    static constexpr std::uint32_t kMost = 16;

    // Of samples [first, first + count): `key` says of which pattern.
    void make(const Lattice& lattice, const DiskSample* samples, std::uint32_t number, const Pattern& pattern,
              std::int32_t x, std::int32_t y);

    std::uint64_t key = ~std::uint64_t{0};
    std::uint32_t count = 0;
    std::int32_t left = 0, right = 0, up = 0, down = 0;  // the farthest columns and rows of a class's picture
    struct Offset {
        std::int32_t columns, rows;  // of a class's picture
        std::int32_t index;          // in the lattice, from pixel (0, 0) of one's own picture
        float x, y, distance2;       // y upwards
        float weight;
    };
    std::array<Offset, kMost> offsets;
};

// Of the 16 or more patterns next to each other that the rows of a thread have.
class OffsetCache {
  public:
    OffsetCache(const Lattice& lattice, const SampleSets<DiskSample>& sets, float aspect)
        : lattice_(lattice), sets_(sets), aspect_(aspect) {}

    // Samples [first, first + kMost) of the pattern with this radius, for the pixels at (x, y) of a square.
    const Offsets& get(float radius, std::int32_t x, std::int32_t y, std::uint32_t first) {
        const std::uint32_t bits = std::bit_cast<std::uint32_t>(radius) >> Pattern::kDropped;
        const auto place = static_cast<std::uint32_t>(y * lattice_.side + x);
        const std::uint64_t key = (std::uint64_t{bits} << 32 | first) << 8 | place;
        Offsets& slot = slots_[(bits << 4 ^ place ^ first / Offsets::kMost) % kSlots];
        if (slot.key != key) make(slot, key, radius, x, y, first);
        return slot;
    }

  private:
    static constexpr std::size_t kSlots = 256;
    void make(Offsets& slot, std::uint64_t key, float radius, std::int32_t x, std::int32_t y,
              std::uint32_t first);

    const Lattice& lattice_;
    const SampleSets<DiskSample>& sets_;
    const float aspect_;
    std::array<Offsets, kSlots> slots_;
};

}  // namespace dfield::runtime::screen
