// Lookups of many rays at a time in one instance's field: one set of functions for each instruction set, and
// the plain one (reference.cpp) that they are held to.
#pragma once

#include <cstddef>
#include <cstdint>

#include "rays/ray_query.hpp"

namespace dfield::runtime {

// Rays (x[i], y[i], z[i]) of one origin; the arrays can be read kRayPadding elements past `count`, which is
// at most kRayBlock. Directions are unit to 1e-3. Sets blocked[i] to 1 for each ray that something blocks,
// and leaves the others alone. blocked[kRayBlock] may become anything: the array is longer than that by
// kRayPadding, too.
using AnyHitKernel = void(const RayQuery& query, const float* x, const float* y, const float* z,
                          std::size_t count, std::uint8_t* blocked);
// nearest[i] becomes the t of ray i's first hit where that is smaller.
using DistanceKernel = void(const RayQuery& query, const float* x, const float* y, const float* z,
                            std::size_t count, float* nearest);
// The same for rays that have an origin each. Their hits count from t = 0 on.
using RayAnyHitKernel = void(const Instance& instance, const RayBlock& rays, std::uint8_t* blocked);
using RayDistanceKernel = void(const Instance& instance, const RayBlock& rays, float* nearest);

struct RayKernels {
    AnyHitKernel* any_hits;
    DistanceKernel* distances;
    RayAnyHitKernel* ray_any_hits;
    RayDistanceKernel* ray_distances;
};

// For the displacement maps and for the line table of a field.
struct RayLookups {
    RayKernels maps, lines;
};

const RayLookups& ray_lookups(std::int64_t targets);  // dfield_context::simd_targets
extern const RayLookups kRayLookupsReference;

}  // namespace dfield::runtime
