// An instance of a field with an occlusion volume, as lookups want it, and the lookup itself.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "octants/octant_cones.hpp"
#include "scene.hpp"

namespace dfield::runtime {

struct VolumeCaster {
    explicit VolumeCaster(const Instance& instance);

    const OcclusionVolume* volume;
    glm::mat3 to_grid;  // x_grid = to_grid * x_world + grid_offset, samples at whole numbers
    glm::vec3 grid_offset;
    glm::vec3 last;     // sample of each axis
    float blend;        // 1 over the width of the blend, in samples
    glm::mat3 to_unit;  // as Instance
    glm::vec3 unit_offset;
    glm::mat3 to_world;
    float unit_volume;               // of the unit sphere's space, in the world: |det to_world|
    float bounding_ball;             // radius, world: no more than this ball hides does the object hide
    glm::vec3 box_centre, box_half;  // as Instance
    OctantCones cones;
};

// Receivers of one call, an array a component.
inline constexpr std::size_t kVolumeBlock = 64;
struct VolumeBlock {
    alignas(64) float x[kVolumeBlock], y[kVolumeBlock], z[kVolumeBlock];
    alignas(64) float nx[kVolumeBlock], ny[kVolumeBlock], nz[kVolumeBlock];  // unit
    std::size_t count = 0;  // whole vectors are read: the rest holds numbers that can be computed with
};

// Receivers look from a little off their place, along their normal: where an object's own vertices and what
// touches it see past the layer of matter that the samples know. In samples.
inline constexpr float kOffSurface = 1.5f;

// What of the hemisphere the object leaves open, 0..1, one float a receiver of the block. The kernels are
// within kVolumeError of the reference.
using VolumeKernel = void(const VolumeCaster& caster, const VolumeBlock& receivers, float* visibility);
void volume_visibility_reference(const VolumeCaster& caster, const VolumeBlock& receivers, float* visibility);
VolumeKernel* volume_kernel(std::int64_t targets);
inline constexpr float kVolumeError = 1e-4f;

}  // namespace dfield::runtime
