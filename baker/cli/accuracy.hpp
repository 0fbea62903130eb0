// How far fields are from ray casting in the standard scenes, without timing: rays are cast once for a scene,
// then any number of fields is looked up.
#pragma once

#include <cstdint>
#include <vector>

#include "baker/cli/report.hpp"
#include "baker/cli/runtime_scene.hpp"
#include "baker/mesh.hpp"

namespace dfield::cli {

// The standard scenes, in the order in which reports name them.
struct StandardScene {
    const char* name;
    float gap;  // between the caster's box and the planes, in its longest sides
};
inline constexpr StandardScene kStandardScenes[] = {{"corner", 0.1f}, {"corner-contact", 0}};

// Visibility by lookup minus by ray casting, times 255.
struct Accuracy {
    double rms_grey = 0, bias_grey = 0, max_grey = 0;  // against the same rays
    double rms_grey_converged = 0;                     // against many more

    Json json() const;
};

// A mesh in one of the scenes, and what Embree's rays see there.
//
// All kinds are asked about the same directions, kAccuracyDirections that all receivers share, which every
// kind can answer. Each kind's own way of sampling would mix two things: what a field gets wrong of a ray,
// and what so many rays get wrong of the sky. The latter belongs to whoever queries and falls with the number
// of rays (bunny: 1.8 grey for 256 rays of each receiver, 1.4 for these 512); it is larger than what kinds
// differ by.
class AccuracyScene {
  public:
    static constexpr std::uint32_t kAccuracyDirections = 512, kConvergedRays = 1024;

    AccuracyScene(const TriangleMesh& mesh, float gap, int threads);

    // The errors of one kind that the field, of this context, holds.
    Accuracy measure(const Context& context, const Field& field, dfield_kind kind) const;

  private:
    Receivers receivers_;
    std::vector<glm::vec3> directions_;
    std::vector<float> same_rays_, converged_;
};

}  // namespace dfield::cli
