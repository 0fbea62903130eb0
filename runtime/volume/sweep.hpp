// Distance field and occlusion by sweeping, as one job: what the vectorised kernels (sweep.cpp) and the
// reference are asked for.
#pragma once

#include <array>
#include <cstdint>

#include "context.hpp"
#include "volume/grid.hpp"

namespace dfield::runtime::volume {

// Which fields the distance sweeps carry along, in the paper's form (equations 6 and 7).
enum class Carried { kNone, kOctants, kCombined };

struct DistanceJob {
    dfield_context* context = nullptr;
    Grid grid;
    Samples samples;
    float band = kFar;          // world units: distances are cut off here
    float* distance = nullptr;  // a float a voxel, out: signed, > 0 outside; -0 for a zero inside
    Carried carried = Carried::kNone;
    float alpha = 1;                            // equation 8
    std::array<float, kOctants> intensities{};  // kCombined
    // kOctants: 8 bytes a voxel, out: two volumes of four channels, 255 = open; channel s % 4 of volume s / 4
    // is octant s.
    std::uint8_t* octants = nullptr;
    float* combined = nullptr;  // kCombined: a float a voxel, out: the sum of intensity_s V_s
};

enum class SweepResult { kDone, kNotFinite };  // a NaN or an infinity among the samples

using DistanceFunction = SweepResult(const DistanceJob& job);
// The best one among Highway's targets (dfield_context::simd_targets), or the reference.
DistanceFunction* distance_function(std::int64_t targets);
SweepResult sweep_distance_reference(const DistanceJob& job);

}  // namespace dfield::runtime::volume
