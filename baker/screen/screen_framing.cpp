#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "baker/picture/camera.hpp"
#include "baker/screen/screen_camera.hpp"

namespace dfield {
namespace {

glm::mat4 pose(const ViewBasis& basis, const glm::vec3& eye) {
    return {glm::vec4(basis.right, 0), glm::vec4(basis.up, 0), glm::vec4(basis.back, 0), glm::vec4(eye, 1)};
}

}  // namespace

ScreenCamera look_at(const glm::vec3& eye, const glm::vec3& target, const glm::vec3& up, float fov_degrees,
                     float aspect) {
    ScreenCamera camera;
    camera.to_world = pose(view_basis(eye - target, up), eye);
    camera.half_height = std::tan(0.5f * glm::radians(fov_degrees));
    camera.half_width = aspect * camera.half_height;
    return camera;
}

ScreenCamera frame_perspective(const Bounds& bounds, const glm::vec3& direction_to_eye, const glm::vec3& up,
                               float fov_degrees, float aspect) {
    const Camera framed = frame_bounds(bounds, direction_to_eye, up, fov_degrees, aspect);
    return look_at(framed.eye, framed.target, up, fov_degrees, aspect);
}

ScreenCamera frame_orthographic(const Bounds& bounds, const glm::vec3& direction_to_eye, const glm::vec3& up,
                                float aspect) {
    constexpr float kMargin = 1.04f;
    const ViewBasis basis = view_basis(direction_to_eye, up);
    const glm::vec3 half = 0.5f * bounds.size();
    const auto extent = [&](const glm::vec3& axis) { return glm::dot(glm::abs(axis), half); };
    const float depth = extent(basis.back);
    ScreenCamera camera;
    camera.orthographic = true;
    // A box seen edge-on still has a picture.
    const float smallest = 1e-3f * std::max(glm::length(half), 1e-30f);
    camera.half_height = kMargin * std::max({extent(basis.up), extent(basis.right) / aspect, smallest});
    camera.half_width = aspect * camera.half_height;
    camera.to_world = pose(basis, bounds.centre() + 2 * std::max(depth, smallest) * basis.back);
    return camera;
}

}  // namespace dfield
