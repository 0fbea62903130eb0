// Fields to write and read back. Integers only: the golden files are made of these too, and must be the same
// everywhere.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "format/bytes.hpp"
#include "format/field.hpp"

namespace dfield::test {

enum class Pattern { kSmooth, kNoise, kAllMiss, kAllHit };

// A small generator that is the same on every platform (SplitMix64).
class Bits {
  public:
    explicit Bits(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
        z = (z ^ z >> 27) * 0x94d049bb133111eb;
        return z ^ z >> 31;
    }
    std::uint32_t below(std::uint64_t end) { return static_cast<std::uint32_t>((next() >> 32) * end >> 32); }

  private:
    std::uint64_t state_;
};

// A texel of a map: a miss, or a distance in 1/2^20 of the diameter.
struct Texel {
    bool hit;
    std::uint32_t distance;
};

inline Texel texel_of(Pattern pattern, std::uint32_t m, std::uint32_t map, std::uint32_t s, std::uint32_t t,
                      Bits& bits) {
    switch (pattern) {
        case Pattern::kSmooth: {  // a blob that wanders from map to map, its distance rising outwards
            const auto x = static_cast<std::int64_t>(8 * s) - 3 * m - static_cast<std::int64_t>(map % 7);
            const auto y = static_cast<std::int64_t>(8 * t) - 4 * m + static_cast<std::int64_t>(map % 5);
            const std::int64_t squared = x * x + y * y;
            return {squared < 9ll * m * m,
                    static_cast<std::uint32_t>(200000 + squared * 30000 / (m * m) + 100 * map)};
        }
        case Pattern::kNoise:
            return {bits.below(2) == 1, bits.below(1 << 20)};
        case Pattern::kAllMiss:
            return {false, 0};
        default:
            return {true, 500000 + 1000 * s};
    }
}

inline void put_texel(const FieldParameters& p, std::span<std::uint8_t> map, std::uint32_t i,
                      const Texel& texel) {
    switch (p.bits) {
        case 1:
            if (texel.hit) map[i / 8] = static_cast<std::uint8_t>(map[i / 8] | 1 << i % 8);
            break;
        case 8:
            map[i] =
                texel.hit ? static_cast<std::uint8_t>(std::uint64_t{texel.distance} * 254 >> 20) : kMiss8;
            break;
        case 16:
            store_le(&map[2 * i],
                     texel.hit ? static_cast<std::uint16_t>(std::uint64_t{texel.distance} * 65534 >> 20)
                               : kMiss16);
            break;
        default:
            store_float(&map[4 * i], texel.hit ? static_cast<float>(texel.distance) / (1 << 20) : kMiss32);
    }
}

inline DisplacementField make_field(const FieldParameters& p, Pattern pattern, std::uint64_t seed = 1) {
    DisplacementField field;
    field.parameters = p;
    field.centre = {1, -2, 3};
    field.radius = 2.5f;
    field.bounds_min = {0, -3, 1.5f};
    field.bounds_max = {2, -0.5f, 4};
    field.texels.resize(texel_bytes(p));
    Bits bits(seed);
    const std::uint64_t maps = position_count(p), bytes = map_bytes(p);
    const auto m = static_cast<std::int64_t>(p.map_size);
    for (std::uint32_t map = 0; map < maps; ++map) {
        bool any = false;
        for (std::uint32_t t = 0; t < p.map_size; ++t)
            for (std::uint32_t s = 0; s < p.map_size; ++s) {
                Texel texel = texel_of(pattern, p.map_size, map, s, t, bits);
                const std::int64_t a = 2 * std::int64_t{s} + 1 - m, b = 2 * std::int64_t{t} + 1 - m;
                if (p.mapping == Mapping::kRejection && a * a + b * b > m * m) texel.hit = false;
                any = any || texel.hit;
                put_texel(p, std::span(field.texels).subspan(map * bytes, bytes), t * p.map_size + s, texel);
            }
        if (p.bits == 1)
            field.mean_depth.push_back(any ? static_cast<std::uint16_t>(20000 + 17 * map) : std::uint16_t{0});
    }
    return field;
}

inline void add_optional_sections(DisplacementField& field) {
    for (std::uint32_t i = 0; i < 50; ++i)
        field.self_visibility.push_back(static_cast<std::uint16_t>(65535 - 900 * (i % 9) - i));
    field.provenance = "{\"mesh_hash\":\"0123\",\"note\":\"\xc3\xa9t\xc3\xa9\"}";
}

inline bool same_field(const DisplacementField& a, const DisplacementField& b) {
    return a.parameters == b.parameters && a.centre == b.centre && a.radius == b.radius &&
           a.bounds_min == b.bounds_min && a.bounds_max == b.bounds_max && a.texels == b.texels &&
           a.mean_depth == b.mean_depth && a.self_visibility == b.self_visibility &&
           a.provenance == b.provenance;
}

}  // namespace dfield::test
