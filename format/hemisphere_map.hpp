// Directional samples: the texels of a displacement map as directions of the hemisphere around +z, and back.
// FORMAT.md, "Directional samples", is normative. Sources: the paper, section 3.4; Shirley and Chiu, "A Low
// Distortion Map Between Disk and Square" (JGT 2(3), 1997); Malley's method lifts the disk onto the
// hemisphere.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "format/angle.hpp"
#include "format/field.hpp"

namespace dfield {

// Square [-1,1]^2 to unit disk, area-preserving up to the constant pi/4.
glm::dvec2 concentric_disk(const glm::dvec2& square);

// The direction of texel (s, t)'s centre; exact formulas in double, rounded once to float. For the rejection
// mapping the corners of the square hold no direction: z is then negative and the texel is unused (always
// stored as a miss).
glm::vec3 texel_direction(Mapping mapping, std::uint32_t map_size, std::uint32_t s, std::uint32_t t);

// Directions of all texels, row by row.
std::vector<glm::vec3> map_directions(Mapping mapping, std::uint32_t map_size);

// `count` directions of cosine-weighted density around +z, each of weight 1/count: the concentric map's texel
// centres when count is a square (the paper's "256 concentric-map rays"), otherwise a Vogel spiral lifted by
// Malley's method.
std::vector<glm::vec3> cosine_directions(std::uint32_t count);

// `count` directions spread evenly over the whole sphere, in opposite pairs: i < ceil(count / 2) the upper
// half of the spherical Fibonacci points, z = 1 - (2i + 1) / count, azimuth i times the golden angle, in
// double, rounded once to float; then these, as many as are left, negated. So a line's two ends are looked up
// at once.
std::vector<glm::vec3> fibonacci_sphere(std::uint32_t count);

// `count` (a square) directions on the polar grid, as the paper's "uniform" ray sampling: even in theta and
// phi. The weights that make them an estimate of the cosine-weighted integral are returned beside them; they
// sum to 1.
std::vector<glm::vec3> polar_directions(std::uint32_t count, std::vector<float>& weights);

namespace detail {
inline std::uint32_t texel_of(float unit, std::uint32_t map_size) {  // unit in [0,1] up to rounding
    const float scaled = unit * static_cast<float>(map_size);
    if (!(scaled > 0)) return 0;
    return std::min(static_cast<std::uint32_t>(scaled), map_size - 1);
}
}  // namespace detail

// The texel, t * map_size + s, whose cell holds the direction (x, y, z) around +z: z >= 0, of any length but
// zero.
inline std::uint32_t concentric_texel(std::uint32_t map_size, const glm::vec3& w) {
    const float squared = w.x * w.x + w.y * w.y;
    const float radius = std::sqrt(squared / (squared + w.z * w.z));  // on the unit disk
    float a, b;
    if (std::fabs(w.x) >= std::fabs(w.y)) {
        a = std::copysign(radius, w.x);
        b = w.x != 0 ? a * 2 * quarter_turns_of_slope(w.y / w.x) : 0.0f;
    } else {
        b = std::copysign(radius, w.y);
        a = b * 2 * quarter_turns_of_slope(w.x / w.y);
    }
    return detail::texel_of(0.5f * b + 0.5f, map_size) * map_size +
           detail::texel_of(0.5f * a + 0.5f, map_size);
}

inline std::uint32_t polar_texel(std::uint32_t map_size, const glm::vec3& w) {
    const float theta =
        quarter_turns(w.z, std::sqrt(w.x * w.x + w.y * w.y));  // quarter turns: 1 at the horizon
    return detail::texel_of(theta, map_size) * map_size +
           detail::texel_of(0.25f * quarter_turns(w.x, w.y), map_size);
}

inline std::uint32_t rejection_texel(std::uint32_t map_size, const glm::vec3& w) {
    const auto m = static_cast<float>(map_size);
    const auto unused = [&](std::uint32_t s, std::uint32_t t) {
        const float a = (2 * static_cast<float>(s) + 1) / m - 1, b = (2 * static_cast<float>(t) + 1) / m - 1;
        return a * a + b * b > 1;
    };
    const float to_disk = 1 / std::sqrt(w.x * w.x + w.y * w.y + w.z * w.z);
    const float x = w.x * to_disk, y = w.y * to_disk;
    std::uint32_t s = detail::texel_of(0.5f * x + 0.5f, map_size);
    std::uint32_t t = detail::texel_of(0.5f * y + 0.5f, map_size);
    if (unused(s, t)) {
        // The rim of the disk falls into cells whose centre lies outside. Moving in by half a cell's diagonal
        // ends in a cell whose centre is inside.
        const float scale = std::max(0.0f, 1 - 1.42f / m) / std::sqrt(x * x + y * y);
        s = detail::texel_of(0.5f * x * scale + 0.5f, map_size);
        t = detail::texel_of(0.5f * y * scale + 0.5f, map_size);
    }
    return t * map_size + s;
}

inline std::uint32_t direction_texel(Mapping mapping, std::uint32_t map_size, const glm::vec3& w) {
    switch (mapping) {
        case Mapping::kConcentric:
            return concentric_texel(map_size, w);
        case Mapping::kPolar:
            return polar_texel(map_size, w);
        default:
            return rejection_texel(map_size, w);
    }
}

}  // namespace dfield
