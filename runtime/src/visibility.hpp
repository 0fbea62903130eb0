// Ambient occlusion ray by ray: for directions around each receiver's normal, and for shared directions where
// fields have nothing faster. Instances that direction maps answer for are left out.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ao.hpp"
#include "scene.hpp"
#include "strided.hpp"

namespace dfield::runtime {

// Visibility of receivers [begin, end), self-visibility not multiplied in; 1 for unusable ones.
void ray_visibility(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                    std::size_t begin, std::size_t end, const Strided<float>& visibility);

// Masks of receivers [begin, end) as dfield_scene_visibility_mask states them; zeros for unusable ones.
void ray_masks(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
               std::size_t begin, std::size_t end, const Strided<std::uint32_t>& masks);

// The same, Ored into masks that hold something already.
void add_ray_masks(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                   std::size_t begin, std::size_t end, const Strided<std::uint32_t>& masks);

}  // namespace dfield::runtime
