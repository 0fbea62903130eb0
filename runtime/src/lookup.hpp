// One lookup in a displacement field, in the space where the bounding sphere is the unit sphere. Section 3.2
// of the paper, with two additions that FORMAT.md's reader notes explain: the pivot, and lookups from either
// end of a line.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "field.hpp"
#include "format/frame.hpp"
#include "format/hemisphere_map.hpp"
#include "format/sphere_points.hpp"

namespace dfield::runtime {

// The part of the line o + t d inside the unit sphere. t is the caller's parameter: d is not normalised.
struct Chord {
    glm::vec3 middle;      // of the chord, the line's point nearest to the sphere's centre
    glm::vec3 direction;   // d
    float inverse_square;  // 1 / d.d
    float t_middle;        // parameter of `middle`
    float half;            // half the chord's length, in t
    float t_in() const { return t_middle - half; }
    float t_out() const { return t_middle + half; }
};

// False when the line misses the sphere (also for NaN). Written with the nearest point rather than the
// textbook discriminant, which cancels for origins that lie many radii away.
inline bool chord_of_line(const glm::vec3& origin, const glm::vec3& direction, Chord& chord) {
    const float inverse_square = 1 / glm::dot(direction, direction);
    const float t_middle = -glm::dot(origin, direction) * inverse_square;
    const glm::vec3 middle = origin + t_middle * direction;
    const float rest = 1 - glm::dot(middle, middle);
    if (!(rest > 0)) return false;
    chord = {middle, direction, inverse_square, t_middle, std::sqrt(rest * inverse_square)};
    return true;
}

// The two ends that a line can be looked up from: its entry point gives the first hit on it, its exit point,
// looking back, the last.
enum class LineEnd { kEntry, kExit };

struct LineHit {
    bool hit;
    float t;  // on the line; only where hit
};

// Where in a field the answer for a line lies. Apart from reading it, so that a batch can know all its texels
// before it waits for the first.
struct Probe {
    std::uint32_t map, texel;
};

// The nearest positional sample p stands in for the end point, and the direction looked up aims from p at the
// middle of the chord (the pivot), not along d: the parallax between p and the end point is then zero at the
// middle of the sphere, where objects are, instead of constant along the ray.
inline Probe probe_line(const dfield_field& field, const Chord& chord, LineEnd end) {
    const FieldParameters& parameters = field.maps.parameters;
    const float side = end == LineEnd::kEntry ? -chord.half : chord.half;
    const glm::vec3 q = chord.middle + side * chord.direction;
    const std::uint32_t map =
        nearest_sphere_point(parameters.positions, parameters.subdivision, field.points.data(), q);
    const glm::vec3 p = field.points[map];
    const glm::vec3 local = frame_of_normal(-p).to_local(chord.middle - p);
    return {map, direction_texel(parameters.mapping, parameters.map_size, local)};
}

inline const std::uint8_t* texel_address(const dfield_field& field, const Probe& probe) {
    return field.maps.texels.data() + probe.map * field.map_stride +
           (std::size_t{probe.texel} * field.maps.parameters.bits >> 3);
}

inline void prefetch(const std::uint8_t* address) {
#if defined(__GNUC__)
    __builtin_prefetch(address);
#else
    (void)address;
#endif
}

// A texel's distance from its sample, in radii (0..2), or a negative number for a miss. 1 bit: 0 for a hit.
template<int kBits>
float texel_distance(const dfield_field& field, const Probe& probe) {
    const std::uint8_t* const bytes = texel_address(field, probe);
    if constexpr (kBits == 1) {
        return bytes[0] >> (probe.texel & 7) & 1 ? 0 : -1;
    } else if constexpr (kBits == 8) {
        return bytes[0] == kMiss8 ? -1 : static_cast<float>(bytes[0]) * (2.0f / 254.0f);
    } else if constexpr (kBits == 16) {
        const std::uint32_t value = bytes[0] | bytes[1] << 8;
        return value == kMiss16 ? -1 : static_cast<float>(value) * (2.0f / 65534.0f);
    } else {
        const auto value =
            std::bit_cast<float>(std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8 |
                                 std::uint32_t{bytes[2]} << 16 | std::uint32_t{bytes[3]} << 24);
        return value >= kMiss32 ? -1 : 2 * value;
    }
}

template<int kBits>
bool probe_hits(const dfield_field& field, const Probe& probe) {
    return texel_distance<kBits>(field, probe) >= 0;
}

// t of a probe that hits: the hit seen from the sample, carried onto the line by projection.
template<int kBits>
float hit_parameter(const dfield_field& field, const Chord& chord, const Probe& probe) {
    const glm::vec3 p = field.points[probe.map];
    const glm::vec3 aim = chord.middle - p;
    const float inverse_length = 1 / std::sqrt(glm::dot(aim, aim));
    float distance = texel_distance<kBits>(field, probe);
    if constexpr (kBits == 1) {
        // Only a mean depth along the normal is known: the hit lies where the ray is as deep, or at the
        // chord's end.
        const float cosine = -glm::dot(aim, p) * inverse_length;
        const float depth = static_cast<float>(field.maps.mean_depth[probe.map]) * (2.0f / 65535.0f);
        distance = std::min(depth, 2 * cosine * cosine) / std::max(cosine, 1e-6f);
    }
    return chord.t_middle +
           (distance * inverse_length - 1) * glm::dot(aim, chord.direction) * chord.inverse_square;
}

template<int kBits>
LineHit look_up(const dfield_field& field, const Chord& chord, LineEnd end) {
    const Probe probe = probe_line(field, chord, end);
    if (!probe_hits<kBits>(field, probe)) return {false, 0};
    return {true, hit_parameter<kBits>(field, chord, probe)};
}

// Calls visitor.template operator()<bits>() for the field's bit depth, so that loops are compiled for each.
template<class Visitor>
auto with_bits(const dfield_field& field, Visitor&& visitor) {
    switch (field.maps.parameters.bits) {
        case 1:
            return visitor.template operator()<1>();
        case 8:
            return visitor.template operator()<8>();
        case 16:
            return visitor.template operator()<16>();
        default:
            return visitor.template operator()<32>();
    }
}

// First hit on the line at t >= 0, as dfield_scene_trace states it. +infinity for none.
template<int kBits>
float first_hit(const dfield_field& field, const Chord& chord) {
    constexpr float kNone = std::numeric_limits<float>::infinity();
    if (!(chord.t_out() > 0)) return kNone;
    const LineHit first = look_up<kBits>(field, chord, LineEnd::kEntry);
    if (!first.hit) return kNone;
    if (chord.t_in() >= 0) return std::max(first.t, chord.t_in());
    if (first.t >= 0) return first.t;
    const LineHit last = look_up<kBits>(field, chord, LineEnd::kExit);
    return last.hit && last.t > 0 ? last.t : kNone;
}

}  // namespace dfield::runtime
