#include "baker/picture/camera.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <stdexcept>

#include "baker/parallel.hpp"

namespace dfield {

ViewBasis view_basis(const glm::vec3& back, const glm::vec3& up) {
    ViewBasis basis;
    basis.back = glm::normalize(back);
    glm::vec3 right = glm::cross(up, basis.back);
    if (glm::dot(right, right) < 1e-12f * glm::dot(up, up))
        right =
            glm::cross(std::abs(basis.back.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0), basis.back);
    basis.right = glm::normalize(right);
    basis.up = glm::cross(basis.back, basis.right);
    return basis;
}

Camera frame_bounds(const Bounds& bounds, const glm::vec3& direction_to_eye, const glm::vec3& up,
                    float fov_degrees, float aspect) {
    constexpr float kMargin = 0.96f;  // of the half picture, so 2% stay free on each side
    const ViewBasis basis = view_basis(direction_to_eye, up);
    const float tangent_y = kMargin * std::tan(0.5f * glm::radians(fov_degrees));
    const float tangent_x = tangent_y * aspect;
    // A corner at (x, z) is in view of an eye at (ex, ez) when +-(x - ex) <= (ez - z) tangent: the extremes
    // of z tangent +- x give the nearest eye for each axis, centred between them.
    constexpr float kLowest = std::numeric_limits<float>::lowest();
    float right = kLowest, left = kLowest, top = kLowest, bottom = kLowest;
    for (int i = 0; i < 8; ++i) {
        const glm::vec3 corner(i & 1 ? bounds.max.x : bounds.min.x, i & 2 ? bounds.max.y : bounds.min.y,
                               i & 4 ? bounds.max.z : bounds.min.z);
        const glm::vec3 offset = corner - bounds.centre();
        const float x = glm::dot(offset, basis.right), y = glm::dot(offset, basis.up),
                    z = glm::dot(offset, basis.back);
        right = std::max(right, z * tangent_x + x), left = std::max(left, z * tangent_x - x);
        top = std::max(top, z * tangent_y + y), bottom = std::max(bottom, z * tangent_y - y);
    }
    const float distance = std::max(0.5f * (right + left) / tangent_x, 0.5f * (top + bottom) / tangent_y);
    Camera camera;
    camera.target = bounds.centre() + 0.5f * (right - left) * basis.right + 0.5f * (top - bottom) * basis.up;
    camera.eye = camera.target + distance * basis.back;
    camera.up = up;
    camera.vertical_fov_degrees = fov_degrees;
    return camera;
}

Image render_rays(const Camera& camera, const RenderOptions& options, const RayColour& colour) {
    if (camera.eye == camera.target || camera.up == glm::vec3(0) || options.samples == 0)
        throw std::invalid_argument("render: a camera without direction, or no samples");
    const ViewBasis basis = view_basis(camera.eye - camera.target, camera.up);
    const float half_height = std::tan(0.5f * glm::radians(camera.vertical_fov_degrees));
    const float pixel = 2 * half_height / static_cast<float>(options.height);
    const auto n = options.samples;
    const auto n_squared = static_cast<float>(n * n);

    // Sample (i, j) of a pixel lies in cell (i, j) of an n x n grid and alone in its column and row of an n^2
    // x n^2 grid, so an upright edge gets n^2 + 1 greys rather than n + 1.
    const auto sample_colour = [&](std::uint32_t x, std::uint32_t y, std::uint32_t i, std::uint32_t j) {
        const float px = static_cast<float>(x) + (static_cast<float>(i * n + j) + 0.5f) / n_squared;
        const float py = static_cast<float>(y) + (static_cast<float>(j * n + i) + 0.5f) / n_squared;
        const glm::vec3 direction = (px - 0.5f * static_cast<float>(options.width)) * pixel * basis.right +
                                    (half_height - py * pixel) * basis.up - basis.back;
        return colour(camera.eye, direction).value_or(options.background);
    };

    Image image(options.width, options.height);
    parallel_ranges(options.threads, options.height, 4, [&](std::size_t begin, std::size_t end) {
        for (auto y = static_cast<std::uint32_t>(begin); y < end; ++y)
            for (std::uint32_t x = 0; x < options.width; ++x) {
                glm::vec3 sum(0);
                for (std::uint32_t j = 0; j < n; ++j)
                    for (std::uint32_t i = 0; i < n; ++i) sum += sample_colour(x, y, i, j);
                for (int c = 0; c < 3; ++c)
                    image.at(x, y)[c] = static_cast<std::uint8_t>(
                        std::lround(255.0f * std::clamp(sum[c] / n_squared, 0.0f, 1.0f)));
            }
    });
    return image;
}

}  // namespace dfield
