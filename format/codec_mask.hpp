// The adaptive model of the hit mask, shared by encoder and decoder. FORMAT.md, "Hit mask", is normative.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory_resource>
#include <span>
#include <vector>

#include "format/codec_neighbours.hpp"
#include "format/range_coder.hpp"

namespace dfield::codec {

inline constexpr std::size_t kMaskContexts = 1 << 14;
inline constexpr std::uint32_t kSurroundings = kMaskContexts - 2;  // all but the texel to the west

namespace detail {

// The eight bits of every byte as bytes.
inline constexpr auto kUnpacked = [] {
    std::array<std::array<std::uint8_t, 8>, 256> table{};
    for (int byte = 0; byte < 256; ++byte)
        for (int bit = 0; bit < 8; ++bit) table[byte][bit] = static_cast<std::uint8_t>(byte >> bit & 1);
    return table;
}();

// A row of the mask with a byte a texel, followed by at least one 0.
class MaskRow {
  public:
    MaskRow(std::size_t row_bytes, std::pmr::memory_resource* memory) : texels_(8 * row_bytes + 8, memory) {}
    void load(const std::uint8_t* row) {
        const std::size_t row_bytes = texels_.size() / 8 - 1;
        for (std::size_t i = 0; i < row_bytes; ++i) std::memcpy(&texels_[8 * i], kUnpacked[row[i]].data(), 8);
    }
    void clear() { std::fill(texels_.begin(), texels_.end(), std::uint8_t{0}); }
    std::uint8_t* data() { return texels_.data(); }

  private:
    std::pmr::vector<std::uint8_t> texels_;
};

}  // namespace detail

// Calls coder.code(model, bit) for every texel in file order. A decoder gets 0 and answers the bit, which is
// put into the (zeroed) plane; an encoder gets the plane's bit and answers the same. Stops early when
// coder.failed().
template<class Coder>
void code_mask(const MaskLayout& mask, std::span<const Neighbours> neighbours, std::uint8_t* plane,
               Coder& coder, std::pmr::memory_resource* memory) {
    using detail::MaskRow;
    constexpr std::uint32_t kNone = Neighbours::kNone;
    const std::size_t m = mask.map_size;
    std::pmr::vector<BitModel> models(kMaskContexts, memory);
    std::array<BitModel, 2> agreement;
    std::pmr::vector<std::uint16_t> contexts(m, memory);
    // Copies of pmr containers would leave `memory`.
    const auto empty_row = [&] { return MaskRow(mask.row_bytes, memory); };
    MaskRow north = empty_row(), previous = empty_row(), previous_south = empty_row(),
            before_previous = empty_row(), above = empty_row(), above_north = empty_row(),
            above_south = empty_row(), before_above = empty_row(), beside = empty_row();
    const auto load = [&](MaskRow& row, std::uint32_t map, std::size_t t) {
        if (map == kNone || t >= m)  // t - 1 of row 0 wraps around
            row.clear();
        else
            row.load(plane + mask.row_at(map, t));
    };
    for (std::uint32_t map = 0; map < neighbours.size() && !coder.failed(); ++map) {
        const Neighbours& n = neighbours[map];
        // Where a ring begins, and on the first ring, other neighbours stand in.
        const std::uint32_t p = n.previous != kNone ? n.previous : n.beside;
        const std::uint32_t a = n.above != kNone ? n.above : p;
        const std::uint32_t pp = p != kNone ? neighbours[p].previous : kNone;
        const std::uint32_t aa = a != kNone ? neighbours[a].above : kNone;
        for (std::size_t t = 0; t < m; ++t) {
            load(north, map, t - 1);
            load(previous, p, t);
            load(previous_south, p, t + 1);
            load(before_previous, pp, t);
            load(above, a, t);
            load(above_north, a, t - 1);
            load(above_south, a, t + 1);
            load(before_above, aa, t);
            load(beside, n.beside, t);
            // All of the context but the texel to the west, whole rows at a time.
            const std::uint8_t *c0 = north.data(), *c1 = previous.data(), *c2 = previous_south.data(),
                               *c3 = before_previous.data(), *c4 = above.data(), *c5 = above_north.data(),
                               *c6 = above_south.data(), *c7 = before_above.data(), *c8 = beside.data();
            for (std::size_t s = 0; s < m; ++s)
                contexts[s] = static_cast<std::uint16_t>(
                    c0[s] << 1 | c0[s + 1] << 2 | c1[s] << 3 | c1[s + 1] << 4 | c2[s] << 5 | c3[s] << 6 |
                    c4[s] << 7 | c4[s + 1] << 8 | c5[s] << 9 | c6[s] << 10 | c7[s] << 11 | c8[s] << 12 |
                    c8[s + 1] << 13);
            std::uint8_t* row = plane + mask.row_at(map, t);
            bool bit = false;
            for (std::size_t i = 0; i < mask.row_bytes; ++i) {
                const std::size_t begin = 8 * i, end = std::min(begin + 8, m);
                // Where all surroundings of a byte's texels agree, one decision mostly codes them all.
                std::uint32_t any = 0, all = kSurroundings;
                for (std::size_t s = begin; s < end; ++s) any |= contexts[s], all &= contexts[s];
                if (any == (bit ? kSurroundings : 0u) && all == any) {
                    const auto expected = static_cast<std::uint8_t>(bit ? 0xff >> (8 - (end - begin)) : 0);
                    if (coder.code(agreement[bit ? 1 : 0], row[i] == expected)) {
                        row[i] = expected;
                        continue;
                    }
                }
                for (std::size_t s = begin; s < end; ++s) {
                    bit = coder.code(models[contexts[s] | (bit ? 1 : 0)], (row[i] >> (s - begin) & 1) != 0);
                    row[i] = static_cast<std::uint8_t>(row[i] | (bit ? 1 << (s - begin) : 0));
                }
            }
        }
    }
}

}  // namespace dfield::codec
