// Edits, and snapshots that they do not reach.
#include <catch2/catch.hpp>
#include <cmath>
#include <optional>

#include "tests/runtime/baked_directions.hpp"
#include "tests/runtime/placements.hpp"
#include "tests/shapes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

// What lies straight below a place of the plane z = 0, looking up: distance, or infinity.
template<class Queries>
float above(const Queries& scene, float x, float y, dfield_instance* instance = nullptr) {
    const float origin[3] = {x, y, 0}, up[3] = {0, 0, 1};
    dfield_rays rays{};
    rays.count = 1, rays.origins = origin, rays.directions = up;
    float distance = -1;
    scene.trace(rays, {&distance, 0, instance, 0});
    return distance;
}

glm::mat4 at(float x, float y, float z, float scale = 1) {
    glm::mat4 m(scale);
    m[3] = glm::vec4(x, y, z, 1);
    return m;
}

}  // namespace

TEST_CASE("Instances are hidden, shown, moved many at once, and get other fields") {
    const Context context;
    const Field small = baked(context, box_mesh({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}), 16, 16);
    const Field large = baked(context, box_mesh({-1, -1, -1}, {1, 1, 1}), 16, 16);
    Scene scene(context);
    const glm::mat4 places[2] = {at(0, 0, 5), at(10, 0, 5)};
    const dfield_instance ids[2] = {scene.add(small, &places[0][0][0]), scene.add(small, &places[1][0][0])};
    CHECK(above(scene, 0, 0) == Approx(4.5).margin(0.1));

    scene.set_hidden(ids[0], true);
    CHECK(std::isinf(above(scene, 0, 0)));
    CHECK(std::isinf(above(scene.commit(), 0, 0)));
    scene.set_hidden(ids[0], true);
    scene.set_hidden(ids[0], false);
    CHECK(above(scene, 0, 0) == Approx(4.5).margin(0.1));

    scene.set_field(ids[0], large);
    CHECK(above(scene, 0, 0) == Approx(4).margin(0.1));
    CHECK(std::isinf(above(scene, 9.2f, 0)));

    const glm::mat4 moved[2] = {at(0, 0, 8), at(10, 0, 9)};
    scene.set_transforms(2, ids, &moved[0][0][0]);
    CHECK(above(scene, 0, 0) == Approx(7).margin(0.1));
    CHECK(above(scene, 10, 0) == Approx(8.5).margin(0.1));

    // A hidden instance keeps its id, moves, and changes its field.
    scene.set_hidden(ids[1], true);
    scene.set_transform(ids[1], &places[1][0][0]);
    scene.set_field(ids[1], large);
    scene.set_hidden(ids[1], false);
    dfield_instance who = DFIELD_NO_INSTANCE;
    CHECK(above(scene, 10, 0, &who) == Approx(4).margin(0.1));
    CHECK(who == ids[1]);
    scene.set_hidden(ids[1], true);
    scene.remove(ids[1]);
    CHECK(std::isinf(above(scene.commit(), 10, 0)));

    // All or none.
    glm::mat4 bad[2] = {at(0, 0, 20), glm::mat4(0.0f)};
    const dfield_instance twice[2] = {ids[0], ids[0]}, unknown[2] = {ids[0], 77};
    CHECK(dfield_scene_set_transforms(scene.get(), 2, twice, &bad[0][0][0], 0) == DFIELD_INVALID_ARGUMENT);
    bad[1] = bad[0];
    CHECK(dfield_scene_set_transforms(scene.get(), 2, unknown, &bad[0][0][0], 0) == DFIELD_INVALID_ARGUMENT);
    CHECK(above(scene, 0, 0) == Approx(7).margin(0.1));
    CHECK(dfield_scene_set_transforms(scene.get(), 0, nullptr, nullptr, 0) == DFIELD_OK);
    CHECK(dfield_scene_set_transforms(scene.get(), 1, nullptr, nullptr, 0) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_scene_set_hidden(scene.get(), 77, 1) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_scene_set_field(scene.get(), 77, small.get()) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_scene_set_field(scene.get(), ids[0], nullptr) == DFIELD_INVALID_ARGUMENT);
}

TEST_CASE("A snapshot stays what it was") {
    const Context context;
    std::optional<Scene> scene(context);
    std::optional<Snapshot> first;
    {
        const Field box = baked(context, box_mesh({-1, -1, -1}, {1, 1, 1}), 16, 16);
        const glm::mat4 place = at(0, 0, 5);
        const dfield_instance id = scene->add(box, &place[0][0]);
        first = scene->commit();
        const glm::mat4 elsewhere = at(0, 0, 15);
        scene->set_transform(id, &elsewhere[0][0]);
        const Snapshot second = scene->commit();
        CHECK(above(*first, 0, 0) == Approx(4).margin(0.2));
        CHECK(above(second, 0, 0) == Approx(14).margin(0.2));
        scene->remove(id);
        CHECK(above(second, 0, 0) == Approx(14).margin(0.2));
    }  // the field's last handle
    CHECK(std::isinf(above(*scene, 0, 0)));
    scene.reset();
    const Snapshot copy = *first;
    first.reset();
    CHECK(above(copy, 0, 0) == Approx(4).margin(0.2));
    CHECK(dfield_snapshot_get_scene(nullptr) == nullptr);
    dfield_snapshot_release(nullptr);
    CHECK(dfield_scene_commit(nullptr, nullptr) == DFIELD_INVALID_ARGUMENT);
}

TEST_CASE("Queries of a snapshot and of its scene agree, whatever the hierarchy") {
    const Context context;
    const Field box = baked_directions(context, box_mesh({-1, -0.7f, -1}, {1, 0.7f, 1}));
    Scene scene(context);
    Random random(2);
    std::vector<dfield_instance> ids;
    dfield_ao_desc desc = Ao::defaults();
    desc.ray_count = 64;
    const Ao around(context, desc);
    desc.sampling = DFIELD_SAMPLING_SHARED;
    const Ao shared(context, desc);
    ReceiverList list;
    for (int i = 0; i < 200; ++i) {
        list.positions.emplace_back(random.uniform(-8, 8), random.uniform(-8, 8), random.uniform(-1, 3));
        list.normals.emplace_back(random.direction());
    }
    std::vector<float> from_scene(200), from_snapshot(200), rays_scene(200), rays_snapshot(200);
    for (int round = 0; round < 12; ++round) {
        for (int k = 0; k < 9; ++k) {
            const glm::mat4 place = random_placement(random, {-8, -8, 0}, {8, 8, 2});
            if (round == 0 || k < 2)
                ids.push_back(scene.add(box, &place[0][0]));
            else if (k < 4) {
                scene.remove(ids.back());
                ids.pop_back();
            } else
                scene.set_transform(ids[random.below(static_cast<std::uint32_t>(ids.size()))], &place[0][0]);
        }
        const Snapshot snapshot = scene.commit();
        for (const Ao* ao : {&around, &shared}) {
            scene.visibility(*ao, list.view(), from_scene.data());
            snapshot.visibility(*ao, list.view(), from_snapshot.data());
            CHECK(from_scene == from_snapshot);
        }
        dfield_rays rays{};
        rays.count = list.size();
        rays.origins = &list.positions[0].x;
        rays.directions = &list.normals[0].x;
        scene.trace(rays, {rays_scene.data(), 0, nullptr, 0});
        snapshot.trace(rays, {rays_snapshot.data(), 0, nullptr, 0});
        CHECK(rays_scene == rays_snapshot);
    }
}
