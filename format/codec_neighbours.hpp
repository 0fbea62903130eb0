// What the encoder and the decoder of all sections share: neighbouring maps, the unpacked hit mask, folded
// words. Integers only, so every machine decodes the same. FORMAT.md, "Codec", is normative.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "format/field.hpp"

namespace dfield::codec {

// A map's neighbours among the maps before it, by index.
struct Neighbours {
    static constexpr std::uint32_t kNone = 0xffffffff;
    std::uint32_t previous = kNone;  // on the same ring
    std::uint32_t above = kNone;     // nearest in azimuth on the ring before
    std::uint32_t beside = kNone;    // second nearest there
};

// Of point j of a ring of `size` points from index `first` on, whose ring before it starts at index `before`
// (first = 0: there is none).
constexpr Neighbours ring_neighbours(std::uint32_t before, std::uint32_t first, std::uint32_t size,
                                     std::uint32_t j) {
    Neighbours n;
    if (j > 0) n.previous = first + j - 1;
    if (first == 0) return n;
    // Azimuth j / size of a turn is place j * count / size on the ring before; a half rounds up.
    const std::uint32_t count = first - before;
    const std::uint32_t nearest = (2 * j * count + size) / (2 * size);
    const bool rounded_up = nearest * size > j * count;
    n.above = before + nearest % count;
    n.beside = before + (nearest + (rounded_up ? count - 1 : 1)) % count;
    return n;
}

std::pmr::vector<Neighbours> position_neighbours(const FieldParameters& parameters,
                                                 std::pmr::memory_resource* memory);

// The unpacked hit mask: one bit a texel, 1 = hit, least significant bit first; every row of every map starts
// on a byte, padding is 0.
struct MaskLayout {
    explicit MaskLayout(const FieldParameters& p)
        : map_size(p.map_size),
          row_bytes((p.map_size + 7) / 8),
          plane_bytes(position_count(p) * p.map_size * row_bytes) {}
    std::uint32_t map_size;
    std::size_t row_bytes;
    std::uint64_t plane_bytes;
    std::size_t row_at(std::size_t map, std::size_t t) const { return (map * map_size + t) * row_bytes; }
};

// Tables of 16 bit words. Mean depth is predicted by its neighbours' mean, self visibility by the vertex
// before.
inline std::uint16_t predict_mean_depth(std::span<const std::uint16_t> values, const Neighbours& n) {
    const bool previous = n.previous != Neighbours::kNone, above = n.above != Neighbours::kNone;
    if (previous && above) return static_cast<std::uint16_t>((values[n.previous] + values[n.above] + 1) / 2);
    return previous ? values[n.previous] : above ? values[n.above] : std::uint16_t{0};
}
constexpr std::uint16_t fold_word(std::uint16_t value, std::uint16_t prediction) {
    const auto e = static_cast<std::uint16_t>(value - prediction);
    return static_cast<std::uint16_t>(e << 1 ^ (e >> 15 != 0 ? 0xffff : 0));
}
constexpr std::uint16_t unfold_word(std::uint16_t folded, std::uint16_t prediction) {
    return static_cast<std::uint16_t>(prediction + (folded >> 1 ^ ((folded & 1) != 0 ? 0xffff : 0)));
}

}  // namespace dfield::codec
