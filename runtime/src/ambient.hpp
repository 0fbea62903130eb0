// Ambient occlusion by whichever code answers an ambient occlusion setting.
#pragma once

#include <cstdint>

#include "ao.hpp"
#include "scene.hpp"
#include "strided.hpp"

namespace dfield::runtime {

// Visibility of all receivers, self-visibility not multiplied in; 1 for unusable ones. On the calling thread.
void receiver_visibility(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                         const Strided<float>& visibility);

// Masks of all receivers as dfield_outputs states them. On the calling thread.
void receiver_masks(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                    const Strided<std::uint32_t>& masks);

}  // namespace dfield::runtime
