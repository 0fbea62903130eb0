// Baking line tables (format/line_table.hpp): for each chord between two lattice points whether it meets the
// object.
#pragma once

#include <atomic>
#include <cstdint>

#include "baker/bounding_sphere.hpp"
#include "baker/mesh.hpp"
#include "format/line_table.hpp"

namespace dfield {

struct LineBakeOptions {
    LineParameters parameters;
    int threads = 0;                            // 0 = all cores; the result does not depend on it
    const std::atomic<bool>* cancel = nullptr;  // when set and true: ends early with Error(kInterrupted)
};

struct LineBakeReport {
    std::uint64_t rays = 0;
    double build_seconds = 0, trace_seconds = 0;
};

// `sphere` is the mesh's bounding sphere, which the table's space is made from unless the parameters ask for
// the bounding ellipsoid. Throws InputError for parameters beyond the format's limits.
LineTable bake_lines(const TriangleMesh& mesh, const BoundingSphere& sphere, const LineBakeOptions& options,
                     LineBakeReport* report = nullptr);

}  // namespace dfield
