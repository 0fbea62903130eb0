// Clip meshes: what is inside, which method suits, what is refused.
#include <catch2/catch.hpp>
#include <cstring>

#include "tests/volume/cut_volumes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

// The share of a volume of ones that a clip leaves, voxel by voxel, as the session's bytes say.
std::vector<std::uint8_t> left_of(const Context& context, const dfield_clip& clip, std::uint32_t clip_samples,
                                  std::uint32_t size) {
    Cut scene;
    scene.volume = {
        {size, size, size}, {1, 1, 1}, std::vector<float>(std::size_t{size} * size * size, 100.0f)};
    scene.local = local_desc(6, 2);
    scene.clip_samples = clip_samples;
    Contextual session(context, scene.desc());
    session.add(clip);
    session.update();
    return {session.coverage(), session.coverage() + scene.volume.values.size()};
}

dfield_clip unturned(const ClipMesh& mesh, const glm::vec3& centre, float scale) {
    dfield_clip clip{};
    clip.mesh = mesh.get();
    for (int axis = 0; axis < 3; ++axis) {
        clip.mesh_to_world[5 * axis] = scale;
        clip.mesh_to_world[12 + axis] = centre[axis];
    }
    clip.mesh_to_world[15] = 1;
    return clip;
}

}  // namespace

TEST_CASE("Meshes of two layers get depth maps, others exact tests", "[volume][clip]") {
    const Context context;
    const ClipMesh box = clip_mesh(context, box_mesh({-1, -1, -1}, {1, 1, 1}));
    CHECK(box.method() == DFIELD_CLIP_DEPTH_MAPS);
    CHECK(box.layers() == 2);
    CHECK(clip_mesh(context, torus_mesh(1, 0.3f)).method() == DFIELD_CLIP_DEPTH_MAPS);
    TriangleMesh standing = torus_mesh(1, 0.3f);  // two layers along y alone
    for (glm::vec3& p : standing.positions) p = glm::vec3(p.y, p.z, p.x);
    const ClipMesh turned = clip_mesh(context, standing);
    CHECK(turned.method() == DFIELD_CLIP_DEPTH_MAPS);
    CHECK(turned.layers() == 2);
    const ClipMesh layered = clip_mesh(context, layered_mesh());
    CHECK(layered.method() == DFIELD_CLIP_EXACT);
    CHECK(layered.layers() > 2);
}

TEST_CASE("Voxels inside a ball are those near its centre, by either method", "[volume][clip]") {
    const Context context;
    const glm::vec3 centre(15.2f, 16.1f, 14.7f);
    for (const dfield_clip_method method : {DFIELD_CLIP_DEPTH_MAPS, DFIELD_CLIP_EXACT}) {
        const ClipMesh ball = clip_mesh(context, sphere_mesh({0, 0, 0}, 1, 64), method);
        for (const std::uint32_t samples : {0u, DFIELD_CLIP_SAMPLES}) {
            dfield_clip clip = unturned(ball, centre, 10);
            const auto left = left_of(context, clip, samples, 32);
            clip.mode = DFIELD_CLIP_PROBE;
            const auto kept = left_of(context, clip, samples, 32);
            const int all = samples == 0 ? 1 : static_cast<int>(samples) + 9;
            for (std::size_t i = 0; i < left.size(); ++i) {
                const glm::vec3 voxel(i % 32, i / 32 % 32, i / 1024);
                const float distance = glm::distance(voxel, centre);
                const float margin = samples == 0 ? 0.1f : 0.95f;
                if (distance > 10 + margin) CHECK(left[i] == all);
                if (distance < 10 - margin) CHECK(left[i] == 0);
                CHECK(left[i] + kept[i] == all);
                // Half a voxel outside, more is left than half a voxel inside.
                if (samples > 0 && distance > 10.4f) CHECK(left[i] > all / 2);
                if (samples > 0 && distance < 9.6f) CHECK(left[i] < all / 2);
            }
        }
    }
}

TEST_CASE("A clip's points are told apart", "[volume][clip]") {
    const Context context;
    const ClipMesh box = clip_mesh(context, box_mesh({-1, -1, -1}, {1, 1, 1}));
    Cut scene;
    scene.volume = blobs({20, 20, 20}, 1, {1, 2, 1});
    Contextual session(context, scene.desc());
    session.add(unturned(box, {10, 20, 10}, 5));
    session.update();
    const float points[] = {10, 20, 10, 14.9f, 24.9f, 5.1f, 15.1f, 20, 10, 10, 25.1f, 10, 0, 0, 0};
    std::uint8_t clipped[5];
    REQUIRE(dfield_contextual_test_points(session.get(), 5, points, 0, clipped) == DFIELD_OK);
    CHECK(clipped[0] == 1);
    CHECK(clipped[1] == 1);
    CHECK(clipped[2] == 0);
    CHECK(clipped[3] == 0);
    CHECK(clipped[4] == 0);
}

TEST_CASE("Clips and sessions refuse what makes no sense", "[volume][clip][api]") {
    const Context context;
    const auto refused = [](const auto& call) {
        try {
            call();
        } catch (const Exception& error) {
            return error.status() == DFIELD_INVALID_ARGUMENT && std::strlen(error.what()) > 20;
        }
        return false;
    };
    TriangleMesh open = box_mesh({-1, -1, -1}, {1, 1, 1});
    open.triangles.pop_back();
    CHECK(refused([&] { clip_mesh(context, open); }));
    TriangleMesh wild = box_mesh({-1, -1, -1}, {1, 1, 1});
    wild.triangles[0].x = 8;
    CHECK(refused([&] { clip_mesh(context, wild); }));
    wild = box_mesh({-1, -1, -1}, {1, 1, NAN});
    CHECK(refused([&] { clip_mesh(context, wild); }));
    CHECK(refused([&] { clip_mesh(context, box_mesh({-1, -1, 0}, {1, 1, 0})); }));
    CHECK(refused([&] { clip_mesh(context, box_mesh({-1, -1, -1}, {1, 1, 1}), DFIELD_CLIP_AUTO, 0); }));

    const ClipMesh box = clip_mesh(context, box_mesh({-1, -1, -1}, {1, 1, 1}));
    Cut scene;
    scene.volume = blobs({12, 12, 12}, 1);
    Contextual session(context, scene.desc());
    const dfield_clip good = unturned(box, {6, 6, 6}, 3);
    const auto with = [&](const auto& change) {
        return refused([&] {
            dfield_clip clip = good;
            change(clip);
            session.add(clip);
        });
    };
    CHECK(with([](dfield_clip& c) { c.mesh = nullptr; }));
    CHECK(with([](dfield_clip& c) { c.mode = 2; }));
    CHECK(with([](dfield_clip& c) { c.mesh_to_world[0] = 0; }));
    CHECK(with([](dfield_clip& c) { c.mesh_to_world[3] = 1; }));
    CHECK(with([](dfield_clip& c) { c.mesh_to_world[12] = NAN; }));
    const std::uint32_t id = session.add(good);
    CHECK(refused([&] { session.move(id + 1, good.mesh_to_world); }));
    session.remove(id);
    CHECK(refused([&] { session.remove(id); }));
    CHECK(session.update().is_final == 1);
    CHECK(refused([&] {
        dfield_contextual_desc desc = scene.desc();
        desc.clip_samples = 241;
        Contextual(context, desc);
    }));
    CHECK(refused([&] {
        dfield_contextual_desc desc = scene.desc();
        desc.samples.data = nullptr;
        Contextual(context, desc);
    }));
    scene.volume.values[7] = NAN;  // found by the update, which says so each time
    Contextual ill(context, scene.desc());
    CHECK(refused([&] { ill.update(); }));
    CHECK(refused([&] { ill.update(); }));
    scene.volume.values[7] = 1;
    CHECK(ill.update().is_final == 1);
}
