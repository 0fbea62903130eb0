#include "baker/screen/screen_camera.hpp"

#include <cmath>

namespace dfield {

CameraRay camera_ray(const ScreenCamera& camera, float x, float y, std::uint32_t width,
                     std::uint32_t height) {
    const float u = 2 * x / static_cast<float>(width) - 1, v = 1 - 2 * y / static_cast<float>(height);
    const glm::vec3 at(camera.half_width * u + camera.offset.x, camera.half_height * v + camera.offset.y, 0);
    if (camera.orthographic) return {at, {0, 0, -1}};
    return {glm::vec3(0), {at.x, at.y, -1}};
}

float depth_of_device(const ScreenCamera& camera, float d) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const float cleared = camera.far > camera.near ? 1.0f : 0.0f;
    if (!(d >= 0 && d <= 1) || d == cleared) return kInfinity;
    const auto n = static_cast<double>(camera.near), f = static_cast<double>(camera.far);
    if (camera.orthographic) return static_cast<float>(n + d * (f - n));
    if (std::isinf(f)) return static_cast<float>(n / (1 - d));
    if (std::isinf(n)) return static_cast<float>(f / d);
    return static_cast<float>(n * f / (f + d * (n - f)));
}

}  // namespace dfield
