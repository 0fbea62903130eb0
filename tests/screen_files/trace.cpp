// What a camera sees of scenes whose depth and normals are known.
#include <catch2/catch.hpp>
#include <cmath>

#include "baker/screen/lit_scene.hpp"
#include "baker/screen/ray_reference.hpp"
#include "tests/screen_files/scenes.hpp"

using namespace dfield;
using namespace dfield::test;

TEST_CASE("the ground from above: depth, normals, light and sky") {
    const ImportedScene imported = ground_and_wall(false);
    LitScene scene(imported);
    scene.set_sun({{0, 2, 0}, {1, 0.5f, 0.25f}});
    CHECK(scene.longest_side() == 100);
    for (const bool orthographic : {false, true}) {
        ScreenCamera camera = look_at({1, 4, 2}, {1, 0, 2}, {0, 0, -1}, 60, 1.5f);
        camera.orthographic = orthographic;
        std::vector<std::uint32_t> instances;
        const GBuffer buffer = trace_gbuffer(scene, camera, 30, 20, {7, 8, 9}, 1, &instances);
        for (std::size_t i = 0; i < buffer.pixels(); ++i) {
            REQUIRE(buffer.depth[i] == Approx(4));  // along the axis, not along the ray
            REQUIRE(glm::length(buffer.normals[i] - glm::vec3(0, 0, 1)) < 1e-6f);
            REQUIRE(glm::length(buffer.albedo[i] - glm::vec3(0.5f)) < 1e-6f);
            REQUIRE(glm::length(buffer.radiance[i] - glm::vec3(0.5f, 0.25f, 0.125f)) < 1e-6f);
            REQUIRE(instances[i] == 0);
            const ScreenPoint point = world_point(buffer, static_cast<std::uint32_t>(i));
            REQUIRE(std::fabs(point.position.y) < 1e-5f);
            REQUIRE(glm::length(point.normal - glm::vec3(0, 1, 0)) < 1e-6f);
        }
        // The picture's upper left pixel is far along -x and -z.
        const glm::vec3 first = world_point(buffer, 0).position;
        CHECK(first.x < 1);
        CHECK(first.z < 2);
    }
    const GBuffer sky =
        trace_gbuffer(scene, look_at({0, 1, 0}, {0, 2, 0}, {0, 0, -1}, 60, 1), 4, 4, {7, 8, 9}, 1);
    CHECK(sky.depth == std::vector<float>(16, std::numeric_limits<float>::infinity()));
    CHECK(sky.radiance == std::vector<glm::vec3>(16, {7, 8, 9}));
    CHECK(surface_pixels(sky, 10).empty());
}

TEST_CASE("seen from behind, a surface faces the camera; clip planes cut") {
    const ImportedScene imported = ground_and_wall(false);
    const LitScene scene(imported);
    ScreenCamera camera = look_at({0, -2, 0}, {0, 0, 0}, {0, 0, -1}, 40, 1);
    CHECK(trace_gbuffer(scene, camera, 2, 2, {}, 1).normals[0].z == Approx(1));
    camera.far = 1.5f;
    CHECK_FALSE(is_surface(trace_gbuffer(scene, camera, 2, 2, {}, 1).depth[0]));
    camera.near = 1;
    camera.far = 9;
    CHECK(is_surface(trace_gbuffer(scene, camera, 2, 2, {}, 1).depth[0]));
}

TEST_CASE("shadows and threads") {
    ImportedScene imported = ground_and_wall(false);
    add_rectangle(imported, {-1, 3, 1}, {2, 0, 0}, {0, 0, -2}, glm::vec3(1));
    LitScene scene(imported);
    scene.set_sun({{0, 1, 0}, {1, 1, 1}});
    const ScreenCamera camera = look_at({0, 2.5f, 9}, {0, 0, 0}, {0, 1, 0}, 50, 1.25f);
    const GBuffer one = trace_gbuffer(scene, camera, 50, 40, {}, 1);
    const GBuffer three = trace_gbuffer(scene, camera, 50, 40, {}, 3);
    CHECK(one.depth == three.depth);
    CHECK(one.radiance == three.radiance);
    std::size_t shaded = 0;
    for (std::size_t i = 0; i < one.pixels(); ++i) {
        if (!is_surface(one.depth[i])) continue;
        const glm::vec3 at = world_point(one, static_cast<std::uint32_t>(i)).position;
        if (at.y > 1 || std::fabs(std::max(std::fabs(at.x), std::fabs(at.z)) - 1) < 0.01f) continue;
        const bool below = std::max(std::fabs(at.x), std::fabs(at.z)) < 1;
        shaded += below;
        REQUIRE(one.radiance[i].x == Approx(below ? 0 : 0.5).margin(1e-6));
    }
    CHECK(shaded > 10);
}

TEST_CASE("framing holds the whole box") {
    const Bounds box{{-1, 0, -3}, {2, 5, 4}};
    for (const glm::vec3 view : {glm::vec3(1, 1, 1), {0, 1, 0}, {-1, 0, 0.2f}})
        for (const ScreenCamera& camera : {frame_perspective(box, view, {0, 1, 0}, 40, 1.5f),
                                           frame_orthographic(box, view, {0, 1, 0}, 1.5f)}) {
            const glm::mat4 to_camera = glm::inverse(camera.to_world);
            float most = 0;
            for (int i = 0; i < 8; ++i) {
                const glm::vec4 corner(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                                       i & 4 ? box.max.z : box.min.z, 1);
                const glm::vec3 seen(to_camera * corner);
                const float depth = camera.orthographic ? 1 : -seen.z;
                CHECK(seen.z < 0);
                most = std::max({most, std::fabs(seen.x) / (camera.half_width * depth),
                                 std::fabs(seen.y) / (camera.half_height * depth)});
            }
            CHECK(most < 1);
            CHECK(most > 0.9f);
        }
}
