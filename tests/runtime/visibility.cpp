// Ambient occlusion of receivers: closed forms, the fast path against Algorithm 2, masks, owners, ground,
// threads.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <thread>

#include "tests/random.hpp"
#include "tests/runtime/baked.hpp"
#include "tests/runtime/placements.hpp"
#include "tests/shapes.hpp"

using namespace dfield;
using test::kIdentity;
using test::Random;
using test::ReceiverList;

namespace {

std::vector<float> visible(const Scene& scene, const Ao& ao, const dfield_receivers& receivers) {
    std::vector<float> values(receivers.count);
    scene.visibility(ao, receivers, values.data());
    return values;
}

TriangleMesh clutter() {
    TriangleMesh mesh = test::sphere_mesh({-0.6f, 0, 0.1f}, 0.5f, 20);
    test::append(mesh, test::box_mesh({0, -0.3f, -0.6f}, {1, 0.5f, 0.4f}));
    return mesh;
}

ReceiverList around(std::size_t count, double nearest, double farthest) {
    Random random(41);
    ReceiverList points;
    for (std::size_t i = 0; i < count; ++i) {
        points.positions.emplace_back(random.direction() * random.uniform(nearest, farthest));
        points.normals.emplace_back(random.direction());
    }
    return points;
}

}  // namespace

TEST_CASE("A ball over a receiver hides (r/h)^2 of its sky") {
    const Context context;
    const Field field = test::baked(context, test::sphere_mesh({0, 0, 0}, 1, 96), 32, 48, 8);
    Scene scene(context);
    scene.add(field, kIdentity);
    dfield_ao_desc desc = Ao::defaults();
    desc.ray_count = 4096;
    const Ao ao(context, desc);
    ReceiverList points;
    for (const float h : {1.5f, 2.0f, 3.0f, 6.0f}) {
        points.positions.push_back({0, 0, -h});
        points.normals.push_back({0, 0, 3});  // any length
    }
    points.positions.push_back({0, 0, -2});
    points.normals.push_back({0, 0, -1});  // looking away
    const auto values = visible(scene, ao, points.view());
    CHECK(values[0] == Approx(1 - 1 / 2.25).margin(0.02));  // near-grazing rays, tessellation
    CHECK(values[1] == Approx(1 - 1 / 4.0).margin(0.01));
    CHECK(values[2] == Approx(1 - 1 / 9.0).margin(0.01));
    CHECK(values[3] == Approx(1 - 1 / 36.0).margin(0.01));
    CHECK(values[4] == 1);
}

TEST_CASE("The fast path agrees with Algorithm 2 of the paper") {
    const Context context;
    const ReceiverList points = around(600, 0.1, 3);
    for (const std::uint32_t bits : {1u, 8u, 16u, 32u})
        for (const bool falloff : {false, true}) {
            const Field field = test::baked(context, clutter(), 16, 16, bits);
            Scene scene(context);
            scene.add(field, kIdentity);
            float moved[16] = {0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 1.5f, 0, 1, 2, 0.5f, 1};
            scene.add(field, moved);
            const float ground[4] = {0, 0, 1, -0.7f};
            scene.set_ground(ground);
            dfield_ao_desc desc = Ao::defaults();
            desc.ray_count = 100;
            if (falloff) desc.falloff = DFIELD_FALLOFF_SMOOTH, desc.max_distance = 1.5f, desc.bias = 0.05f;
            const Ao ao(context, desc);
            const auto fast = visible(scene, ao, points.view());
            std::vector<float> plain(fast.size());
            const dfield_receivers receivers = points.view();
            check(dfield_scene_visibility_reference(scene.get(), ao.get(), &receivers, plain.data(), 0));
            std::size_t different = 0;
            float worst = 0;
            for (std::size_t i = 0; i < fast.size(); ++i) {
                different += std::fabs(fast[i] - plain[i]) > 1e-4f;
                worst = std::max(worst, std::fabs(fast[i] - plain[i]));
            }
            INFO("bits " << bits << " falloff " << falloff);
            // A ray on the border between two texels may go either way: one or two of a hundred, for few
            // receivers.
            CHECK(different < fast.size() / 20);
            CHECK(worst <= 0.031f);
        }
}

TEST_CASE("Masks count to the visibility and combine by OR") {
    const Context context;
    const Field field = test::baked(context, clutter(), 16, 16);
    const ReceiverList points = around(200, 1.3, 3);
    float moved[16];
    std::copy(kIdentity, kIdentity + 16, moved);
    moved[12] = 2.5f;
    Scene both(context), first(context), second(context);
    both.add(field, kIdentity);
    both.add(field, moved);
    first.add(field, kIdentity);
    second.add(field, moved);
    dfield_ao_desc desc = Ao::defaults();
    desc.ray_count = 300;  // no multiple of 32 or 256
    const Ao ao(context, desc);
    const std::size_t words = dfield_ao_get_mask_words(ao.get());
    REQUIRE(words == 10);
    std::vector<std::uint32_t> of_both(words * 200, ~0u), of_first(of_both), of_second(of_both);
    both.visibility_mask(ao, points.view(), of_both.data());
    first.visibility_mask(ao, points.view(), of_first.data());
    second.visibility_mask(ao, points.view(), of_second.data());
    const auto values = visible(both, ao, points.view());
    for (std::size_t i = 0; i < 200; ++i) {
        int blocked = 0;
        for (std::size_t w = 0; w < words; ++w) {
            REQUIRE(of_both[i * words + w] == (of_first[i * words + w] | of_second[i * words + w]));
            blocked += std::popcount(of_both[i * words + w]);
        }
        CHECK(values[i] == Approx(1 - blocked / 300.0).margin(1e-5));
    }
}

TEST_CASE("Owners are not shadowed by their own field, and self-visibility is multiplied in") {
    const Context context;
    const Field field = test::baked(context, clutter(), 16, 16);
    Scene scene(context);
    const dfield_instance own = scene.add(field, kIdentity);
    float moved[16];
    std::copy(kIdentity, kIdentity + 16, moved);
    moved[12] = 2.2f;
    const dfield_instance other = scene.add(field, moved);
    const ReceiverList points = around(100, 0.2, 1);
    const Ao ao(context);
    Scene without(context);
    without.add(field, moved);
    const std::vector<dfield_instance> owners(100, own);
    dfield_receivers receivers = points.view();
    receivers.owners = owners.data();
    const auto expected = visible(without, ao, points.view());
    CHECK(visible(scene, ao, receivers) == expected);
    const std::vector<float> self(100, 0.25f);
    receivers.self_visibility = self.data();
    const auto multiplied = visible(scene, ao, receivers);
    for (std::size_t i = 0; i < 100; ++i) CHECK(multiplied[i] == 0.25f * expected[i]);
    CHECK(other != own);
}

TEST_CASE("Ground hides the lower half and buries what lies below it") {
    const Context context;
    Scene scene(context);
    const float ground[4] = {0, 1, 0, 0};
    scene.set_ground(ground);
    const Ao ao(context);
    ReceiverList points;
    points.positions = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, -1e-6f, 0}, {0, -1, 0}};
    points.normals = {{0, 1, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, -1, 0}};
    const auto values = visible(scene, ao, points.view());
    CHECK(values[0] == 1);
    CHECK(values[1] == Approx(0.5).margin(0.01));
    CHECK(values[2] == 0);
    CHECK(values[3] == 1);  // rounding put a vertex on the ground a little below it
    CHECK(values[4] == 0);
    dfield_ao_desc desc = Ao::defaults();
    desc.falloff = DFIELD_FALLOFF_LINEAR;
    desc.max_distance = 2;
    desc.ray_count = 1;  // straight down, 1 away
    CHECK(visible(scene, Ao(context, desc), points.view())[2] == Approx(0.5).margin(1e-4));
}

TEST_CASE("A user's directions and weights are the integral") {
    const Context context;
    Scene scene(context);
    const float ground[4] = {0, 0, 1, 0};
    scene.set_ground(ground);
    const float directions[] = {0.6f, 0, 0.8f, -0.6f, 0, 0.8f, 0, 0, 1}, weights[] = {0.5f, 0.3f, 0.2f};
    dfield_ao_desc desc = Ao::defaults();
    desc.ray_count = 3;
    desc.directions = directions;
    desc.weights = weights;
    const Ao ao(context, desc);
    // A receiver whose normal is x: its frame's tangent is -z, so the first ray goes down and the second up.
    float tangent[3], bitangent[3];
    const float normal[3] = {1, 0, 0};
    dfield_frame(normal, tangent, bitangent);
    CHECK(tangent[2] == -1);
    ReceiverList points;
    points.positions = {{0, 0, 1}};
    points.normals = {{1, 0, 0}};
    CHECK(visible(scene, ao, points.view())[0] == Approx(0.5));
}

TEST_CASE("Contact: an object that touches the receivers' plane hides as it should, at any depth of bits") {
    // A box standing on the plane z = 0; receivers of the plane beside it, up to its very edge.
    const Context context;
    for (const std::uint32_t bits : {1u, 8u}) {
        const Field field = test::baked(context, test::box_mesh({-1, -1, 0}, {1, 1, 2}), 32, 32, bits);
        Scene scene(context);
        scene.add(field, kIdentity);
        dfield_ao_desc desc = Ao::defaults();
        desc.ray_count = 1024;
        const Ao ao(context, desc);
        ReceiverList points;
        for (const float x : {1.0001f, 1.05f, 1.5f, 3.0f}) {
            points.positions.push_back({x, 0, 0});
            points.normals.push_back({0, 0, 1});
        }
        const auto values = visible(scene, ao, points.view());
        // Quadrature of the closed form: occlusion of the rectangle y in [-1,1], z in [0,2] at distance a = x
        // - 1 (the top adds nothing seen from z = 0): 1/pi * int int a z / (a^2 + y^2 + z^2)^2 dy dz.
        for (int i = 0; i < 4; ++i) {
            const double a = points.positions[i].x - 1;
            const auto edge = [&](double z) {
                return std::atan(1 / std::sqrt(a * a + z * z)) * a / std::sqrt(a * a + z * z);
            };
            const double occlusion = (edge(0) - edge(2)) / 3.14159265358979;
            INFO("bits " << bits << " x " << points.positions[i].x);
            CHECK(1 - values[i] == Approx(occlusion).margin(0.03));
        }
    }
}

TEST_CASE("Results do not depend on how a batch is split or on threads") {
    dfield_context_desc hooks{};
    hooks.struct_size = sizeof hooks;
    hooks.parallel_for = [](void*, std::size_t count, void (*body)(void*, std::size_t, std::size_t),
                            void* data) {
        std::vector<std::thread> threads;
        for (std::size_t part = 0; part < 5; ++part)
            threads.emplace_back(body, data, count * part / 5, count * (part + 1) / 5);
        for (std::thread& thread : threads) thread.join();
    };
    const Context threaded(&hooks), plain;
    const ReceiverList points = around(333, 0.2, 3);
    std::vector<float> results[2];
    for (const Context* context : {&threaded, &plain}) {
        const Field field = test::baked(*context, clutter(), 16, 16);
        Scene scene(*context);
        scene.add(field, kIdentity);
        results[context == &plain] = visible(scene, Ao(*context), points.view());
    }
    CHECK(results[0] == results[1]);
}
