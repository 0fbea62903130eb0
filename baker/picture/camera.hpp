// A perspective camera, and the picture of whatever a colour can be found for along a ray.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>

#include "baker/mesh.hpp"
#include "baker/picture/image.hpp"

namespace dfield {

struct Camera {
    glm::vec3 eye{0}, target{0}, up{0, 0, 1};  // up: also the zenith of the hemisphere shading
    float vertical_fov_degrees = 35;
};

struct RenderOptions {
    std::uint32_t width = 640, height = 480;
    std::uint32_t samples = 4;  // per pixel and axis: 4 = 16 stratified samples a pixel, box filter
    glm::vec3 background{1};
    int threads = 0;  // 0 = all
};

// Right-handed and unit, looking along -back. A view straight along `up` still gets one. Neither vector is 0.
struct ViewBasis {
    glm::vec3 right, up, back;
};
ViewBasis view_basis(const glm::vec3& back, const glm::vec3& up);

// The camera that looks from a direction (towards the eye) and stands as near as it may while all eight
// corners of the box stay in view, with a margin of 2% of the picture. aspect = width / height.
Camera frame_bounds(const Bounds& bounds, const glm::vec3& direction_to_eye, const glm::vec3& up,
                    float fov_degrees, float aspect);

// What a ray from the eye sees, or nothing where it sees the background. The direction is not a unit vector.
// Called from several threads.
using RayColour =
    std::function<std::optional<glm::vec3>(const glm::vec3& origin, const glm::vec3& direction)>;

// The picture of samples x samples rays a pixel, the same at any thread count. Throws std::invalid_argument
// for a camera without direction or no samples.
Image render_rays(const Camera& camera, const RenderOptions& options, const RayColour& colour);

}  // namespace dfield
