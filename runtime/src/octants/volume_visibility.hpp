// Ambient occlusion by instances whose kind is an occlusion volume: how much of the hemisphere each leaves
// open, multiplied. Two objects that hide the same part of the sky count twice.
#pragma once

#include "ao.hpp"
#include "scene.hpp"
#include "strided.hpp"

namespace dfield::runtime {

// What of a scene volumes answer for: nothing; some instances; or all that occludes, ground included.
enum class VolumeShare { kNone, kSome, kAll };
VolumeShare volume_share(const SceneState& scene, const dfield_ao& ao);

// Multiplies the visibility of all receivers past those instances that volumes answer for; unusable receivers
// stay as they are. On the calling thread.
void multiply_volume_visibility(const SceneState& scene, const dfield_ao& ao,
                                const dfield_receivers& receivers, const Strided<float>& visibility);

}  // namespace dfield::runtime
