// Baking: Algorithm 1 of the paper. Positional samples on the bounding sphere, a displacement map of each by
// Embree.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "baker/mesh.hpp"
#include "format/field.hpp"

namespace dfield {

struct BakeOptions {
    FieldParameters parameters;    // of bake_field's displacement maps
    int threads = 0;               // 0 = all cores; the result does not depend on it
    bool self_visibility = false;  // also bake the visibility of the mesh's own vertices past itself
    std::uint32_t self_rays = 256;
    // What the plan was chosen within, for the provenance alone: bytes (0: it was not), and of which kinds.
    std::uint64_t budget = 0;
    std::string budget_kind;
    // Called now and then from one thread at a time with the rays traced so far and in all.
    std::function<void(std::uint64_t done, std::uint64_t total)> progress;
    // When set and true the bake ends early with Error(kInterrupted).
    const std::atomic<bool>* cancel = nullptr;
};

struct BakeReport {
    std::uint64_t rays = 0;    // traced, but for the self-occlusion
    double build_seconds = 0;  // acceleration structure
    double trace_seconds = 0;  // rays and storing of distances
    double self_seconds = 0;   // self-occlusion, where asked for
    std::string instruction_set;
};

// A field of displacement maps alone, or with kNoMaps of nothing but sphere and box. Throws InputError for a
// mesh without extent or parameters beyond the format's limits. provenance is filled in.
DisplacementField bake_field(const TriangleMesh& mesh, const BakeOptions& options,
                             BakeReport* report = nullptr);

}  // namespace dfield
