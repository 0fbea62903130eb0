// The same receivers and the same rays by lookup and by Embree: how far apart the results are, how fast both
// are.
#pragma once

#include <cstddef>
#include <glm/mat4x4.hpp>
#include <string>
#include <vector>

#include "baker/cli/report.hpp"
#include "baker/cli/runtime_scene.hpp"
#include "baker/mesh.hpp"

namespace dfield::cli {

struct ComparisonCaster {
    const TriangleMesh* mesh;  // kept by the caller
    std::size_t field;         // index into ComparisonInput::fields
    glm::mat4 transform{1};
};

// Receivers that one caster owns: it does not occlude them on either side. kNoOwner: all casters do.
struct ReceiverGroup {
    static constexpr std::size_t kNoOwner = static_cast<std::size_t>(-1);
    Receivers receivers;
    std::size_t owner = kNoOwner;
};

struct ComparisonInput {
    std::vector<std::vector<std::byte>> fields;  // .dfield bytes of each distinct mesh
    std::vector<ComparisonCaster> casters;
    std::vector<ReceiverGroup> groups;
    // Around +z and each receiver's normal; or shared by all receivers, in world space, each then of weight
    // max(0, n.w) and a pair with the receivers that face it only.
    std::vector<glm::vec3> directions;
    bool shared = false;
    std::vector<float> weights;           // of directions around +z; empty: even
    dfield_kind kind = DFIELD_KIND_AUTO;  // that the lookup is forced to
    std::uint32_t converged_rays = 4096;
    int threads = 1;
    int repetitions = 5;  // the fastest of them counts, on both sides
};

struct Comparison {
    std::string kind;  // that the lookup used: maps, lines, directions or volume
    std::size_t receivers = 0, rays = 0, rays_per_receiver = 0;
    // Visibility by lookup minus by ray casting, times 255.
    double rms_grey = 0, bias_grey = 0, max_grey = 0, rms_grey_converged = 0;
    double percentile_50 = 0, percentile_90 = 0, percentile_95 = 0,
           percentile_99 = 0;      // of the absolute error
    bool knows_rays = true;        // whether the lookup can tell which rays are blocked
    double disagree_fraction = 0;  // rays that one side blocks and the other does not, where it can
    double sphere_hit_fraction = 0;
    double lookup_seconds = 0, embree_seconds = 0;
    double lookup_mrays_per_s = 0, embree_mrays_per_s = 0, speedup = 0, speedup_sphere_hits = 0;
    std::string embree_mode;
    std::vector<std::pair<std::string, double>> embree_modes;  // Mray/s of every mode measured
    std::uint64_t field_bytes = 0, file_bytes = 0;
    // One value a receiver, groups in order.
    std::vector<float> lookup, reference;

    Json json() const;
};

Comparison compare(const ComparisonInput& input);

}  // namespace dfield::cli
