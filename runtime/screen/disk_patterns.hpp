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
    static constexpr std::uint32_t kMost = 32;

    // Of samples [first, first + count): `key` says of which pattern.
    void make(const Lattice& lattice, const DiskSample* samples, std::uint32_t number, const Pattern& pattern,
              std::int32_t x, std::int32_t y);

    std::uint64_t key = ~std::uint64_t{0};
    std::uint32_t count = 0;
    std::int32_t left = 0, right = 0, up = 0, down = 0;  // the farthest columns and rows of a class's picture
    struct Offset {
        std::int32_t columns, rows;  // of a class's picture
        std::ptrdiff_t picture;      // of that class's first pixel, from the lattice's beginning
        std::ptrdiff_t index;        // from pixel (0, 0) of one's own picture
        float x, y, distance2;       // y upwards
        float weight;
    };
    std::array<Offset, kMost> offsets;
};

// One for each class and a few patterns: enough for the rows that a thread works on.
class OffsetCache {
  public:
    OffsetCache(const Lattice& lattice, const SampleSets<DiskSample>& sets, float aspect)
        : lattice_(lattice), sets_(sets), aspect_(aspect) {}

    // Samples [first, first + kMost) of the pattern with this radius, for the pixels at (x, y) of a square.
    const Offsets& get(float radius, std::int32_t x, std::int32_t y, std::uint32_t first);

  private:
    static constexpr std::size_t kSlots = 64;
    const Lattice& lattice_;
    const SampleSets<DiskSample>& sets_;
    const float aspect_;
    std::array<Offsets, kSlots> slots_;
};

}  // namespace dfield::runtime::screen
