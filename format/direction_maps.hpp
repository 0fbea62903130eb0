// Direction maps: for each of some directions, whether the line along it through a point of a plane hits the
// object. The direction-point parameterization of lines, after which batches of receivers that share their
// directions are lit. FORMAT.md, "Direction maps", is normative.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <string>
#include <vector>

namespace dfield {

inline constexpr std::uint32_t kMaxDirectionSubdivision = 128;
inline constexpr std::uint32_t kMaxDirectionMapSize = 128;

struct DirectionParameters {
    // n: directions are Slater's 4n^2+2 points of the sphere. A line has no sense, so antipodal directions
    // share a map: 2n^2+1 are stored.
    std::uint32_t subdivision = 16;  // 1..kMaxDirectionSubdivision
    std::uint32_t map_size = 32;     // m: 16, 32, 64 or 128. A map has m x m texels
    std::uint32_t depth_size = 0;  // texels along a side of the depth maps: 0 (none), or 8 .. m, a power of 2

    bool operator==(const DirectionParameters&) const = default;
};

// Directions in all, 4n^2+2, and those stored, 2n^2+1: the first ones in Slater's order, the northern
// hemisphere and half of the equator.
constexpr std::uint32_t direction_count(std::uint32_t subdivision) {
    return 4 * subdivision * subdivision + 2;
}
constexpr std::uint32_t stored_direction_count(std::uint32_t subdivision) {
    return 2 * subdivision * subdivision + 1;
}
// The largest n whose 4n^2+2 directions are at most `count`, at least 1.
std::uint32_t direction_subdivision(std::uint32_t count);

// Words of one map: m*m/32.
constexpr std::uint32_t direction_map_words(std::uint32_t map_size) {
    return map_size * map_size / 32;
}

// Empty when the parameters are within the format's limits, otherwise what is wrong and what is allowed.
std::string direction_parameters_error(const DirectionParameters& parameters);

// Bytes of one level in memory: frames, texels, depths.
constexpr std::uint64_t direction_maps_bytes(const DirectionParameters& p) {
    return stored_direction_count(p.subdivision) *
           (8 + 4ull * direction_map_words(p.map_size) + 2ull * p.depth_size * p.depth_size);
}

// A stored direction's rectangle and pivot plane as the file holds them, each a byte q:
//   0     angle of the rectangle in the direction's frame: tan(angle / 2) = q / 256, so within [0, pi/2)
//   1, 2  centre along the rectangle's axes: (q - 128) / 128
//   3, 4  half extents: (q + 1) / 256
//   5     depth of the pivot plane at the centre, along the direction: (q - 128) / 128
//   6, 7  its slopes along the axes: (q - 128) / 64
// all in the space where the bounding sphere is the unit sphere.
using PackedDirectionFrame = std::array<std::uint8_t, 8>;

// The same, decoded. A point x of that space has rectangle coordinates u = (x.axis_u - centre_u) / half_u, v
// alike, which the rectangle holds within [-1, 1].
struct DirectionFrame {
    glm::vec3 axis_u, axis_v, direction;  // orthonormal, axis_u x axis_v = direction
    float centre_u, centre_v, half_u, half_v;
    float depth, slope_u,
        slope_v;  // pivot: x.direction = depth + slope_u (x.axis_u - centre_u) + slope_v ...
};
DirectionFrame unpack_direction_frame(const PackedDirectionFrame& packed, const glm::vec3& direction);

// A depth texel: the nearest and the farthest hit of the line along +direction, as x.direction of the unit
// sphere's space: (q - 127.5) / 127.5, nearest rounded down, farthest up. {255, 0}: no hit.
struct DirectionDepth {
    std::uint8_t nearest, farthest;
};

// One level of detail of an object's direction maps.
struct DirectionMaps {
    explicit DirectionMaps(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
        : frames(memory), texels(memory), depths(memory) {}

    DirectionParameters parameters;
    std::pmr::vector<PackedDirectionFrame> frames;  // one a stored direction
    // Maps in order of stored directions, rows (v) of m texels (u), 32 texels a word, least significant bit
    // first, 1 = the line through the texel's centre hits. m = 16: two rows a word; m = 64: two words a row.
    std::pmr::vector<std::uint32_t> texels;
    // depth_size^2 a stored direction, row by row; a depth texel covers the texels of its square. May be
    // empty.
    std::pmr::vector<DirectionDepth> depths;

    std::uint64_t memory_bytes() const {
        return frames.size() * sizeof(PackedDirectionFrame) + texels.size() * sizeof(std::uint32_t) +
               depths.size() * sizeof(DirectionDepth);
    }
};

// How far from the sphere's centre (in radii) a line that hits can cross its direction's pivot plane.
float direction_reach(const DirectionMaps& maps);

// Stored direction `index`.
glm::vec3 stored_direction(std::uint32_t subdivision, std::uint32_t index);

// The stored direction that stands for k (unit) or -k; `flipped` where it is -k. Nearest up to the rounding
// of ring and azimuth.
struct NearestDirection {
    std::uint32_t index;
    bool flipped;
};
NearestDirection nearest_direction(std::uint32_t subdivision, const glm::vec3& k);

}  // namespace dfield
