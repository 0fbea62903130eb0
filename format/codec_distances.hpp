// The prediction of distances, shared by encoder and decoder. FORMAT.md, "Distances", is normative.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <span>
#include <type_traits>
#include <vector>

#include "format/bytes.hpp"
#include "format/codec_neighbours.hpp"

namespace dfield::codec {

// Texels as integers: hits are 0..miss-1, whatever the depth. Distances as floats below 1 order like their
// bits.
constexpr std::int32_t miss_value(std::uint32_t bits) {
    return bits == 8 ? kMiss8 : bits == 16 ? kMiss16 : std::bit_cast<std::int32_t>(kMiss32);
}

// Half octaves that tell apart how far the candidates of a prediction spread.
constexpr std::uint32_t spread_classes(std::uint32_t bits) {
    return 2 * (std::bit_width(static_cast<std::uint32_t>(miss_value(bits))) + 4);
}
constexpr std::uint32_t context_count(std::uint32_t bits) {
    return spread_classes(bits) * 3 / 2 + 2;
}

struct Prediction {
    std::int32_t value;     // 0..miss-1
    std::uint32_t context;  // 0..context_count-1
};

// Residual of a hit against its prediction, around the circle of `miss` values, small magnitudes first:
// 0..miss-1.
constexpr std::uint32_t fold_residual(std::int32_t value, std::int32_t prediction, std::int32_t miss) {
    std::int32_t e = value - prediction;
    if (e > (miss - 1) / 2) e -= miss;
    if (e < -(miss / 2)) e += miss;
    return e >= 0 ? 2 * static_cast<std::uint32_t>(e) : 2 * static_cast<std::uint32_t>(-(e + 1)) + 1;
}

// Inverse; the folded residual must be below `miss`, and then so is the result, which is never negative.
constexpr std::int32_t unfold_residual(std::uint32_t folded, std::int32_t prediction, std::int32_t miss) {
    const auto half = static_cast<std::int32_t>(folded >> 1);
    const std::int32_t value = prediction + ((folded & 1) != 0 ? -half - 1 : half);
    return value < 0 ? value + miss : value >= miss ? value - miss : value;
}

namespace detail {

// Texels that are prepared side by side.
inline constexpr std::size_t kBlock = 16;

// A row of texels as integers, with a miss before the first and misses after the last, up to a whole block. T
// holds a + b - c of any three of them, and more.
template<class T>
class TexelRow {
  public:
    TexelRow(std::size_t map_size, std::int32_t miss, std::pmr::memory_resource* memory)
        : map_size_(map_size),
          values_((map_size + kBlock - 1) / kBlock * kBlock + 1, static_cast<T>(miss), memory) {}

    void load(const std::uint8_t* bytes, std::uint32_t bits) {
        const std::size_t m = map_size_;
        if (bits == 8)
            for (std::size_t s = 0; s < m; ++s) values_[s + 1] = bytes[s];
        else if (bits == 16)
            for (std::size_t s = 0; s < m; ++s)
                values_[s + 1] = static_cast<T>(load_le<std::uint16_t>(bytes + 2 * s));
        else
            for (std::size_t s = 0; s < m; ++s)
                values_[s + 1] = static_cast<T>(load_le<std::uint32_t>(bytes + 4 * s));
    }
    void store(std::uint8_t* bytes, std::uint32_t bits) const {
        const std::size_t m = map_size_;
        if (bits == 8)
            for (std::size_t s = 0; s < m; ++s) bytes[s] = static_cast<std::uint8_t>(values_[s + 1]);
        else if (bits == 16)
            for (std::size_t s = 0; s < m; ++s)
                store_le(bytes + 2 * s, static_cast<std::uint16_t>(values_[s + 1]));
        else
            for (std::size_t s = 0; s < m; ++s)
                store_le(bytes + 4 * s, static_cast<std::uint32_t>(values_[s + 1]));
    }
    void clear() { std::fill(values_.begin(), values_.end(), values_[0]); }
    // Texel 0; [-1] is a miss.
    T* data() { return values_.data() + 1; }

  private:
    std::size_t map_size_;
    std::pmr::vector<T> values_;
};

// The rows that a prediction looks at: of the map itself, of the map before on its ring and the one before
// that, of the nearest map on the ring before and the nearest to that one there, of the second nearest, and
// of the one that is to the previous map what `above` is to this one.
template<class T>
struct Rows {
    const T *current, *north;
    const T *previous, *previous_north, *before_previous;
    const T *above, *above_north, *before_above;
    const T *beside, *beside_north;
    const T* diagonal;
};

// 0, 2, 3, 4, 4, 5, 5, ...: twice the octave of value + 1, plus its upper half.
inline std::uint32_t half_octave(std::uint64_t value) {
    const auto octave = static_cast<std::uint32_t>(std::bit_width(value + 1) - 1);
    return octave == 0 ? 0 : 2 * octave + ((value + 1) >> (octave - 1) & 1);
}

// Predictions: the median of up to nine candidates, each of which continues a plane through three hits. Six
// are known before the texel to the west is, and their spread is the context; three are offsets from that
// texel.
template<class T>
class Predictor {
  public:
    Predictor(std::int32_t miss, std::uint32_t classes) : miss_(static_cast<T>(miss)), classes_(classes) {}

    // Sorts the candidates of texels begin..begin + kBlock - 1. Of the row itself it only sees which texels
    // are hits. In passes of constant length over plain arrays, which compilers turn into vector code.
    void prepare(const Rows<T>& rows, std::size_t begin) {
        begin_ = begin;
        const auto at = [begin](const T* row) { return row + begin; };
        plane(0, at(rows.previous), at(rows.north), at(rows.previous_north));
        plane(1, at(rows.above), at(rows.north), at(rows.above_north));
        plane(2, at(rows.beside), at(rows.north), at(rows.beside_north));
        plane(3, at(rows.previous), at(rows.previous), at(rows.before_previous));
        plane(4, at(rows.above), at(rows.above), at(rows.before_above));
        plane(5, at(rows.previous), at(rows.above), at(rows.diagonal));
        offset(6, at(rows.north), at(rows.current));
        offset(7, at(rows.previous), at(rows.current));
        offset(8, at(rows.above), at(rows.current));
        count(known_, 0, 6);
        count(offsets_, 6, 9);
        order(0, 5), order(1, 3), order(2, 4);
        order(1, 2), order(3, 4);
        order(0, 3), order(2, 5);
        order(0, 1), order(2, 3), order(4, 5);
        order(1, 2), order(3, 4);
        order(6, 7), order(7, 8), order(6, 7);
    }

    // Texel s of the block that was prepared; its west neighbour in rows.current is known by now.
    Prediction predict(const Rows<T>& rows, std::size_t s) const {
        const std::size_t i = s - begin_, known = static_cast<std::size_t>(known_[i]),
                          count = known + static_cast<std::size_t>(offsets_[i]);
        const T* const row = rows.current + s;
        if (count == 0) return isolated({row[-1], rows.north[s], rows.previous[s], rows.above[s]});
        constexpr T kLowest = std::numeric_limits<T>::lowest();
        const auto& v = candidates_;
        const T sorted[9] = {kLowest, kLowest, kLowest, v[0][i], v[1][i], v[2][i], v[3][i], v[4][i], v[5][i]};
        const T* const x = sorted + 3;
        const T west = row[-1];
        const auto from_west = [west](T offset) {
            return offset == kAbsent ? kAbsent : static_cast<T>(west + offset);
        };
        const T y0 = from_west(v[6][i]), y1 = from_west(v[7][i]), y2 = from_west(v[8][i]);
        // Place `rank` of both sorted lists together: the best split between them.
        const auto merged = [&](std::size_t rank) {
            const T* const last = x + rank;
            return std::min(std::min(last[0], std::max(last[-1], y0)),
                            std::min(std::max(last[-2], y1), std::max(last[-3], y2)));
        };
        const std::int64_t median = (std::int64_t{merged((count - 1) / 2)} + merged(count / 2)) >> 1;
        return {static_cast<std::int32_t>(std::clamp<std::int64_t>(median, 0, miss_ - 1)), context(x, known)};
    }

  private:
    // Greater than any candidate.
    static constexpr T kAbsent = std::numeric_limits<T>::max();

    // i + j - k where all are hits.
    void plane(std::size_t kind, const T* i, const T* j, const T* k) {
        T* const out = candidates_[kind];
        const T miss = miss_;
        for (std::size_t s = 0; s < kBlock; ++s) {
            const bool hits = (i[s] != miss) & (j[s] != miss) & (k[s] != miss);
            out[s] = hits ? static_cast<T>(i[s] + j[s] - k[s]) : kAbsent;
        }
    }
    // i less its west neighbour, where both and the west neighbour in `current` are hits.
    void offset(std::size_t kind, const T* i, const T* current) {
        T* const out = candidates_[kind];
        const T miss = miss_;
        const T *const west = i - 1, *const current_west = current - 1;
        for (std::size_t s = 0; s < kBlock; ++s) {
            const bool hits = (i[s] != miss) & (west[s] != miss) & (current_west[s] != miss);
            out[s] = hits ? static_cast<T>(i[s] - west[s]) : kAbsent;
        }
    }
    void count(T* out, std::size_t first, std::size_t end) const {
        std::fill(out, out + kBlock, T{0});
        for (; first < end; ++first)
            for (std::size_t s = 0; s < kBlock; ++s)
                out[s] = static_cast<T>(out[s] + (candidates_[first][s] != kAbsent ? 1 : 0));
    }
    void order(std::size_t kind_low, std::size_t kind_high) {
        T *const low = candidates_[kind_low], *const high = candidates_[kind_high];
        for (std::size_t s = 0; s < kBlock; ++s) {
            const T a = low[s], b = high[s];
            low[s] = a < b ? a : b;
            high[s] = a < b ? b : a;
        }
    }

    std::uint32_t context(const T* x, std::size_t known) const {
        if (known == 0) return classes_ * 3 / 2;
        const auto range = [x](std::size_t low, std::size_t high) {
            return static_cast<std::uint64_t>(std::int64_t{x[high]} - x[low]);
        };
        if (known == 6) return half_octave(2 * range(2, 3) + range(1, 4));
        if (known >= 4) return half_octave(3 * range(1, known - 2));
        return classes_ + half_octave(range(0, known - 1)) / 2;
    }

    // Without a candidate: the mean of the nearest hits.
    Prediction isolated(const std::array<T, 4>& nearest) const {
        std::int64_t sum = 0, hits = 0;
        for (const T value : nearest)
            if (value != miss_) sum += value, ++hits;
        return {static_cast<std::int32_t>(hits != 0 ? sum / hits : miss_ / 2), classes_ * 3 / 2 + 1};
    }

    T miss_;
    std::uint32_t classes_;
    std::size_t begin_ = 0;
    T candidates_[9][kBlock];  // 0..5 sorted candidates, 6..8 sorted offsets from the texel to the west
    T known_[kBlock], offsets_[kBlock];  // how many of each are not absent
};

template<class T, class Texel, class Coder>
void code_distances_as(const FieldParameters& parameters, std::span<const Neighbours> neighbours,
                       const std::uint8_t* plane, Texel* texels, Coder& coder,
                       std::pmr::memory_resource* memory) {
    constexpr std::uint32_t kNone = Neighbours::kNone;
    constexpr bool kDecoding = !std::is_const_v<Texel>;
    const std::uint32_t bits = parameters.bits;
    const std::size_t m = parameters.map_size, row_bytes = m * bits / 8;
    const std::int32_t miss = miss_value(bits);
    const MaskLayout mask(parameters);
    // One row a name; copies of pmr containers would leave `memory`.
    const auto row_of_misses = [&] { return TexelRow<T>(m, miss, memory); };
    TexelRow<T> current = row_of_misses(), north = row_of_misses(), previous = row_of_misses(),
                previous_north = row_of_misses(), before_previous = row_of_misses(), above = row_of_misses(),
                above_north = row_of_misses(), before_above = row_of_misses(), beside = row_of_misses(),
                beside_north = row_of_misses(), diagonal = row_of_misses();
    Predictor<T> predictor(miss, spread_classes(bits));
    const auto load = [&](TexelRow<T>& row, std::uint32_t map, std::size_t t) {
        if (map == kNone || t >= m)  // t - 1 of row 0 wraps around
            row.clear();
        else
            row.load(texels + (map * m + t) * row_bytes, bits);
        return row.data();
    };
    for (std::uint32_t map = 0; map < neighbours.size() && !coder.failed(); ++map) {
        const auto [p, a, b] = neighbours[map];
        const std::uint32_t pp = p != kNone ? neighbours[p].previous : kNone;
        const std::uint32_t aa = a != kNone ? neighbours[a].above : kNone;
        // Where rings grow, the map above the previous one may be the one above: nothing new then.
        const std::uint32_t d = p != kNone && neighbours[p].above != a ? neighbours[p].above : kNone;
        for (std::size_t t = 0; t < m; ++t) {
            const std::uint8_t* hits = plane + mask.row_at(map, t);
            Texel* row = texels + (map * m + t) * row_bytes;
            const bool none =
                std::all_of(hits, hits + mask.row_bytes, [](std::uint8_t byte) { return byte == 0; });
            if (none && !kDecoding) continue;
            T* c = current.data();
            if constexpr (kDecoding)
                for (std::size_t s = 0; s < m; ++s)
                    c[s] = (hits[s / 8] >> s % 8 & 1) != 0 ? T{0} : static_cast<T>(miss);
            else
                load(current, map, t);
            if (!none) {
                const Rows<T> rows{c,
                                   load(north, map, t - 1),
                                   load(previous, p, t),
                                   load(previous_north, p, t - 1),
                                   load(before_previous, pp, t),
                                   load(above, a, t),
                                   load(above_north, a, t - 1),
                                   load(before_above, aa, t),
                                   load(beside, b, t),
                                   load(beside_north, b, t - 1),
                                   load(diagonal, d, t)};
                for (std::size_t s = 0; s < m; ++s) {
                    if (s % kBlock == 0) predictor.prepare(rows, s);
                    if (c[s] != miss) c[s] = static_cast<T>(coder.code(predictor.predict(rows, s), c[s]));
                }
            }
            if constexpr (kDecoding) current.store(row, bits);
        }
    }
}

}  // namespace detail

// Calls coder.code(prediction, value) for every hit in file order. An encoder has const texels, gets the
// texel's value and answers the same; a decoder gets 0 and answers the value, which is stored, as are the
// misses. Stops early when coder.failed().
template<class Texel, class Coder>
void code_distances(const FieldParameters& parameters, std::span<const Neighbours> neighbours,
                    const std::uint8_t* plane, Texel* texels, Coder& coder,
                    std::pmr::memory_resource* memory) {
    if (parameters.bits == 8)
        detail::code_distances_as<std::int16_t>(parameters, neighbours, plane, texels, coder, memory);
    else
        detail::code_distances_as<std::int32_t>(parameters, neighbours, plane, texels, coder, memory);
}

}  // namespace dfield::codec
