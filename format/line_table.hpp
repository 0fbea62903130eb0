// A line table in memory: for every chord of the unit sphere whether the object meets it. The literature's
// two-sphere parameterization. FORMAT.md, "Line tables", is normative for every rule stated here.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <string>
#include <vector>

namespace dfield {

// Limits of the format; a file or a bake beyond them is refused.
inline constexpr std::uint32_t kMinLineLattice = 2;
inline constexpr std::uint32_t kMaxLineLattice = 128;
inline constexpr std::uint64_t kMaxLineTableBytes = std::uint64_t{1} << 28;

struct LineParameters {
    std::uint32_t lattice = 24;        // s: s*s points on the sphere, kMinLineLattice..kMaxLineLattice
    std::uint32_t depth_bits = 4;      // 0: no depths are stored; 4 or 8
    std::uint32_t depth_lattice = 16;  // lattice of the depths, as above; 0 without depths
    // How lines are looked up, in FORMAT.md's lookup rule: by the nearest chord of the lattice (neither), by
    // one that aims at the middle of the line's own chord, or by the majority of the 16 chords around. Never
    // both.
    bool pivot = false;
    bool filtered = false;
    bool ellipsoid = true;  // the unit sphere is a bounding ellipsoid, else the bounding sphere

    bool operator==(const LineParameters&) const = default;
};

// Empty when the parameters are within the format's limits, otherwise what is wrong and what is allowed.
std::string line_parameters_error(const LineParameters& parameters);

// Points of a lattice: s*s.
constexpr std::uint32_t lattice_point_count(std::uint32_t lattice) {
    return lattice * lattice;
}

// Hits are symmetric, a chord has two ends: one bit for each unordered pair of points, n(n+1)/2 of them, the
// pair (a, a) included.
constexpr std::uint64_t line_hit_count(const LineParameters& parameters) {
    const std::uint64_t n = lattice_point_count(parameters.lattice);
    return n * (n + 1) / 2;
}

// Depths are not: one for each ordered pair.
constexpr std::uint64_t line_depth_count(const LineParameters& parameters) {
    const std::uint64_t n = lattice_point_count(parameters.depth_lattice);
    return parameters.depth_bits == 0 ? 0 : n * n;
}

// 32-bit words that hold them; the bits after the last value are 0.
constexpr std::uint64_t line_hit_words(const LineParameters& parameters) {
    return (line_hit_count(parameters) + 31) / 32;
}
constexpr std::uint64_t line_depth_words(const LineParameters& parameters) {
    return (line_depth_count(parameters) * parameters.depth_bits + 31) / 32;
}

struct LineTable {
    explicit LineTable(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
        : hits(memory), depths(memory) {}

    LineParameters parameters;

    // The map from object space to the table's space, where the bounding sphere or ellipsoid is the unit
    // sphere: x_unit = to_unit * (x - centre). Invertible.
    glm::mat3 to_unit{1};
    glm::vec3 centre{0};

    // Bit hit_index(a, b): whether something is on the chord between the points a and b. Bit i is bit i % 32
    // (1 = least significant) of word i / 32. line_hit_words(parameters) words.
    std::pmr::vector<std::uint32_t> hits;

    // Value depth_index(a, b): where on the chord from a to b the *last* hit lies. 0: nothing on it;
    // otherwise it lies (value - 1) / (2^bits - 2) of the chord's length from a. Value i takes depth_bits
    // bits from bit i * depth_bits on, counted as above. line_depth_words(parameters) words, none without
    // depths.
    std::pmr::vector<std::uint32_t> depths;

    std::uint64_t memory_bytes() const { return 4 * (hits.size() + depths.size()); }
};

// The bit of an unordered pair of lattice points.
constexpr std::uint32_t hit_index(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t low = a < b ? a : b, high = a < b ? b : a;
    return high * (high + 1) / 2 + low;
}

// The depth of an ordered pair, n points.
constexpr std::uint32_t depth_index(std::uint32_t a, std::uint32_t b, std::uint32_t n) {
    return a * n + b;
}

inline bool stored_hit(const LineTable& table, std::uint32_t a, std::uint32_t b) {
    const std::uint32_t i = hit_index(a, b);
    return (table.hits[i / 32] >> (i % 32) & 1) != 0;
}

// Raw value of a depth, 0 = nothing on the chord. The table has depths.
inline std::uint32_t stored_depth(const LineTable& table, std::uint32_t a, std::uint32_t b) {
    const std::uint32_t bits = table.parameters.depth_bits;
    const std::uint32_t i = depth_index(a, b, lattice_point_count(table.parameters.depth_lattice)) * bits;
    return table.depths[i / 32] >> (i % 32) & ((1u << bits) - 1);
}

// --- The lattice: the octahedral map with cells of nearly equal area. Before the projection onto the
// octahedron each coordinate is warped to |x| (1 + k |x|); with k = 0.75 the cells' areas are within some
// percent of each other, where the plain octahedral map's differ by 5.2. Point j s + i is the middle of cell
// (i, j) of the square.

inline constexpr float kLatticeWarp = 0.75f;

// Where q, a point of the unit sphere (up to rounding; q need not be more exact than that), lies in the
// square, in cells: both coordinates are within 0 .. lattice.
inline glm::vec2 lattice_square(std::uint32_t lattice, const glm::vec3& q) {
    const float x = std::fabs(q.x), y = std::fabs(q.y), z = std::fabs(q.z);
    const float gx = x + kLatticeWarp * x * x, gy = y + kLatticeWarp * y * y, gz = z + kLatticeWarp * z * z;
    const float half = 0.5f / (gx + gy + gz);
    float u = gx * half, v = gy * half;  // 0 .. 1/2
    if (q.z < 0) {                       // the lower half is folded out, over the edge u + v = 1/2
        const float swap = u;
        u = 0.5f - v;
        v = 0.5f - swap;
    }
    return static_cast<float>(lattice) *
           glm::vec2(0.5f + std::copysign(u, q.x), 0.5f + std::copysign(v, q.y));
}

// The point whose cell holds q.
inline std::uint32_t nearest_lattice_point(std::uint32_t lattice, const glm::vec3& q) {
    const glm::vec2 place = lattice_square(lattice, q);
    const auto cell = [&](float value) {  // NaN goes to 0
        return static_cast<std::uint32_t>(std::min(std::max(0.0f, value), static_cast<float>(lattice - 1)));
    };
    return cell(place.y) * lattice + cell(place.x);
}

// The point of cell (i, j), each within -1 .. lattice: a cell beyond an edge of the square is its neighbour
// on the sphere, which lies on the same edge, mirrored in the edge's middle.
inline std::uint32_t wrapped_lattice_point(std::uint32_t lattice, std::int32_t i, std::int32_t j) {
    const auto last = static_cast<std::int32_t>(lattice) - 1;
    const bool beyond_i = i < 0 || i > last, beyond_j = j < 0 || j > last;
    const std::int32_t column = std::clamp(beyond_j ? last - i : i, 0, last);
    const std::int32_t row = std::clamp(beyond_i ? last - j : j, 0, last);
    return static_cast<std::uint32_t>(row) * lattice + static_cast<std::uint32_t>(column);
}

// The four points around q, and each one's share of it; the shares sum to 1. Bilinear in the square, but with
// a wider reach than interpolation has: where q is a point of the lattice, its neighbours still have 1/8 on
// each axis. Measured against shares that interpolate, filtered lines are wrong by 5 to 8% less.
inline constexpr float kShareSlope = 0.75f, kLeastShare = 0.5f - 0.5f * kShareSlope;

struct LatticeNeighbours {
    std::array<std::uint32_t, 4> points;
    std::array<float, 4> shares;
};

inline LatticeNeighbours lattice_neighbours(std::uint32_t lattice, const glm::vec3& q) {
    const glm::vec2 place = lattice_square(lattice, q) - 0.5f;
    const glm::vec2 low = glm::floor(place), f = kLeastShare + kShareSlope * (place - low);
    const auto cell = [&](float value) {  // NaN goes to -1
        return static_cast<std::int32_t>(std::min(std::max(-1.0f, value), static_cast<float>(lattice - 1)));
    };
    const std::int32_t i = cell(low.x), j = cell(low.y);
    return {{wrapped_lattice_point(lattice, i, j), wrapped_lattice_point(lattice, i + 1, j),
             wrapped_lattice_point(lattice, i, j + 1), wrapped_lattice_point(lattice, i + 1, j + 1)},
            {(1 - f.x) * (1 - f.y), f.x * (1 - f.y), (1 - f.x) * f.y, f.x * f.y}};
}

// The point of the sphere at a place in the cell of this index, by default its middle, which is the lattice's
// point; computed in double and rounded once. Unit.
glm::vec3 lattice_point(std::uint32_t lattice, std::uint32_t index, const glm::dvec2& in_cell = {0.5, 0.5});

// All of them in the order of their indices.
std::vector<glm::vec3> lattice_points(std::uint32_t lattice);

}  // namespace dfield
