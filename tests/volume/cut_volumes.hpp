// Random volumes, meshes and changes to them, and the truth to hold a session against.
#pragma once

#include <cstring>
#include <map>
#include <vector>

#include "tests/volume/clip_shapes.hpp"
#include "tests/volume/local_volumes.hpp"

namespace dfield::test {

struct Cut {
    models::ScalarVolume volume;
    Transfer transfer;
    dfield_local_desc local = local_desc(26, 10);
    std::uint32_t clip_samples = DFIELD_CLIP_SAMPLES;
    dfield_update_mask mask = DFIELD_UPDATE_CHANGED;
    std::map<std::uint32_t, dfield_clip> clips;

    dfield_contextual_desc desc() const {
        dfield_contextual_desc desc = contextual_defaults();
        desc.samples = samples_of(volume);
        desc.opacity = transfer.desc();
        desc.local = local;
        desc.clip_samples = clip_samples;
        desc.mask = mask;
        return desc;
    }
    std::vector<float> from_scratch(const Context& context) const {
        std::vector<dfield_clip> list;
        for (const auto& [id, clip] : clips) list.push_back(clip);
        std::vector<float> visibility(volume.values.size());
        local_ao_volume_clipped(context, samples_of(volume), transfer.desc(), local, list.data(), list.size(),
                                clip_samples, visibility.data());
        return visibility;
    }
    // Counts voxels that are not the same in every bit.
    std::size_t wrong(const Context& context, const float* found) const {
        const std::vector<float> truth = from_scratch(context);
        std::size_t count = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) count += std::memcmp(&truth[i], found + i, 4) != 0;
        return count;
    }
    glm::dvec3 extent() const {
        return {volume.dims[0] * volume.spacing[0], volume.dims[1] * volume.spacing[1],
                volume.dims[2] * volume.spacing[2]};
    }
};

// An update that is cancelled once `calls`, counted down by it, are used up.
inline dfield_update_desc cancelled_after(int& calls) {
    dfield_update_desc update{};
    update.struct_size = sizeof update;
    update.user = &calls;
    update.cancelled = [](void* user) { return --*static_cast<int*>(user) < 0 ? 1 : 0; };
    return update;
}

struct Meshes {
    explicit Meshes(const Context& context) {
        meshes.push_back(clip_mesh(context, box_mesh({-1, -1, -1}, {1, 1, 1})));
        meshes.push_back(clip_mesh(context, sphere_mesh({0, 0, 0}, 1, 16)));
        meshes.push_back(clip_mesh(context, torus_mesh(1, 0.4f)));
        meshes.push_back(clip_mesh(context, layered_mesh()));
        meshes.push_back(clip_mesh(context, sphere_mesh({0.2f, 0, 0}, 1, 12), DFIELD_CLIP_DEPTH_MAPS, 9));
        meshes.push_back(clip_mesh(context, box_mesh({-2, -0.3f, -1}, {1, 0.2f, 1}), DFIELD_CLIP_EXACT));
    }
    std::vector<ClipMesh> meshes;
};

inline Transfer random_transfer(Random& random) {
    Transfer transfer;
    const float start = static_cast<float>(random.uniform(-20, 150));
    transfer.points = {
        {start, 0},
        {start + static_cast<float>(random.uniform(1, 100)), static_cast<float>(random.uniform(0, 1))},
        {260, static_cast<float>(random.uniform(0, 1))}};
    return transfer;
}

inline Cut random_scene(Random& random) {
    const models::Dims dims{10 + random.below(50), 8 + random.below(24), 6 + random.below(24)};
    const bool even = random.below(2) == 0;
    Cut scene;
    scene.volume =
        blobs(dims, random.below(1000), even ? models::Spacing{1, 1, 1} : models::Spacing{0.8, 1.3, 1});
    scene.transfer = random_transfer(random);
    constexpr std::uint32_t kRays[] = {6, 14, 26, 54, 11};
    scene.local = local_desc(kRays[random.below(5)], 1 + random.below(16));
    if (random.below(3) == 0) scene.local.step_unit = DFIELD_STEP_WORLD;
    if (random.below(4) == 0) scene.local.step = 0.6f;
    if (random.below(8) == 0) {
        scene.local = local_desc(6, 5);
        scene.local.jitter = 0.5f;
    }
    if (random.below(4) == 0) scene.clip_samples = 0;
    if (random.below(3) == 0) scene.mask = DFIELD_UPDATE_DILATED;
    return scene;
}

inline dfield_clip random_clip(Random& random, const Meshes& meshes, const Cut& scene) {
    const glm::dvec3 extent = scene.extent();
    const glm::dvec3 centre(random.uniform(-0.1, 1.1) * extent.x, random.uniform(-0.1, 1.1) * extent.y,
                            random.uniform(-0.1, 1.1) * extent.z);
    const ClipMesh& mesh = meshes.meshes[random.below(static_cast<std::uint32_t>(meshes.meshes.size()))];
    const auto mode = random.below(4) == 0 ? DFIELD_CLIP_PROBE : DFIELD_CLIP_SUBTRACT;
    return placed(mesh, mode, random, centre, random.uniform(1, 20), random.below(4) == 0);
}

// Something happens to the scene and the session.
inline void random_change(Random& random, const Meshes& meshes, Cut& scene, Contextual& session) {
    const std::uint32_t what = random.below(10);
    if (what == 0 || scene.clips.empty()) {
        const dfield_clip clip = random_clip(random, meshes, scene);
        scene.clips[session.add(clip)] = clip;
    } else if (what == 1 && scene.clips.size() > 1) {
        session.remove(scene.clips.begin()->first);
        scene.clips.erase(scene.clips.begin());
    } else if (what == 2) {
        scene.transfer = random_transfer(random);
        session.set_opacity(scene.transfer.desc());
    } else {
        auto clip =
            std::next(scene.clips.begin(), random.below(static_cast<std::uint32_t>(scene.clips.size())));
        for (int axis = 0; axis < 3; ++axis)
            clip->second.mesh_to_world[12 + axis] += static_cast<float>(random.uniform(-2, 2));
        session.move(clip->first, clip->second.mesh_to_world);
    }
}

}  // namespace dfield::test
