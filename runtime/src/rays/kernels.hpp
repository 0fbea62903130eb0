// Lookups of many rays at a time in one instance's field: one set of functions for each instruction set, and
// the plain one (reference.cpp) that they are held to.
#pragma once

#include <cstddef>
#include <cstdint>

#include "rays/ray_query.hpp"

namespace dfield::runtime {

// Rays of one origin; directions are unit to 1e-3. Clears the bit of each open ray that something blocks.
using AnyHitKernel = void(const RayQuery& query, const GroupedRays& rays, RayBits& open);
// nearest[i] becomes the t of ray i's first hit where that is smaller.
using DistanceKernel = void(const RayQuery& query, const GroupedRays& rays, float* nearest);
// The same for rays that have an origin each. Their hits count from t = 0 on.
using RayAnyHitKernel = void(const Instance& instance, const RayBlock& rays, RayBits& open);
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
