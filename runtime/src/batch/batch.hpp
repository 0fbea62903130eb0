// Many receivers against many instances at once, for shared directions and fields with direction maps.
//
// What batch_visibility() and batch_masks() are made of, for who keeps chunks and masks from frame to frame:
// build_chunk(), BatchKernels::find_facing for each slab of directions, then BatchKernels::add_caster for
// each instance, which Ors pairs into masks. A pair's bit depends on nothing but receiver, direction and
// instance: not on the chunk, nor on the other instances. So the pairs that an instance blocks can be found
// by asking it alone with empty masks, and pairs whose bit is 1 already ("closed") are not looked at where
// all of a block's are.
#pragma once

#include <cstdint>
#include <span>

#include "ao.hpp"
#include "batch/chunk.hpp"
#include "scene.hpp"
#include "strided.hpp"

namespace dfield::runtime {

// The caster that an instance is for these settings; the instance's field has direction maps.
DirectionCaster direction_caster(const dfield_ao& ao, const Instance& instance, dfield_instance id);

// For which instances of a scene, but for those of occlusion volumes, batches answer these settings.
enum class BatchShare { kNone, kSome, kAll };
BatchShare batch_share(const SceneState& scene, const dfield_ao& ao);

// Visibility of all receivers, self-visibility not multiplied in; 1 for unusable ones. On the calling thread.
// Past those instances that batches answer for.
void batch_visibility(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                      const Strided<float>& visibility);

// Masks of all receivers as dfield_outputs states them, as above.
void batch_masks(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                 const Strided<std::uint32_t>& masks);

}  // namespace dfield::runtime
