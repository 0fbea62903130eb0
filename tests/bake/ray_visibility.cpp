#include "baker/ray_visibility.hpp"

#include <catch2/catch.hpp>

#include "format/hemisphere_map.hpp"
#include "tests/shapes.hpp"

using namespace dfield;

TEST_CASE("A sphere over a plane hides (r/h)^2 of the cosine-weighted sky") {
    EmbreeScene scene(EmbreeUse::kFast);
    scene.add_mesh(test::sphere_mesh({0, 0, 3}, 1.0f, 200));
    scene.commit();
    const std::vector<glm::vec3> positions{{0, 0, 0}, {0, 0, 1}, {0, 0, -2}}, normals(3, {0, 0, 1});
    const auto directions = cosine_directions(65536);
    RayVisibilityOptions options;
    options.directions = directions;
    const auto visibility = ray_visibility(scene, positions, normals, options);
    CHECK(visibility[0] == Approx(1 - 1.0 / 9).margin(0.002));
    CHECK(visibility[1] == Approx(1 - 1.0 / 4).margin(0.002));
    CHECK(visibility[2] == Approx(1 - 1.0 / 25).margin(0.002));
}

TEST_CASE("Falloff, maximum distance, near distance and weights enter the integral") {
    EmbreeScene scene(EmbreeUse::kFast);
    scene.add_mesh(test::box_mesh({-100, -100, 2}, {100, 100, 3}));  // a ceiling 2 above
    scene.commit();
    const std::vector<glm::vec3> position{{0, 0, 0}}, normal{{0, 0, 1}};
    const std::vector<glm::vec3> up{{0, 0, 1}, {0.6f, 0, 0.8f}};
    RayVisibilityOptions options;
    options.directions = up;
    const auto one = [&] { return ray_visibility(scene, position, normal, options)[0]; };
    CHECK(one() == 0);
    options.max_distance = 2.2f;  // the slanted ray meets the ceiling at 2.5
    CHECK(one() == Approx(0.5));
    options.max_distance = std::numeric_limits<float>::infinity();
    options.near_distance = 2.3f;  // inside the slab by then: the upper face, at 3, is still ahead
    CHECK(one() == 0);
    options.near_distance = 3.5f;
    CHECK(one() == Approx(0.5));  // the slanted ray leaves at 3.75
    options.near_distance = 0;
    options.occlusion = [](const void* scale, float distance) {
        return distance * *static_cast<const float*>(scale);
    };
    const float scale = 0.1f;
    options.occlusion_data = &scale;
    CHECK(one() == Approx(1 - 0.5 * (0.2 + 0.25)));
    const std::vector<float> weights{0.25f, 0.75f};
    options.weights = weights;
    CHECK(one() == Approx(1 - (0.25 * 0.2 + 0.75 * 0.25)));
}

TEST_CASE("Solid ground hides what goes against its normal") {
    EmbreeScene scene(EmbreeUse::kFast);
    scene.add_mesh(test::box_mesh({50, 50, 50}, {51, 51, 51}));
    scene.commit();
    const std::vector<glm::vec3> positions{{0, 0, 1}, {0, 0, 1}, {0, 0, -1}},
        normals{{0, 0, 1}, {1, 0, 0}, {0, 0, -1}};
    const auto directions = cosine_directions(4096);
    RayVisibilityOptions options;
    options.directions = directions;
    const std::vector<float> ground{0, 0, 1, 0};
    options.ground = ground;
    const auto visibility = ray_visibility(scene, positions, normals, options);
    CHECK(visibility[0] > 0.99f);
    CHECK(visibility[1] == Approx(0.5).margin(0.01));
    CHECK(visibility[2] == 0);
}

TEST_CASE("Self-visibility: convex is open, a box's inside is closed") {
    const TriangleMesh sphere = test::sphere_mesh({5, 5, 5}, 2);
    for (const float value : self_visibility(sphere, 256, 0)) REQUIRE(value > 0.98f);
    TriangleMesh box =
        test::box_mesh({0, 0, 0}, {1, 2, 3});  // vertices shared by three sides: long triangles
    compute_normals(box);
    for (const float value : self_visibility(box, 256, 0)) REQUIRE(value == 1);
    TriangleMesh inside = test::box_mesh({0, 0, 0}, {1, 1, 1});
    for (const glm::vec3& p : inside.positions) inside.normals.push_back(glm::normalize(glm::vec3(0.5f) - p));
    for (const float value : self_visibility(inside, 256, 0)) REQUIRE(value < 0.02f);
}

TEST_CASE("Shared directions: weight by the cosine, masks of those that the receiver faces") {
    EmbreeScene scene(EmbreeUse::kFast);
    scene.add_mesh(test::box_mesh({-100, -100, 2}, {100, 100, 3}));  // a ceiling 2 above
    scene.commit();
    const std::vector<glm::vec3> positions(3, glm::vec3(0)), normals{{0, 0, 1}, {1, 0, 0}, {0, 0, -1}};
    const std::vector<glm::vec3> directions{{0, 0, 1}, {1, 0, 0}, {0.6f, 0, 0.8f}, {0, 0, -1}};
    RayVisibilityOptions options;
    options.directions = directions;
    options.shared = true;
    const auto visibility = [&] { return ray_visibility(scene, positions, normals, options); };
    const auto masks = [&] { return ray_masks(scene, positions, normals, options); };
    CHECK(masks() == std::vector<std::uint32_t>{0b0101, 0b0100, 0});
    CHECK(visibility()[0] == 0);
    CHECK(visibility()[1] == Approx(1 - 0.6 / 1.6));
    CHECK(visibility()[2] == 1);
    options.max_distance = 2.2f;  // the slanted ray meets the ceiling at 2.5
    CHECK(masks() == std::vector<std::uint32_t>{0b0001, 0, 0});
    CHECK(visibility()[0] == Approx(1 - 1 / 1.8));
    const std::vector<float> ground{0, 0, 1, -1};  // below z = -1
    options.ground = ground;
    CHECK(masks() == std::vector<std::uint32_t>{0b0001, 0, 0b1000});
    CHECK(visibility()[2] == 0);

    // 33 directions take two words; rays around the normal have masks too.
    const std::vector<glm::vec3> many = cosine_directions(33);
    RayVisibilityOptions around;
    around.directions = many;
    CHECK(ray_masks(scene, {positions.data(), 1}, {normals.data(), 1}, around) ==
          std::vector<std::uint32_t>{0xffffffff, 1});
}
