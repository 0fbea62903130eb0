// The paper's algorithms as it writes them, one vertex after the other: what the vectorised sweeps are held
// against, and what contexts capped at DFIELD_SIMD_SCALAR run.
// M. Singh, C. Yuksel, D. House: Fast Occlusion Sweeping, ISVC 2009.
#pragma once

#include <cstdint>
#include <vector>

#include "volume/grid.hpp"

namespace dfield::runtime::volume::reference {

// Unsigned distances, world units, and the two flags of each vertex.
struct Distances {
    Grid grid;
    std::vector<float> d;
    std::vector<std::uint8_t> inside;  // value >= isovalue
    std::vector<std::uint8_t> frozen;  // initialised: lies on a grid edge that crosses the isovalue
    float signed_at(std::size_t i) const { return inside[i] ? -d[i] : d[i]; }
};

// Section 1.1, the first step: vertices on an edge that crosses the isovalue get their distance to the
// interpolated surface, all others kFar. The surface near such a vertex is the plane through the crossings of
// its edges, the nearest one on each axis; along an axis without a crossing it tilts as the central
// difference says. (The nearest crossing alone, taken as the distance, is up to sqrt(3) times too far where
// the surface is oblique.)
Distances initialise(const Grid& grid, const Samples& samples);
// The estimate d^ of equation 1 from three neighbours' distances.
float estimate(const Grid& grid, float from_x, float from_y, float from_z);
// One diagonal sweep of Table 1.
void sweep_distance(Distances& field, const Sweep& sweep);

// How a field of visibility is swept.
struct Ordinate {
    float wx, wy, wz;  // weights of the neighbours, sum 1; the paper's: 1/3 each
};
// Equations 7 and 8: D / h + shift within [0, 1], of matter with this opacity. Equation 7 has a shift of 1/2.
float transmittance(float distance_in_h, float shift, float alpha);
// Equation 6, into `visibility` (one float a vertex, 1 = open), through vertices of these transmittances.
// V = 1 outside the grid.
void sweep_visibility(const Grid& grid, const Sweep& sweep, const Ordinate& ordinate,
                      const float* transmittance, float* visibility);

}  // namespace dfield::runtime::volume::reference
