// Contextual ambient occlusion is local ambient occlusion of the clipped volume, bit for bit, whatever
// happened before.
#include <catch2/catch.hpp>
#include <cstring>
#include <map>

#include "tests/volume/clip_shapes.hpp"
#include "tests/volume/local_volumes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

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

Transfer random_transfer(Random& random) {
    Transfer transfer;
    const float start = static_cast<float>(random.uniform(-20, 150));
    transfer.points = {
        {start, 0},
        {start + static_cast<float>(random.uniform(1, 100)), static_cast<float>(random.uniform(0, 1))},
        {260, static_cast<float>(random.uniform(0, 1))}};
    return transfer;
}

Cut random_scene(Random& random) {
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

dfield_clip random_clip(Random& random, const Meshes& meshes, const Cut& scene) {
    const glm::dvec3 extent = scene.extent();
    const glm::dvec3 centre(random.uniform(-0.1, 1.1) * extent.x, random.uniform(-0.1, 1.1) * extent.y,
                            random.uniform(-0.1, 1.1) * extent.z);
    const ClipMesh& mesh = meshes.meshes[random.below(static_cast<std::uint32_t>(meshes.meshes.size()))];
    const auto mode = random.below(4) == 0 ? DFIELD_CLIP_PROBE : DFIELD_CLIP_SUBTRACT;
    return placed(mesh, mode, random, centre, random.uniform(1, 20), random.below(4) == 0);
}

// Something happens to the scene and the session.
void random_change(Random& random, const Meshes& meshes, Cut& scene, Contextual& session) {
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

}  // namespace

TEST_CASE("Contextual is local ambient occlusion of the clipped volume, bit for bit",
          "[volume][contextual]") {
    Random random(1);
    for (int run = 0; run < 40; ++run) {
        constexpr dfield_simd kLevels[] = {DFIELD_SIMD_BEST, DFIELD_SIMD_BEST, DFIELD_SIMD_AVX2,
                                           DFIELD_SIMD_SSE4, DFIELD_SIMD_SCALAR};
        dfield_context_desc how = context_desc(kLevels[run % 5]);
        Threads threads(2);
        if (run % 2) threads.install(how);
        const Context context(&how);
        const Meshes meshes(context);
        Cut scene = random_scene(random);
        if (how.simd == DFIELD_SIMD_SCALAR) {
            scene.local.samples = std::min(scene.local.samples, 4u);
            scene.local.jitter = 0;
        }
        Contextual session(context, scene.desc());
        std::vector<float> before(scene.volume.values.size(), 1.0f);
        for (int frame = 0; frame < 6; ++frame) {
            for (std::uint32_t i = random.below(3); i > 0 || scene.clips.empty(); --i) {
                random_change(random, meshes, scene, session);
                if (i == 0) break;
            }
            const dfield_update_result result = session.update();
            INFO("run " << run << " frame " << frame << " clips " << scene.clips.size() << " mask "
                        << scene.mask << " rays " << scene.local.ray_count << " jitter "
                        << scene.local.jitter);
            CHECK(result.is_final == 1);
            REQUIRE(scene.wrong(context, session.visibility()) == 0);
            // Nothing changed outside the box.
            std::size_t outside = 0;
            for (std::size_t i = 0; i < before.size(); ++i) {
                const std::size_t at[3] = {i % scene.volume.dims[0],
                                           i / scene.volume.dims[0] % scene.volume.dims[1],
                                           i / scene.volume.dims[0] / scene.volume.dims[1]};
                bool within = true;
                for (int axis = 0; axis < 3; ++axis)
                    within = within && at[axis] >= result.low[axis] && at[axis] < result.high[axis];
                outside += !within && before[i] != session.visibility()[i];
            }
            CHECK(outside == 0);
            before.assign(session.visibility(), session.visibility() + before.size());
        }
    }
}

TEST_CASE("Updates that end early end up exact", "[volume][contextual]") {
    Random random(2);
    const Context context;
    const Meshes meshes(context);
    for (int run = 0; run < 10; ++run) {
        Cut scene = random_scene(random);
        scene.volume = blobs({150, 40, 30}, random.below(100));
        scene.local.jitter = 0;
        Contextual session(context, scene.desc());
        struct Calls {
            int left = 0;
        } calls;
        dfield_update_desc update{};
        update.struct_size = sizeof update;
        update.user = &calls;
        update.cancelled = [](void* user) { return --static_cast<Calls*>(user)->left < 0 ? 1 : 0; };
        if (run % 2) update.seconds = 1000;
        std::size_t interrupted = 0;
        for (int frame = 0; frame < 8; ++frame) {
            random_change(random, meshes, scene, session);
            calls.left = static_cast<int>(random.below(12));
            interrupted += session.update(&update).is_final == 0;
        }
        CHECK(interrupted > 0);
        calls.left = 1 << 20;
        CHECK(session.update(run % 3 ? &update : nullptr).is_final == 1);
        CHECK(scene.wrong(context, session.visibility()) == 0);
    }
}

TEST_CASE("A budget of no time gives estimates and says that they are not final", "[volume][contextual]") {
    const Context context;
    Random random(3);
    Cut scene;
    scene.volume = blobs({200, 120, 60}, 4);
    scene.local = local_desc(54, 20);
    Contextual session(context, scene.desc());
    dfield_update_desc update{};
    update.struct_size = sizeof update;
    update.seconds = 0.02;
    CHECK(session.update(&update).is_final == 0);
    int updates = 1;
    while (session.update(&update).is_final == 0) ++updates;
    CHECK(updates > 1);
    CHECK(scene.wrong(context, session.visibility()) == 0);
    CHECK(session.update().recomputed == 0);  // nothing is left to do
}

TEST_CASE("Only what a clip has an effect on is computed anew", "[volume][contextual]") {
    const Context context;
    Random random(4);
    const Meshes meshes(context);
    Cut scene;
    scene.volume = blobs({128, 96, 64}, 4);
    scene.local = local_desc(54, 10);
    for (const dfield_update_mask mask : {DFIELD_UPDATE_CHANGED, DFIELD_UPDATE_DILATED}) {
        scene.mask = mask;
        Contextual session(context, scene.desc());
        CHECK(session.update().recomputed == 0);
        const dfield_clip clip = placed(meshes.meshes[1], DFIELD_CLIP_SUBTRACT, random, {64, 48, 32}, 14);
        const std::uint32_t id = session.add(clip);
        const dfield_update_result placed_now = session.update();
        CHECK(placed_now.recomputed > 0);
        CHECK(placed_now.recomputed < scene.volume.values.size() / 4);
        CHECK((placed_now.masked > 0) == (mask == DFIELD_UPDATE_DILATED));
        // Where it was already, it changes nothing.
        session.move(id, clip.mesh_to_world);
        const dfield_update_result again = session.update();
        CHECK(again.changed == 0);
        CHECK((again.recomputed == 0) == (mask == DFIELD_UPDATE_CHANGED));
        session.remove(id);
        const dfield_update_result removed = session.update();
        CHECK(removed.recomputed == 0);  // unclipped factors are known
        CHECK(removed.changed == placed_now.changed);
        CHECK(scene.wrong(context, session.visibility()) == 0);
    }
}
