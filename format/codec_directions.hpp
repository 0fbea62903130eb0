// The adaptive model of direction maps, shared by encoder and decoder. FORMAT.md, "Direction maps (DM00 to
// DM07)", is normative.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "format/codec_direction_geometry.hpp"
#include "format/range_coder.hpp"

namespace dfield::codec {

namespace detail {

// A map with a byte a texel and a frame of zeros around it.
class PaddedMap {
  public:
    PaddedMap(std::uint32_t map_size, std::pmr::memory_resource* memory)
        : m_(map_size), texels_((map_size + 2) * (map_size + 2), memory) {}

    void clear() { std::fill(texels_.begin(), texels_.end(), std::uint8_t{0}); }
    void load(std::span<const std::uint32_t> words) {
        for (std::uint32_t t = 0; t < m_; ++t)
            for (std::uint32_t s = 0; s < m_; ++s) {
                const std::uint32_t bit = t * m_ + s;
                (*this)(s, t) = static_cast<std::uint8_t>(words[bit / 32] >> bit % 32 & 1);
            }
    }
    // -1 .. m
    std::uint8_t& operator()(std::int64_t s, std::int64_t t) {
        return texels_[static_cast<std::size_t>((t + 1) * (m_ + 2) + s + 1)];
    }
    // Share of hits among the four texels around a place, 0 .. 256, as sixteenths of a texel weigh them.
    std::uint32_t sample(std::int64_t s, std::int64_t t) {
        const std::int64_t column = s >> 16, row = t >> 16;
        if (column < -1 || row < -1 || column >= m_ || row >= m_) return 0;
        const auto right = static_cast<std::uint32_t>(s >> 12 & 15),
                   down = static_cast<std::uint32_t>(t >> 12 & 15);
        const std::uint8_t *upper = &(*this)(column, row), *lower = upper + m_ + 2;
        return (16 - down) * ((16 - right) * upper[0] + right * upper[1]) +
               down * ((16 - right) * lower[0] + right * lower[1]);
    }

  private:
    std::int64_t m_;
    std::pmr::vector<std::uint8_t> texels_;
};

// An earlier map as the current one sees it, row by row.
class SeenMap {
  public:
    SeenMap(std::uint32_t map_size, std::pmr::memory_resource* memory)
        : m_(map_size), map_(map_size, memory) {}

    void absent() {
        map_.clear();
        transform_ = {};
        sample_row(0);
    }
    void load(std::span<const std::uint32_t> words, const TexelTransform& transform) {
        map_.load(words);
        transform_ = transform;
        sample_row(0);
    }
    // Shares of hits at the texels (s, t) of the current row, s <= m, and of the row after it.
    const std::uint16_t* row() const { return rows_[0].data(); }
    const std::uint16_t* next_row() const { return rows_[1].data(); }
    void begin_row(std::int64_t t) {
        rows_[0] = rows_[1];
        sample_row(t + 1);
    }

  private:
    void sample_row(std::int64_t t) {
        for (std::int64_t s = 0; s <= m_; ++s)
            rows_[1][static_cast<std::size_t>(s)] = static_cast<std::uint16_t>(
                map_.sample(transform_.s + s * transform_.s_ds + t * transform_.s_dt,
                            transform_.t + s * transform_.t_ds + t * transform_.t_dt));
    }

    std::int64_t m_;
    PaddedMap map_;
    TexelTransform transform_{};
    std::array<std::array<std::uint16_t, kMaxDirectionMapSize + 1>, 2> rows_{};
};

// Shares of hits as contexts: 0 none, .. all.
constexpr std::uint32_t sixth(std::uint32_t share) {
    return share == 0 ? 0 : share == 256 ? 5 : 1 + share / 64;
}
constexpr std::uint32_t third(std::uint32_t share) {
    return share < 64 ? 0 : share < 192 ? 1 : 2;
}

}  // namespace detail

// Codes one level of direction maps: frames, texels and depths are read by an encoder, and written by a
// decoder (into zeros). All have the sizes that the parameters say.
class DirectionModel {
  public:
    DirectionModel(const DirectionParameters& parameters, std::span<PackedDirectionFrame> frames,
                   std::span<std::uint32_t> texels, std::span<DirectionDepth> depths,
                   std::pmr::memory_resource* memory)
        : m_(parameters.map_size),
          depth_size_(parameters.depth_size),
          subdivision_(parameters.subdivision),
          frames_(frames),
          texels_(texels),
          depths_(depths),
          texel_models_(kTexelContexts, memory),
          frame_models_(8, memory),
          depth_models_(2 * kSpreads, memory),
          own_(m_, memory),
          previous_(m_, memory),
          above_(m_, memory),
          beside_(m_, memory) {}

    // False when the bytes give a depth that cannot be; what else is wrong, the coder tells.
    template<class Coder>
    bool code(Coder& coder) {
        bool good = true;
        for_each_stored_direction(subdivision_, [&](std::uint32_t map, const DirectionPlace& place) {
            // Where a ring begins, and on the first ring, other neighbours stand in.
            Neighbours n = place.neighbours;
            if (n.previous == Neighbours::kNone) n.previous = n.beside;
            if (n.above == Neighbours::kNone) n.above = n.previous;
            code_frame(coder, map, n);
            const DirectionPlane plane = direction_plane(subdivision_, place, frames_[map]);
            load(previous_, n.previous, plane, place);
            load(above_, n.above, plane, place);
            load(beside_, n.beside, plane, place);
            code_texels(coder, map);
            good = code_depths(coder, map);
            return good && !coder.failed();
        });
        return good;
    }

  private:
    static constexpr std::uint32_t kTexelContexts = 16 * 6 * 6 * 3 * 3 * 4, kSpreads = 4;
    static constexpr std::uint32_t kAllHits = kTexelContexts - 2;  // all but the texel to the west

    std::span<std::uint32_t> words_of(std::uint32_t map) const {
        const std::size_t words = direction_map_words(m_);
        return texels_.subspan(map * words, words);
    }

    void load(detail::SeenMap& seen, std::uint32_t map, const DirectionPlane& plane,
              const DirectionPlace& place) const {
        if (map == Neighbours::kNone) return seen.absent();
        const std::uint32_t first = slater_ring_start(place.ring);
        const std::uint32_t ring = map >= first ? place.ring : place.ring - 1;
        const DirectionPlace there{ring, map - slater_ring_start(ring), {}};
        seen.load(words_of(map),
                  texel_transform(plane, direction_plane(subdivision_, there, frames_[map]), m_));
    }

    // Bytes as differences to those of the maps before.
    template<class Coder>
    void code_frame(Coder& coder, std::uint32_t map, const Neighbours& n) {
        for (std::size_t i = 0; i < 8; ++i) {
            const std::uint8_t expected = n.previous == Neighbours::kNone ? 128 : frames_[n.previous][i];
            std::uint8_t& value = frames_[map][i];
            value = static_cast<std::uint8_t>(
                expected + code_byte(coder, frame_models_[i], static_cast<std::uint8_t>(value - expected)));
        }
    }

    template<class Coder>
    void code_texels(Coder& coder, std::uint32_t map) {
        using detail::sixth, detail::third;
        const std::span<std::uint32_t> words = words_of(map);
        own_.clear();
        std::array<std::uint16_t, kMaxDirectionMapSize> contexts;
        for (std::uint32_t t = 0; t < m_; ++t) {
            previous_.begin_row(t);
            above_.begin_row(t);
            beside_.begin_row(t);
            // All of the context but the texel to the west, whole rows at a time.
            const std::uint8_t* north = &own_(-1, std::int64_t{t} - 1);  // from the north-west texel on
            const std::uint16_t *p = previous_.row(), *p_south = previous_.next_row(), *a = above_.row(),
                                *a_south = above_.next_row(), *b = beside_.row();
            for (std::uint32_t s = 0; s < m_; ++s) {
                std::uint32_t context = sixth(p[s]);
                context = 6 * context + sixth(a[s]);
                context = 3 * context + third(b[s]);
                context = 3 * context + third(p[s + 1]);
                context = 2 * context + (p_south[s] >= 128 ? 1 : 0);
                context = 2 * context + (a_south[s] >= 128 ? 1 : 0);
                contexts[s] = static_cast<std::uint16_t>(16 * context + 8 * north[s + 2] + 4 * north[s] +
                                                         2 * north[s + 1]);
            }
            bool bit = false;
            for (std::uint32_t begin = 0; begin < m_; begin += 8) {
                // Where all surroundings of eight texels agree, one decision mostly codes them all.
                const std::uint32_t agreed = bit ? kAllHits : 0;
                const auto* of_byte = &contexts[begin];
                if (std::all_of(of_byte, of_byte + 8, [&](std::uint16_t c) { return c == agreed; })) {
                    const std::uint32_t expected = bit ? 0xff : 0, at = t * m_ + begin;
                    std::uint32_t& word = words[at / 32];
                    if (coder.code(agreement_[bit ? 1 : 0], (word >> at % 32 & 0xff) == expected)) {
                        word |= expected << at % 32;
                        for (std::uint32_t s = begin; s < begin + 8; ++s) own_(s, t) = bit ? 1 : 0;
                        continue;
                    }
                }
                for (std::uint32_t s = begin; s < begin + 8; ++s) {
                    const std::uint32_t at = t * m_ + s;
                    std::uint32_t& word = words[at / 32];
                    bit = coder.code(texel_models_[contexts[s] + (bit ? 1 : 0)], (word >> at % 32 & 1) != 0);
                    word |= (bit ? 1u : 0u) << at % 32;
                    own_(s, t) = bit ? 1 : 0;
                }
            }
        }
    }

    // Farthest hit and thickness of a depth texel.
    struct Depth {
        bool hit = false;
        int farthest = 0, thickness = 0;
    };

    template<class Coder>
    bool code_depths(Coder& coder, std::uint32_t map) {
        if (depth_size_ == 0) return true;
        const std::size_t size = depth_size_;
        DirectionDepth* const depths = &depths_[map * size * size];
        const auto known = [&](std::size_t s, std::size_t t) {  // coordinates before 0 wrap around
            if (s >= size || t >= size) return Depth{};
            const DirectionDepth d = depths[t * size + s];
            return d.nearest > d.farthest ? Depth{} : Depth{true, d.farthest, d.farthest - d.nearest};
        };
        for (std::size_t t = 0; t < size; ++t)
            for (std::size_t s = 0; s < size; ++s) {
                const Depth west = known(s - 1, t), north = known(s, t - 1), corner = known(s - 1, t - 1);
                DirectionDepth& depth = depths[t * size + s];
                const std::uint32_t context = (west.hit ? 1 : 0) | (north.hit ? 2 : 0) |
                                              (corner.hit ? 4 : 0) | covering(map, s, t) << 3;
                if (!coder.code(hit_models_[context], depth.nearest <= depth.farthest)) {
                    depth = kNoDepth;
                    continue;
                }
                const auto [farthest, far_spread] = predict(west, north, corner, &Depth::farthest, 128);
                depth.farthest = code_difference(coder, far_spread, farthest, depth.farthest);
                const auto [thickness, spread] = predict(west, north, corner, &Depth::thickness, 0);
                const std::uint8_t coded =
                    code_difference(coder, kSpreads + spread, thickness, depth.farthest - depth.nearest);
                if (coded > depth.farthest) return false;
                depth.nearest = static_cast<std::uint8_t>(depth.farthest - coded);
            }
        return true;
    }

    // How many texels of a depth texel's square are hits: 0 none, 1 some, 2 all.
    std::uint32_t covering(std::uint32_t map, std::size_t s, std::size_t t) {
        const std::span<const std::uint32_t> words = words_of(map);
        const std::size_t side = m_ / depth_size_;
        std::uint32_t hits = 0;
        for (std::size_t y = t * side; y < (t + 1) * side; ++y)
            for (std::size_t x = s * side; x < (s + 1) * side; ++x)
                hits += words[(y * m_ + x) / 32] >> (y * m_ + x) % 32 & 1;
        return hits == 0 ? 0 : hits == side * side ? 2 : 1;
    }

    struct Prediction {
        int value;
        std::uint32_t spread;  // how far to trust it
    };
    static Prediction predict(const Depth& west, const Depth& north, const Depth& corner, int Depth::*value,
                              int otherwise) {
        if (west.hit && north.hit) {
            const int spread = std::abs(west.*value - north.*value);
            const int expected =
                corner.hit ? west.*value + north.*value - corner.*value : (west.*value + north.*value) / 2;
            return {std::clamp(expected, 0, 255), spread < 6 ? 0u : 1u};
        }
        if (west.hit || north.hit) return {west.hit ? west.*value : north.*value, 2};
        return {otherwise, 3};
    }
    template<class Coder>
    std::uint8_t code_difference(Coder& coder, std::uint32_t model, int expected, int value) {
        const std::uint8_t coded =
            code_byte(coder, depth_models_[model], static_cast<std::uint8_t>(value - expected));
        return static_cast<std::uint8_t>(expected + coded);
    }

    static constexpr DirectionDepth kNoDepth{255, 0};

    std::uint32_t m_, depth_size_, subdivision_;
    std::span<PackedDirectionFrame> frames_;
    std::span<std::uint32_t> texels_;
    std::span<DirectionDepth> depths_;
    std::pmr::vector<BitModel> texel_models_;
    std::array<BitModel, 2> agreement_;
    std::array<BitModel, 24> hit_models_;
    std::pmr::vector<ByteModel> frame_models_, depth_models_;
    detail::PaddedMap own_;
    detail::SeenMap previous_, above_, beside_;
};

}  // namespace dfield::codec
