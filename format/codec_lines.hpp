// The adaptive model of line tables, shared by encoder and decoder. FORMAT.md, "Line table (LINE)", is
// normative.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "format/line_table.hpp"
#include "format/range_coder.hpp"

namespace dfield::codec {

// Codes one line table: hits and depths are read by an encoder, and written by a decoder (into zeros). Both
// have the sizes that the parameters say.
class LineModel {
  public:
    LineModel(const LineParameters& parameters, std::span<std::uint32_t> hits,
              std::span<std::uint32_t> depths, std::pmr::memory_resource* memory)
        : parameters_(parameters),
          hits_(hits),
          depths_(depths),
          hit_models_(std::size_t{1} << 12, memory),
          flag_models_(3 << 8, memory),
          depth_models_(kSpreads, memory) {}

    // False when the bytes give a depth that cannot be; what else is wrong, the coder tells.
    template<class Coder>
    bool code(Coder& coder) {
        code_hits(coder);
        return parameters_.depth_bits == 0 || code_depths(coder);
    }

  private:
    static constexpr std::uint32_t kSpreads = 12;

    // Rows are the pairs' larger points a, in them the smaller ones b ascending.
    template<class Coder>
    void code_hits(Coder& coder) {
        const std::int64_t side = parameters_.lattice, points = side * side;
        for (std::int64_t a = 0; a < points && !coder.failed(); ++a)
            for (std::int64_t b = 0; b <= a; ++b) {
                // Pairs that come later, or are none, count as misses.
                const auto known = [&](std::int64_t x, std::int64_t y) -> std::uint32_t {
                    if (x < 0 || y < 0 || std::max(x, y) > a - (x == a ? 0 : 1)) return 0;
                    return bit_at(hits_,
                                  hit_index(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)));
                };
                const std::uint32_t context = known(a, b - 1) | known(a, b - side) << 1 |
                                              known(a, b - side - 1) << 2 | known(a, b - side + 1) << 3 |
                                              known(a - 1, b) << 4 | known(a - side, b) << 5 |
                                              known(a - 1, b + 1) << 6 | known(a - 1, b + side) << 7 |
                                              known(a - side, b + 1) << 8 | known(a - side, b + side) << 9 |
                                              known(a - side - 1, b) << 10 | known(a - side + 1, b) << 11;
                const std::uint32_t i =
                    hit_index(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
                if (coder.code(hit_models_[context], bit_at(hits_, i) != 0)) hits_[i / 32] |= 1u << i % 32;
            }
    }

    template<class Coder>
    bool code_depths(Coder& coder) {
        const std::int64_t side = parameters_.depth_lattice, points = side * side;
        const std::uint32_t bits = parameters_.depth_bits;
        const int largest = (1 << bits) - 1;
        const auto place = [&](std::int64_t a, std::int64_t b) {
            return static_cast<std::uint64_t>(a * points + b) * bits;
        };
        for (std::int64_t a = 0; a < points && !coder.failed(); ++a)
            for (std::int64_t b = 0; b < points; ++b) {
                const auto depth = [&](std::int64_t x, std::int64_t y) {  // of a pair before, 0 for others
                    if (x < 0 || y < 0 || y >= points) return 0;
                    const std::uint64_t at = place(x, y);
                    return static_cast<int>(depths_[at / 32] >> at % 32) & largest;
                };
                const int w = depth(a, b - 1), n = depth(a, b - side), nw = depth(a, b - side - 1),
                          ne = depth(a, b - side + 1), p = depth(a - 1, b), u = depth(a - side, b),
                          mirror = b < a ? depth(b, a) : 0;
                const auto hit = [](int value) { return value != 0 ? 1u : 0u; };
                const std::uint32_t flags = hit(w) | hit(n) << 1 | hit(nw) << 2 | hit(ne) << 3 | hit(p) << 4 |
                                            hit(u) << 5 | hit(depth(a - 1, b + 1)) << 6 |
                                            hit(depth(a - side, b + side)) << 7;
                const std::uint32_t mirrored = b >= a ? 0 : 1 + hit(mirror);
                const std::uint64_t at = place(a, b);
                std::uint32_t& word = depths_[at / 32];
                const int value = static_cast<int>(word >> at % 32) & largest;
                if (!coder.code(flag_models_[flags | mirrored << 8], value != 0)) continue;

                std::array<int, 5> candidates;
                std::size_t count = 0;
                const auto add = [&](int x, int y, int corner) {  // in order
                    if (x == 0 || y == 0 || corner == 0) return;
                    std::size_t to = count++;
                    for (; to > 0 && candidates[to - 1] > x + y - corner; --to)
                        candidates[to] = candidates[to - 1];
                    candidates[to] = x + y - corner;
                };
                add(w, n, nw);
                add(p, w, depth(a - 1, b - 1));
                add(p, n, depth(a - 1, b - side));
                add(u, w, depth(a - side, b - 1));
                add(u, n, depth(a - side, b - side));
                const auto [expected, model] = predict({candidates.data(), count}, {w, n, p, u}, largest);
                const auto coded = static_cast<std::uint8_t>(
                    expected +
                    code_byte(coder, depth_models_[model], static_cast<std::uint8_t>(value - expected)));
                if (coded == 0 || coded > largest) return false;
                word |= std::uint32_t{coded} << at % 32;
            }
        return true;
    }

    struct Prediction {
        int value;
        std::uint32_t model;
    };
    // The middle of the candidates, which ascend; without any, the mean of the neighbours that are hits.
    static Prediction predict(std::span<const int> candidates, const std::array<int, 4>& neighbours,
                              int largest) {
        if (!candidates.empty()) {
            const std::size_t last = candidates.size() - 1;
            const int middle = (candidates[last / 2] + candidates[(last + 1) / 2]) >> 1;
            const int spread = candidates[last] - candidates[0];
            const std::uint32_t grade = spread < 4    ? 0
                                        : spread < 8  ? 1
                                        : spread < 16 ? 2
                                        : spread < 40 ? 3
                                                      : 4;
            return {std::clamp(middle, 1, largest), last == 0 ? 10 : grade + (last < 3 ? 5 : 0)};
        }
        int sum = 0, hits = 0;
        for (const int value : neighbours)
            if (value != 0) sum += value, ++hits;
        return {hits == 0 ? (largest + 1) / 2 : sum / hits, 11};
    }

    static std::uint32_t bit_at(std::span<const std::uint32_t> words, std::uint32_t i) {
        return words[i / 32] >> i % 32 & 1;
    }

    LineParameters parameters_;
    std::span<std::uint32_t> hits_, depths_;
    std::pmr::vector<BitModel> hit_models_, flag_models_;
    std::pmr::vector<ByteModel> depth_models_;
};

}  // namespace dfield::codec
