// Baking direction maps (format/direction_maps.hpp): orthographic views of the object, one a direction.
#pragma once

#include <atomic>
#include <cstdint>

#include "baker/bounding_sphere.hpp"
#include "baker/mesh.hpp"
#include "format/direction_maps.hpp"

namespace dfield {

struct DirectionBakeOptions {
    DirectionParameters parameters;
    int threads = 0;                            // 0 = all cores; the result does not depend on it
    const std::atomic<bool>* cancel = nullptr;  // when set and true: ends early with Error(kInterrupted)
};

struct DirectionBakeReport {
    std::uint64_t rays = 0;
    double build_seconds = 0, trace_seconds = 0;
};

// `sphere` is the mesh's bounding sphere. Throws InputError for parameters beyond the format's limits.
DirectionMaps bake_directions(const TriangleMesh& mesh, const BoundingSphere& sphere,
                              const DirectionBakeOptions& options, DirectionBakeReport* report = nullptr);

}  // namespace dfield
