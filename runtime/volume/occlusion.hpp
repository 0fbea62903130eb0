// The improved form of occlusion sweeping, over a finished distance field. Four mends to the paper's:
// - several fields an octant, each with weights of its own in equation 6, so that they collapse onto several
//   directions instead of the octant's diagonal; equation 5's geometry term becomes a sum over these
//   ordinates;
// - a transmittance that is 1 from a little below the surface on (tau = D / h + 5/4 within [0, 1]), so that
//   flat walls do not darken themselves; it reads D well below -h/2, which only the finished field has;
// - matter too thin to be so deep would then let light through. In its middle the field has a ridge, where
//   the central differences of D are short: the less |grad D| is than 1, the deeper D counts there;
// - as the vertices beside a wall are still half in its shade, the result of a voxel near the surface is
//   taken a little off it, along the normal.
#pragma once

#include <array>
#include <cstdint>

#include "context.hpp"
#include "volume/grid.hpp"

namespace dfield::runtime::volume {

// An ordinate's direction by its x, y and z within the octant, their sum being 1.
struct Ordinate {
    float x, y, z;
};
constexpr std::size_t kMaxOrdinates = 6;  // an octant
// `count`: 1, 3 or 6. One is the paper's, 1/3 each. Six are all permutations of one triple. Three are its
// cyclic ones, turned the other way round in neighbouring octants: the 24 directions of all octants then are
// the corners of a snub cube, spread more evenly than three mirror images would be.
std::array<Ordinate, kMaxOrdinates> ordinates_of(std::size_t octant, std::size_t count);
// The weights of the x, y and z neighbours in equation 6 with which a field collapses onto this direction:
// upwind differences of w . grad V = 0. Sum 1; where the spacing is the same everywhere, the direction
// itself.
Ordinate weights_of(const Ordinate& direction, const Grid& grid);

constexpr float kPaperShift = 0.5f, kImprovedShift = 1.25f;  // of the transmittance, equation 7 and mended
constexpr float kImprovedThin = 0.7f;    // h by which D counts deeper where its gradient is 0
constexpr float kImprovedOffset = 0.6f;  // h off the surface, where results near it are taken
constexpr float kImprovedDepth = 1.25f;  // h below it, from where on they are not

struct OcclusionJob {
    dfield_context* context = nullptr;
    Grid grid;
    const float* distance = nullptr;  // a float a voxel, signed
    std::size_t ordinates = 3;        // an octant: 1, 3 or 6
    float shift = kImprovedShift, thin = kImprovedThin;
    bool off_surface = true;  // the last mend
    float alpha = 1;          // equation 8
    bool through = false;     // |N.w| for the geometry term
    std::array<float, kOctants> intensities{1, 1, 1, 1, 1, 1, 1, 1};
    std::size_t only = kOctants;  // the one octant to sweep, or kOctants: all that are asked for
    float* visibility = nullptr;  // a float a voxel, out, or null: visibility with D's gradient as normal
    std::uint8_t* octants =
        nullptr;  // as DistanceJob::octants, out, or null: the mean of an octant's ordinates
};

using OcclusionFunction = void(const OcclusionJob& job);
OcclusionFunction* occlusion_function(std::int64_t targets);
void sweep_occlusion_reference(const OcclusionJob& job);

}  // namespace dfield::runtime::volume
