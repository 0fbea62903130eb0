// The camera of a G-buffer: camera space is right-handed, x right, y up, and the camera looks along -z (glTF,
// OpenGL). Pixel (0, 0) is the picture's upper left one; pixel centres lie at + 0.5. Depth is the positive
// distance along -z.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>

#include "baker/mesh.hpp"

namespace dfield {

struct ScreenCamera {
    glm::mat4 to_world{1};  // a rotation and a translation
    bool orthographic = false;
    // Perspective: tangents of the angles from the middle to the picture's borders; orthographic: world
    // units. Above 0.
    float half_width = 1, half_height = 1;
    // Where the picture's middle lies off the axis, right and up, in the units of the half sizes.
    glm::vec2 offset{0};
    // Surfaces are seen between them. For device depth, near is the depth of its 0 and far that of its 1:
    // reversed z has near beyond far, and one of them may be infinite.
    float near = 0, far = std::numeric_limits<float>::infinity();
};

struct CameraRay {
    glm::vec3 origin, direction;  // direction.z is -1: the ray's parameter is the depth
};
// Through the point (x, y) of a picture of that many pixels, in camera space.
CameraRay camera_ray(const ScreenCamera& camera, float x, float y, std::uint32_t width, std::uint32_t height);

// Depth from device depth d; infinite (sky) for what a cleared buffer holds, the farther of 0 and 1, and
// outside 0..1.
float depth_of_device(const ScreenCamera& camera, float d);

// Whether a depth is that of a surface: above 0 and finite.
inline bool is_surface(float depth) {
    return depth > 0 && depth < std::numeric_limits<float>::infinity();
}

// From `eye` to `target`, which differ; fov: the vertical angle. aspect = width / height.
ScreenCamera look_at(const glm::vec3& eye, const glm::vec3& target, const glm::vec3& up, float fov_degrees,
                     float aspect);
// The whole box in view, seen from a direction (towards the eye).
ScreenCamera frame_perspective(const Bounds& bounds, const glm::vec3& direction_to_eye, const glm::vec3& up,
                               float fov_degrees, float aspect);
ScreenCamera frame_orthographic(const Bounds& bounds, const glm::vec3& direction_to_eye, const glm::vec3& up,
                                float aspect);

}  // namespace dfield
