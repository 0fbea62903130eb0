// Where a texel of a direction map lies in the map of another direction. IEEE 754 binary64 additions,
// multiplications, divisions and square roots in a stated order only, rounded to fixed point: every machine
// decodes the same. FORMAT.md, "Direction maps (DM00 to DM07)", is normative.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "format/codec_neighbours.hpp"
#include "format/direction_maps.hpp"

namespace dfield::codec {

// A stored direction on its ring of Slater's northern hemisphere.
struct DirectionPlace {
    std::uint32_t ring, j;  // ring 0..n; j < max(1, 4 ring), on ring n < 2n
    Neighbours neighbours;  // among the maps before it
};

// Index of the first direction of a ring.
constexpr std::uint32_t slater_ring_start(std::uint32_t ring) {
    return ring == 0 ? 0 : 1 + 2 * ring * (ring - 1);
}

// Calls visit(index, place) for the stored directions in file order until it answers false.
template<class Visit>
void for_each_stored_direction(std::uint32_t subdivision, const Visit& visit) {
    for (std::uint32_t ring = 0; ring <= subdivision; ++ring) {
        const std::uint32_t before = slater_ring_start(ring > 0 ? ring - 1 : 0),
                            first = slater_ring_start(ring), size = ring == 0 ? 1 : 4 * ring;
        const std::uint32_t stored = ring == subdivision ? size / 2 : size;
        for (std::uint32_t j = 0; j < stored; ++j)
            if (!visit(first + j, DirectionPlace{ring, j, ring_neighbours(before, first, size, j)})) return;
    }
}

// A direction's rectangle and pivot plane.
struct DirectionPlane {
    std::array<double, 3> axis_u, axis_v, direction;
    double centre_u, centre_v, half_u, half_v, depth, slope_u, slope_v;
};
DirectionPlane direction_plane(std::uint32_t subdivision, const DirectionPlace& place,
                               const PackedDirectionFrame& frame);

// The texel (s, t), taken to lie on its map's pivot plane, seen in another map: texel coordinates there,
// whole numbers at the texels' centres, times 2^16.
struct TexelTransform {
    std::int64_t s, s_ds, s_dt, t, t_ds, t_dt;
};
TexelTransform texel_transform(const DirectionPlane& from, const DirectionPlane& to, std::uint32_t map_size);

}  // namespace dfield::codec
