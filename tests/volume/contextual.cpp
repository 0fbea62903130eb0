// Contextual ambient occlusion is local ambient occlusion of the clipped volume, bit for bit, whatever
// happened before.
#include <catch2/catch.hpp>

#include "tests/volume/cut_volumes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

// Random scenes of a test; a few under the sanitizers, which are ten times slower.
constexpr int scenes(int count) {
#ifdef __SANITIZE_ADDRESS__
    return (count + 7) / 8;
#else
    return count;
#endif
}

}  // namespace

TEST_CASE("Contextual is local ambient occlusion of the clipped volume, bit for bit",
          "[volume][contextual]") {
    Random random(1);
    for (int run = 0; run < scenes(15); ++run) {
        constexpr dfield_simd kLevels[] = {DFIELD_SIMD_BEST, DFIELD_SIMD_BEST, DFIELD_SIMD_AVX2,
                                           DFIELD_SIMD_SSE4, DFIELD_SIMD_SCALAR};
        dfield_context_desc how = context_desc(kLevels[run % 5]);
        Threads threads(2);
        if (run % 2) threads.install(how);
        const Context context(&how);
        const Meshes meshes(context);
        Cut scene = random_scene(random);
        if (how.simd == DFIELD_SIMD_SCALAR) {
            scene.local = local_desc(14, 4);
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
    for (int run = 0; run < scenes(10); ++run) {
        Cut scene = random_scene(random);
        scene.volume = blobs({150, 40, 30}, random.below(100));
        scene.local.jitter = 0;
        Contextual session(context, scene.desc());
        int calls = 0;
        dfield_update_desc update = cancelled_after(calls);
        if (run % 2) update.seconds = 1000;
        std::size_t interrupted = 0;
        for (int frame = 0; frame < 8; ++frame) {
            random_change(random, meshes, scene, session);
            calls = static_cast<int>(random.below(12));
            interrupted += session.update(&update).is_final == 0;
        }
        CHECK(interrupted > 0);
        calls = 1 << 20;
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

TEST_CASE("Voxels changed are those that turned, and those of another opacity", "[volume][contextual]") {
    const Context context;
    Random random(6);
    const Meshes meshes(context);
    Cut scene;
    scene.volume = blobs({45, 30, 21}, 7);
    scene.local = local_desc(6, 3);
    Contextual session(context, scene.desc());
    session.update();
    std::uint32_t id = 0;
    for (int frame = 0; frame < 6; ++frame) {
        const std::vector<std::uint8_t> before(session.coverage(),
                                               session.coverage() + scene.volume.values.size());
        const dfield_clip clip =
            placed(meshes.meshes[1], DFIELD_CLIP_SUBTRACT, random, {18 + 2.3 * frame, 15, 10}, 7);
        if (frame == 0) id = session.add(clip);
        session.move(id, clip.mesh_to_world);
        const std::uint64_t changed = session.update().changed;
        std::uint64_t turned = 0, other = 0;
        for (std::size_t i = 0; i < before.size(); ++i) {
            const std::uint8_t now = session.coverage()[i];
            if (!now != !before[i])
                ++turned;
            else if (now != before[i] && scene.volume.values[i] > scene.transfer.points.front().value)
                ++other;
        }
        CHECK(turned > 0);
        CHECK(other > 0);
        CHECK(changed == turned + other);
    }
}

TEST_CASE("Clipped voxels are open, but for those beside visible ones", "[volume][contextual]") {
    const Context context;
    Cut scene;
    scene.volume = {{24, 20, 18}, models::kUnitSpacing, std::vector<float>(24 * 20 * 18, 60.0f)};  // a haze
    scene.clip_samples = 0;
    const ClipMesh box = clip_mesh(context, box_mesh({-1, -1, -1}, {1, 1, 1}));
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {  // half of the volume is clipped
            dfield_clip clip{};
            clip.mesh = box.get();
            for (int i = 0; i < 3; ++i) clip.mesh_to_world[5 * i] = 40;
            clip.mesh_to_world[15] = 1;
            for (int i = 0; i < 3; ++i) clip.mesh_to_world[12 + i] = i == axis ? 9.4f + 40 * side : 0;
            scene.clips = {{0, clip}};
            const std::vector<float> factors = scene.from_scratch(context);
            std::size_t wrong = 0;
            for (std::uint32_t z = 0; z < 18; ++z)
                for (std::uint32_t y = 0; y < 20; ++y)
                    for (std::uint32_t x = 0; x < 24; ++x) {
                        const std::uint32_t at[3] = {x, y, z};
                        const float beyond = side * (static_cast<float>(at[axis]) - 9.4f);
                        const float factor = factors[scene.volume.index(x, y, z)];
                        wrong += (factor == 1) != (beyond > 1);
                    }
            CHECK(wrong == 0);
        }
}

TEST_CASE("What was clipped out of the air is as before once the clip is gone", "[volume][contextual]") {
    const Context context;
    const Meshes meshes(context);
    Cut scene;
    scene.volume = {{48, 24, 20}, models::kUnitSpacing, {}};
    for (std::size_t i = 0; i < 48 * 24 * 20; ++i) scene.volume.values.push_back(i % 48 < 12 ? 200.0f : 0.0f);
    Random random(5);
    Contextual session(context, scene.desc());
    session.update();
    // Nothing that has an opacity is clipped, and rays from there meet the wall.
    const dfield_clip first = placed(meshes.meshes[1], DFIELD_CLIP_SUBTRACT, random, {20, 12, 10}, 5),
                      second = placed(meshes.meshes[1], DFIELD_CLIP_SUBTRACT, random, {21, 13, 10}, 4);
    const std::uint32_t id = session.add(first);
    scene.clips = {{id, first}};
    session.update();
    CHECK(scene.wrong(context, session.visibility()) == 0);
    session.move(id, second.mesh_to_world);
    scene.clips = {{id, second}};
    session.update();
    CHECK(scene.wrong(context, session.visibility()) == 0);
    session.remove(id);
    scene.clips.clear();
    CHECK(session.update().changed > 0);
    CHECK(scene.wrong(context, session.visibility()) == 0);
}

TEST_CASE("Rows of more blocks than a word has bits, and rays as long as such words",
          "[volume][contextual]") {
    const Context context;
    const Meshes meshes(context);
    Random random(9);
    Cut scene;
    scene.volume = blobs({2200, 7, 5}, 3);
    const auto check = [&](std::uint32_t samples, float step, std::uint64_t reach) {
        scene.local = local_desc(26, samples);
        scene.local.step = step;
        scene.clips.clear();
        Contextual session(context, scene.desc());
        session.update();
        std::uint32_t id = 0;
        for (const double x : {3.0, 500.0, 1019.0, 1030.0, 1700.0, 2052.0, 2198.0}) {
            const dfield_clip clip = placed(meshes.meshes[0], DFIELD_CLIP_SUBTRACT, random, {x, 3, 2}, 4);
            if (id == 0) id = session.add(clip);
            session.move(id, clip.mesh_to_world);
            scene.clips = {{id, clip}};
            const dfield_update_result result = session.update();
            INFO("step " << step << " at " << x);
            CHECK(result.recomputed > 0);
            CHECK(result.recomputed < 35 * (2 * (reach + 7) + 3 * 16));  // in blocks, of a turned cube's box
            CHECK(scene.wrong(context, session.visibility()) == 0);
        }
    };
    check(20, 1, 18);
    check(3, 400, 800);
}

TEST_CASE("A mask has the voxels that rays reach a clip from, and few more", "[volume][contextual]") {
    const Context context;
    const ClipMesh ball = clip_mesh(context, sphere_mesh({0, 0, 0}, 1, 64)),
                   box = clip_mesh(context, box_mesh({-1, -1, -1}, {1, 1, 1}));
    Cut scene;
    scene.volume = blobs({64, 60, 56}, 4);
    scene.mask = DFIELD_UPDATE_DILATED;
    scene.clip_samples = 0;
    const glm::dvec3 centre(31.3, 29.8, 28.1);
    // How far outside a mesh of this radius a voxel is.
    const auto outside_of = [&](const ClipMesh& mesh, const glm::dvec3& voxel, double radius) {
        const glm::dvec3 from = voxel - centre, beyond = glm::abs(from) - radius;
        const double deepest = std::max({beyond.x, beyond.y, beyond.z});
        if (&mesh == &ball) return glm::length(from) - radius;
        return deepest > 0 ? glm::length(glm::max(beyond, 0.0)) : deepest;
    };
    for (const ClipMesh* const mesh : {&ball, &box})
        for (const std::uint32_t samples : {3u, 9u})
            for (const dfield_clip_mode mode : {DFIELD_CLIP_SUBTRACT, DFIELD_CLIP_PROBE})
                for (const float radius : {8.0f, 14.0f}) {
                    scene.local = local_desc(6, samples);
                    Contextual session(context, scene.desc());
                    dfield_clip clip{};
                    clip.mesh = mesh->get();
                    clip.mode = mode;
                    for (int axis = 0; axis < 3; ++axis) {
                        clip.mesh_to_world[5 * axis] = radius;
                        clip.mesh_to_world[12 + axis] = static_cast<float>(centre[axis]);
                    }
                    clip.mesh_to_world[15] = 1;
                    session.add(clip);
                    const std::uint64_t masked = session.update().masked;
                    // Room for a voxel around a sample, two of the map's pixels, and the ball's facets.
                    const double reach = samples, margin = 2.0 + 4 * (2 * radius + 2 * reach) / 160;
                    std::uint64_t least = 0, most = 0;
                    for (std::size_t i = 0; i < scene.volume.values.size(); ++i) {
                        const glm::dvec3 voxel(static_cast<double>(i % 64), static_cast<double>(i / 64 % 60),
                                               static_cast<double>(i / (64 * 60)));
                        const double outside = outside_of(*mesh, voxel, radius);
                        const double away = mode == DFIELD_CLIP_SUBTRACT ? outside : -outside;
                        least += away > 0.1 && away < reach;
                        most += away > -0.1 && away < reach + margin;
                    }
                    CHECK(masked >= least);
                    CHECK(masked <= most);
                }
}

TEST_CASE("Masks miss nothing of a mesh so far from its origin that depths are coarse",
          "[volume][contextual]") {
    // Depths are multiples of a quarter here, 8 or 16 voxels, or half of that; masks have a voxel or two
    // to spare.
    constexpr float kAway = 0x1p21f;
    const Context context;
    const ClipMesh box = clip_mesh(context, box_mesh({-1, -1, kAway - 1}, {1, 1, kAway + 1}));
    Cut scene;
    scene.volume = {{16, 12, 168}, models::kUnitSpacing, std::vector<float>(16 * 12 * 168, 60.0f)};
    scene.mask = DFIELD_UPDATE_DILATED;
    for (const dfield_clip_mode mode : {DFIELD_CLIP_SUBTRACT, DFIELD_CLIP_PROBE})
        for (const float half : {32.0f, 64.0f})
            for (std::uint32_t samples = 3; samples < 10; samples += 2)
                for (const float step : {0.7f, 1.0f, 1.15f}) {
                    scene.local = local_desc(6, samples);
                    scene.local.step = step;
                    Contextual session(context, scene.desc());
                    session.update();
                    dfield_clip clip{box.get(), static_cast<std::uint32_t>(mode), {}};
                    for (int axis = 0; axis < 3; ++axis) clip.mesh_to_world[5 * axis] = half;
                    clip.mesh_to_world[12] = 8;
                    clip.mesh_to_world[13] = 6;
                    clip.mesh_to_world[14] = 80 - half * kAway;  // no rounding
                    clip.mesh_to_world[15] = 1;
                    scene.clips = {{session.add(clip), clip}};
                    session.update();
                    INFO("mode " << mode << " half " << half << " samples " << samples << " step " << step);
                    CHECK(scene.wrong(context, session.visibility()) == 0);
                }
}

TEST_CASE("A mesh that grows and shrinks is followed by its mask", "[volume][contextual]") {
    const Context context;
    const Meshes meshes(context);
    Random random(9);
    Cut scene;
    scene.volume = blobs({40, 36, 32}, 5);
    scene.mask = DFIELD_UPDATE_DILATED;
    Contextual session(context, scene.desc());
    dfield_clip clip = placed(meshes.meshes[0], DFIELD_CLIP_SUBTRACT, random, {20, 18, 16}, 6);
    const std::uint32_t id = session.add(clip);
    // The same mesh twice, at one scale and then at two.
    const dfield_clip other = clip;
    const std::uint32_t second = session.add(other);
    scene.clips = {{id, clip}, {second, other}};
    for (const float by : {1.0f, 1.3f, 1.3f, 0.6f, 1.0f}) {
        for (int i = 0; i < 12; ++i) clip.mesh_to_world[i] *= by;
        session.move(id, clip.mesh_to_world);
        scene.clips[id] = clip;
        const std::uint64_t masked = session.update().masked;
        CHECK(scene.wrong(context, session.visibility()) == 0);
        // No more than if it had always been as large as it is.
        Contextual fresh(context, scene.desc());
        fresh.add(clip);
        fresh.add(other);
        CHECK(masked == fresh.update().masked);
    }
}
