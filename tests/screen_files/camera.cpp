#include "baker/screen/screen_camera.hpp"

#include <catch2/catch.hpp>

#include "tests/screen_files/buffers.hpp"

using namespace dfield;
using namespace dfield::test;

TEST_CASE("device depth: forwards, reversed, infinite, orthographic") {
    // The projection of depth z to d = (a + b / z): 0 at near, 1 at far.
    const auto device = [](const ScreenCamera& camera, double z) {
        const double n = static_cast<double>(camera.near), f = static_cast<double>(camera.far);
        if (camera.orthographic) return (z - n) / (f - n);
        if (std::isinf(f)) return 1 - n / z;
        if (std::isinf(n)) return f / z;
        return f * (z - n) / (z * (f - n));
    };
    for (const bool orthographic : {false, true})
        for (const auto& [near, far] : {std::pair{0.5f, 40.0f}, {40.0f, 0.5f}, {0.5f, kSky}, {kSky, 0.5f}}) {
            if (orthographic && (near == kSky || far == kSky)) continue;
            ScreenCamera camera;
            camera.orthographic = orthographic;
            camera.near = near;
            camera.far = far;
            INFO(near << " " << far << " " << orthographic);
            for (const double z : {0.5, 0.75, 3.0, 20.0, 39.0})
                CHECK(depth_of_device(camera, static_cast<float>(device(camera, z))) ==
                      Approx(z).epsilon(1e-4));
            const bool reversed = near > far;
            CHECK(depth_of_device(camera, reversed ? 1.0f : 0.0f) == Approx(0.5));
            // What a buffer is cleared to, and what no depth is.
            for (const float sky : {reversed ? 0.0f : 1.0f, -0.1f, 1.1f, NAN})
                CHECK(depth_of_device(camera, sky) == kSky);
        }
}

TEST_CASE("camera rays go through pixel centres") {
    ScreenCamera camera;
    camera.half_width = 2;
    camera.half_height = 1;
    camera.offset = {0.5f, 0.25f};
    const CameraRay first = camera_ray(camera, 0.5f, 0.5f, 4, 2);
    CHECK(first.origin == glm::vec3(0));
    CHECK(first.direction == glm::vec3(-1.5f + 0.5f, 0.5f + 0.25f, -1));
    camera.orthographic = true;
    const CameraRay last = camera_ray(camera, 3.5f, 1.5f, 4, 2);
    CHECK(last.origin == glm::vec3(1.5f + 0.5f, -0.5f + 0.25f, 0));
    CHECK(last.direction == glm::vec3(0, 0, -1));
}
