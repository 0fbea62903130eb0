// Ambient occlusion through the C ABI: checks arguments and hands ranges of receivers to what answers them.
#include "ambient.hpp"

#include <algorithm>
#include <array>

#include "batch/batch.hpp"
#include "gather.hpp"
#include "kind.hpp"
#include "octants/volume_visibility.hpp"
#include "receivers.hpp"
#include "status.hpp"
#include "visibility.hpp"

namespace dfield::runtime {
namespace {

constexpr std::size_t kMaskBuffer = 8192;  // words on the stack: 32 KiB
constexpr std::size_t kFloatBuffer = 4096;
constexpr std::size_t kBatchGrain = 1024;

// Where some instances have direction maps and others have not: what either part blocks, together.
void mixed_visibility(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                      const Strided<float>& visibility) {
    const ReceiverReader reader(receivers);
    const GatherKernels kernels = gather_kernels(scene.context()->simd_targets);
    const std::size_t words = ao.mask_words(), at_once = kMaskBuffer / words;
    std::array<std::uint32_t, kMaskBuffer> buffer;
    const Strided<std::uint32_t> masks(buffer.data(), 0, words);
    for (std::size_t first = 0; first < receivers.count; first += at_once) {
        const std::size_t count = std::min(at_once, receivers.count - first);
        receiver_masks(scene, ao, receivers_from(receivers, first, count), masks);
        for (std::size_t k = 0; k < count; ++k)
            *visibility.at(first + k) = mask_visibility(kernels, ao, reader[first + k].normal, masks.at(k));
    }
}

}  // namespace

namespace {

void visibility_by_rays(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                        const Strided<float>& visibility) {
    switch (batch_share(scene, ao)) {
        case BatchShare::kAll:
            return batch_visibility(scene, ao, receivers, visibility);
        case BatchShare::kSome:
            return mixed_visibility(scene, ao, receivers, visibility);
        case BatchShare::kNone:
            return ray_visibility(scene, ao, receivers, 0, receivers.count, visibility);
    }
}

}  // namespace

void receiver_visibility(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                         const Strided<float>& visibility) {
    const VolumeShare volumes = volume_share(scene, ao);
    if (volumes == VolumeShare::kAll)
        for (std::size_t i = 0; i < receivers.count; ++i) *visibility.at(i) = 1;
    else
        visibility_by_rays(scene, ao, receivers, visibility);
    if (volumes != VolumeShare::kNone) multiply_volume_visibility(scene, ao, receivers, visibility);
}

void receiver_masks(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                    const Strided<std::uint32_t>& masks) {
    const BatchShare share = batch_share(scene, ao);
    if (share == BatchShare::kNone) return ray_masks(scene, ao, receivers, 0, receivers.count, masks);
    batch_masks(scene, ao, receivers, masks);
    if (share == BatchShare::kSome) add_ray_masks(scene, ao, receivers, 0, receivers.count, masks);
}

namespace {

void require_receivers(const dfield_ao* ao, const dfield_receivers* receivers, const void* output) {
    require(ao && receivers && output, "scene, ao, receivers or the output is null");
    require(receivers->count == 0 || (receivers->positions && receivers->normals),
            "the receivers' positions or normals are null");
}

// Visibility alone: straight to where it goes, or by way of some floats on the stack.
void write_visibility(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
                      std::size_t begin, std::size_t end, const OutputWriter& writer) {
    const Strided<const float> self(receivers.self_visibility, receivers.self_visibility_stride, 1);
    if (const Strided<float>& visibility = writer.visibility_alone(); visibility && !self)
        return receiver_visibility(scene, ao, receivers_from(receivers, begin, end - begin),
                                   visibility.from(begin));
    std::array<float, kFloatBuffer> values;
    for (std::size_t first = begin; first < end; first += values.size()) {
        const std::size_t count = std::min(values.size(), end - first);
        receiver_visibility(scene, ao, receivers_from(receivers, first, count), {values.data(), 0, 1});
        for (std::size_t k = 0; k < count; ++k)
            writer.write_visibility(first + k, self ? values[k] * *self.at(first + k) : values[k]);
    }
}

// Everything: masks first, in the caller's memory or on the stack, then what follows from them.
void write_all(const SceneState& scene, const dfield_ao& ao, const dfield_receivers& receivers,
               std::size_t begin, std::size_t end, const OutputWriter& writer) {
    const ReceiverReader reader(receivers);
    const Strided<const float> self(receivers.self_visibility, receivers.self_visibility_stride, 1);
    const GatherKernels kernels = gather_kernels(scene.context()->simd_targets);
    const std::size_t words = ao.mask_words(), at_once = std::min(kMaskBuffer / words, kFloatBuffer);
    std::array<std::uint32_t, kMaskBuffer> buffer;
    std::array<float, kFloatBuffer> values;
    for (std::size_t first = begin; first < end; first += at_once) {
        const std::size_t count = std::min(at_once, end - first);
        const dfield_receivers part = receivers_from(receivers, first, count);
        const Strided<std::uint32_t> masks =
            writer.masks() ? writer.masks().from(first) : Strided<std::uint32_t>(buffer.data(), 0, words);
        receiver_masks(scene, ao, part, masks);
        const bool by_distance = writer.wants_visibility() && ao.falloff != DFIELD_FALLOFF_NONE;
        if (by_distance) receiver_visibility(scene, ao, part, {values.data(), 0, 1});
        for (std::size_t k = 0; k < count; ++k) {
            const UnitReceiver receiver = reader[first + k];
            float visibility = by_distance ? values[k] : 1;
            if (writer.wants_visibility() && !by_distance)
                visibility = mask_visibility(kernels, ao, receiver.normal, masks.at(k));
            writer.write(first + k, receiver.normal, masks.at(k),
                         self ? visibility * *self.at(first + k) : visibility);
        }
    }
}

}  // namespace
}  // namespace dfield::runtime

extern "C" {

dfield_status dfield_scene_ambient(const dfield_scene* scene, const dfield_ao* ao,
                                   const dfield_receivers* receivers, const dfield_outputs* outputs) {
    using namespace dfield::runtime;
    return guarded([&] {
        require(scene, "dfield_scene_ambient: scene is null");
        require_receivers(ao, receivers, outputs);
        const SceneState& state = scene->state;
        const OutputWriter writer(*ao, *outputs);
        require_kinds(*ao, state, writer.masks() || writer.wants_moments());
        // Batches live on receivers that lie together: they are not split as finely as single ones.
        const bool batches =
            batch_share(state, *ao) != BatchShare::kNone || volume_share(state, *ao) != VolumeShare::kNone;
        const std::size_t grain = batches ? kBatchGrain : 1;
        state.context()->for_ranges(
            (receivers->count + grain - 1) / grain, [&](std::size_t first, std::size_t last) {
                const std::size_t begin = first * grain, end = std::min(last * grain, receivers->count);
                if (writer.masks() || writer.wants_moments())
                    write_all(state, *ao, *receivers, begin, end, writer);
                else if (writer.wants_visibility())
                    write_visibility(state, *ao, *receivers, begin, end, writer);
            });
    });
}

dfield_status dfield_scene_visibility(const dfield_scene* scene, const dfield_ao* ao,
                                      const dfield_receivers* receivers, float* visibility,
                                      size_t visibility_stride) {
    dfield_outputs outputs{};
    outputs.struct_size = sizeof outputs;
    outputs.visibility = visibility;
    outputs.visibility_stride = visibility_stride;
    if (!visibility)
        return dfield::runtime::fail(DFIELD_INVALID_ARGUMENT, "dfield_scene_visibility: visibility is null");
    return dfield_scene_ambient(scene, ao, receivers, &outputs);
}

dfield_status dfield_scene_visibility_mask(const dfield_scene* scene, const dfield_ao* ao,
                                           const dfield_receivers* receivers, uint32_t* masks,
                                           size_t mask_stride) {
    dfield_outputs outputs{};
    outputs.struct_size = sizeof outputs;
    outputs.masks = masks;
    outputs.mask_stride = mask_stride;
    if (!masks)
        return dfield::runtime::fail(DFIELD_INVALID_ARGUMENT, "dfield_scene_visibility_mask: masks is null");
    return dfield_scene_ambient(scene, ao, receivers, &outputs);
}

dfield_status dfield_ao_gather(const dfield_ao* ao, const dfield_receivers* receivers, const uint32_t* masks,
                               size_t mask_stride, const float* weights, float* visibility,
                               size_t visibility_stride) {
    using namespace dfield::runtime;
    return guarded([&] {
        require(ao && receivers && masks && visibility, "dfield_ao_gather: an argument is null");
        require(receivers->count == 0 || receivers->normals,
                "dfield_ao_gather: the receivers' normals are null");
        gather_visibility(*ao, *receivers, Strided<const std::uint32_t>(masks, mask_stride, ao->mask_words()),
                          weights, Strided<float>(visibility, visibility_stride, 1));
    });
}
}
