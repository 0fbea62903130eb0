// Line tables, direction maps and occlusion volumes to write and read back. Integers only, as in fields.hpp.
#pragma once

#include <algorithm>
#include <cstdint>

#include "format/direction_maps.hpp"
#include "format/field.hpp"
#include "format/line_table.hpp"
#include "format/occlusion_volume.hpp"
#include "tests/format/fields.hpp"

namespace dfield::test {

// Whether the points of a pair lie far apart in the lattice: what a blob in the middle of the sphere gives.
inline bool far_apart(std::uint32_t side, std::uint32_t a, std::uint32_t b) {
    const auto across = [&](std::uint32_t x, std::uint32_t y) { return x > y ? x - y : y - x; };
    return 2 * (across(a % side, b % side) + across(a / side, b / side)) > side;
}

// Line tables without depths, or with.
constexpr LineParameters line_parameters(std::uint32_t lattice, std::uint32_t depth_bits = 0,
                                         std::uint32_t depth_lattice = 0, bool ellipsoid = false) {
    return {lattice, depth_bits, depth_lattice, depth_bits == 0, depth_bits == 4, ellipsoid};
}

inline LineTable make_line_table(const LineParameters& p, Pattern pattern, std::uint64_t seed = 1) {
    LineTable table;
    table.parameters = p;
    table.to_unit = glm::mat3(0.4f);
    if (p.ellipsoid) table.to_unit[1] = {0.125f, 0.5f, 0};
    table.centre = {1, -2, 3};
    table.hits.resize(line_hit_words(p));
    table.depths.resize(line_depth_words(p));
    Bits bits(seed);
    const auto hit = [&](std::uint32_t side, std::uint32_t a, std::uint32_t b) {
        if (pattern == Pattern::kNoise) return bits.below(2) == 1;
        return pattern == Pattern::kAllHit || (pattern == Pattern::kSmooth && far_apart(side, a, b));
    };
    for (std::uint32_t a = 0; a < lattice_point_count(p.lattice); ++a)
        for (std::uint32_t b = 0; b <= a; ++b)
            if (hit(p.lattice, a, b)) table.hits[hit_index(a, b) / 32] |= 1u << hit_index(a, b) % 32;
    const std::uint32_t points = lattice_point_count(p.depth_lattice), largest = (1u << p.depth_bits) - 1;
    for (std::uint32_t a = 0; a < points; ++a)
        for (std::uint32_t b = 0; b < points; ++b) {
            if (!hit(p.depth_lattice, a, b)) continue;
            const std::uint32_t value = pattern == Pattern::kNoise
                                            ? 1 + bits.below(largest)
                                            : 1 + (a % p.depth_lattice + 2 * (b / p.depth_lattice)) % largest;
            const std::uint32_t at = depth_index(a, b, points) * p.depth_bits;
            table.depths[at / 32] |= value << at % 32;
        }
    return table;
}

inline DirectionMaps make_direction_maps(const DirectionParameters& p, Pattern pattern,
                                         std::uint64_t seed = 1) {
    DirectionMaps maps;
    maps.parameters = p;
    Bits bits(seed);
    const std::uint32_t words = direction_map_words(p.map_size), m = p.map_size;
    for (std::uint32_t map = 0; map < stored_direction_count(p.subdivision); ++map) {
        const auto byte = [&](std::uint32_t value) { return static_cast<std::uint8_t>(value); };
        maps.frames.push_back({byte(5 * map), byte(128 + map % 5), byte(120), byte(200), byte(180),
                               byte(128 - map % 3), byte(130), byte(126)});
        if (pattern == Pattern::kNoise)
            for (std::uint8_t& value : maps.frames.back()) value = byte(bits.below(256));
        maps.texels.resize((map + 1) * words);
        for (std::uint32_t i = 0; i < m * m; ++i)
            if (texel_of(pattern, m, map, i % m, i / m, bits).hit)
                maps.texels[map * words + i / 32] |= 1u << i % 32;
        for (std::uint32_t i = 0; i < p.depth_size * p.depth_size; ++i) {
            const Texel texel =
                texel_of(pattern, p.depth_size, map, i % p.depth_size, i / p.depth_size, bits);
            const std::uint32_t nearest = texel.distance >> 13;  // 0 .. 127
            const std::uint32_t thickness = pattern == Pattern::kNoise ? bits.below(128) : map % 20;
            maps.depths.push_back(texel.hit ? DirectionDepth{byte(nearest), byte(nearest + thickness)}
                                            : DirectionDepth{255, 0});
        }
    }
    return maps;
}

inline OcclusionVolume make_volume(const std::array<std::uint32_t, 3>& dims, std::uint32_t far_size,
                                   Pattern pattern, std::uint64_t seed = 1) {
    OcclusionVolume volume;
    volume.dims = dims;
    volume.origin = {-1, -2, 0.5f};
    volume.spacing = 0.25f;
    volume.blend = 0.5f;
    volume.far_size = far_size;
    volume.octants.resize(2 * volume.samples());
    Bits bits(seed);
    for (std::size_t sample = 0; sample < volume.samples(); ++sample)
        for (std::size_t i = 0; i < kVolumeOctants; ++i) {
            const std::size_t x = sample % dims[0], y = sample / dims[0] % dims[1],
                              z = sample / dims[0] / dims[1];
            const std::size_t smooth = std::min<std::size_t>(40 + 3 * x + 5 * y + 2 * z * (i + 1), 255);
            const std::size_t value = pattern == Pattern::kNoise     ? bits.below(256)
                                      : pattern == Pattern::kAllHit  ? 0
                                      : pattern == Pattern::kAllMiss ? 255
                                                                     : smooth;
            volume.set_octant(sample, i, static_cast<std::uint8_t>(value));
        }
    for (std::uint32_t node = 0; node < far_size * far_size; ++node)
        volume.far.push_back(pattern == Pattern::kNoise ? bits.below(0xffffffff)
                                                        : pack_far_ball({200, 128, 130, 126}));
    return volume;
}

// A field with the sphere of make_field and the kinds that are added to it.
inline DisplacementField make_empty_field() {
    DisplacementField field = make_field(kNoMaps, Pattern::kAllMiss);
    return field;
}

inline bool same_lines(const LineTable& a, const LineTable& b) {
    return a.parameters == b.parameters && a.to_unit == b.to_unit && a.centre == b.centre &&
           a.hits == b.hits && a.depths == b.depths;
}
inline bool same_directions(const DirectionMaps& a, const DirectionMaps& b) {
    return a.parameters == b.parameters && a.frames == b.frames && a.texels == b.texels &&
           std::equal(a.depths.begin(), a.depths.end(), b.depths.begin(), b.depths.end(),
                      [](const DirectionDepth& x, const DirectionDepth& y) {
                          return x.nearest == y.nearest && x.farthest == y.farthest;
                      });
}
inline bool same_volumes(const OcclusionVolume& a, const OcclusionVolume& b) {
    return a.dims == b.dims && a.origin == b.origin && a.spacing == b.spacing && a.blend == b.blend &&
           a.far_size == b.far_size && a.octants == b.octants && a.far == b.far;
}
// same_field, and the other kinds.
inline bool same_kinds(const DisplacementField& a, const DisplacementField& b) {
    return same_field(a, b) && a.lines.has_value() == b.lines.has_value() &&
           (!a.lines || same_lines(*a.lines, *b.lines)) &&
           std::equal(a.directions.begin(), a.directions.end(), b.directions.begin(), b.directions.end(),
                      same_directions) &&
           a.volume.has_value() == b.volume.has_value() && (!a.volume || same_volumes(*a.volume, *b.volume));
}

// All kinds of version 1.1 in one small field.
inline DisplacementField make_all_kinds(std::uint32_t bits = 8) {
    DisplacementField field =
        make_field({Positions::kSlater, 1, Mapping::kConcentric, 5, bits}, Pattern::kSmooth);
    add_optional_sections(field);
    field.lines = make_line_table(line_parameters(4, 8, 3, true), Pattern::kSmooth);
    field.directions.push_back(make_direction_maps({1, 16, 0}, Pattern::kSmooth));
    field.directions.push_back(make_direction_maps({2, 16, 8}, Pattern::kSmooth));
    return field;
}

// And of version 1.2.
inline DisplacementField make_all_kinds_and_volume(std::uint32_t bits = 8) {
    DisplacementField field = make_all_kinds(bits);
    field.volume = make_volume({5, 4, 6}, 3, Pattern::kSmooth);
    return field;
}

}  // namespace dfield::test
