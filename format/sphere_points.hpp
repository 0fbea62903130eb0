// Positional samples: points on the unit sphere and the constant-time inverse that finds the sample of a
// point. FORMAT.md, "Positional samples", is normative.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "format/angle.hpp"
#include "format/field.hpp"

namespace dfield {

// All samples in file order. Exact formulas in double, rounded once to float.
std::vector<glm::vec3> sphere_points(Positions positions, std::uint32_t subdivision);

// Slater's subdivision ("Constant Time Queries on Uniformly Distributed Points on a Hemisphere", JGT 7(1),
// 2002): the four faces of a pyramid over the unit disk are cut into n^2 triangles each, which puts max(1,
// 4k) vertices on ring k = 0..n; the rings are pushed out to the sphere at z = 1 - (k/n)^2, so that the rings
// between two heights hold points in proportion to the area there. Two hemispheres share the ring k = n, the
// equator.
struct SlaterRings {
    std::uint32_t n;

    std::uint32_t count() const { return 4 * n * n + 2; }
    // Points before ring k of the northern hemisphere.
    static std::uint32_t first(std::uint32_t k) { return k == 0 ? 0 : 1 + 2 * k * (k - 1); }
    // Index of point j of ring k. The southern rings follow in mirrored order, k = n - 1 down to 0.
    std::uint32_t index(std::uint32_t k, std::uint32_t j, bool south) const {
        return south && k < n ? count() - first(k + 1) + j : first(k) + j;
    }
    // Point on ring k nearest in azimuth; `turns` in [0, 4) quarter turns.
    static std::uint32_t nearest_on_ring(std::uint32_t k, float turns) {
        const auto j = static_cast<std::uint32_t>(turns * static_cast<float>(k) + 0.5f);
        return j < 4 * k ? j : 0;
    }
};

struct LatlongGrid {
    std::uint32_t n;

    std::uint32_t rows() const { return 2 * n + 1; }
    std::uint32_t columns() const { return 2 * n + 2; }
    std::uint32_t count() const { return rows() * columns(); }
};

// The sample of a point on the unit sphere (|q| = 1 to rounding). `points` is sphere_points(kSlater, n).
// Looks at the two rings that enclose q and takes the nearer of the best point on each: two distances,
// whatever n. Within 1.001 of the true nearest distance for all points tried (tests/format/sphere_points.cpp
// holds it to that).
inline std::uint32_t nearest_slater(const SlaterRings& rings, const glm::vec3* points, const glm::vec3& q) {
    const float height = std::fabs(q.z);
    // n sqrt(1 - |z|) without cancellation at the poles.
    const float ring = static_cast<float>(rings.n) * std::sqrt((q.x * q.x + q.y * q.y) / (1 + height));
    const std::uint32_t inner = std::min(static_cast<std::uint32_t>(ring), rings.n - 1);
    const float turns = quarter_turns(q.x, q.y);
    const bool south = q.z < 0;
    const std::uint32_t a = rings.index(inner, SlaterRings::nearest_on_ring(inner, turns), south);
    const std::uint32_t b = rings.index(inner + 1, SlaterRings::nearest_on_ring(inner + 1, turns), south);
    return glm::dot(points[a], q) >= glm::dot(points[b], q) ? a : b;
}

// The cell of the latitude-longitude grid that holds the point. Not the nearest sample towards the poles,
// where columns crowd (that is why the paper drops this layout); within 1.1 times its distance.
inline std::uint32_t nearest_latlong(const LatlongGrid& grid, const glm::vec3& q) {
    const float polar =
        quarter_turns(q.z, std::sqrt(q.x * q.x + q.y * q.y));  // theta in [0, 2] quarter turns
    const auto row =
        std::min(static_cast<std::uint32_t>(polar * 0.5f * static_cast<float>(grid.rows())), grid.rows() - 1);
    const auto column = static_cast<std::uint32_t>(
        quarter_turns(q.x, q.y) * 0.25f * static_cast<float>(grid.columns()) + 0.5f);
    return row * grid.columns() + (column < grid.columns() ? column : 0);
}

inline std::uint32_t nearest_sphere_point(Positions positions, std::uint32_t subdivision,
                                          const glm::vec3* points, const glm::vec3& q) {
    return positions == Positions::kSlater ? nearest_slater({subdivision}, points, q)
                                           : nearest_latlong({subdivision}, q);
}

}  // namespace dfield
