// Depth, normal and radiance buffers of planes and spheres, by casting rays at them.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "dfield/dfield.hpp"

namespace dfield::test {

struct Picture {
    std::uint32_t width = 0, height = 0;
    dfield_screen_camera camera{};
    std::vector<float> depth, normals, radiance;
    bool with_normals = true;

    std::size_t size() const { return depth.size(); }
    dfield_screen_buffers buffers() const {
        dfield_screen_buffers result = no_screen_buffers();
        result.width = width;
        result.height = height;
        result.camera = camera;
        result.depth.data = depth.data();
        if (with_normals) result.normals.data = normals.data();
        result.radiance.data = radiance.data();
        return result;
    }
};

// What a ray from `origin` meets: its parameter, INFINITY for nothing, and the unit normal and radiance
// there.
struct Met {
    double t = std::numeric_limits<double>::infinity();
    glm::dvec3 normal{0, 0, 1}, radiance{0};
};
using World = std::function<Met(const glm::dvec3& origin, const glm::dvec3& direction)>;

inline World plane(const glm::dvec3& normal, double offset, const glm::dvec3& radiance = glm::dvec3(1)) {
    const glm::dvec3 n = glm::normalize(normal);
    return [=](const glm::dvec3& origin, const glm::dvec3& direction) {
        const double t = (offset - glm::dot(n, origin)) / glm::dot(n, direction);
        return t > 0 ? Met{t, n, radiance} : Met{};
    };
}
inline World sphere(const glm::dvec3& centre, double radius, const glm::dvec3& radiance = glm::dvec3(1)) {
    return [=](const glm::dvec3& origin, const glm::dvec3& direction) {
        const glm::dvec3 to = origin - centre;
        const double a = glm::dot(direction, direction), b = glm::dot(to, direction),
                     d = b * b - a * (glm::dot(to, to) - radius * radius);
        if (d < 0) return Met{};
        const double t = (-b - std::sqrt(d)) / a;
        return t > 0 ? Met{t, (to + t * direction) / radius, radiance} : Met{};
    };
}
inline World nearest(std::vector<World> parts) {
    return [parts = std::move(parts)](const glm::dvec3& origin, const glm::dvec3& direction) {
        Met best;
        for (const World& part : parts)
            if (const Met met = part(origin, direction); met.t < best.t) best = met;
        return best;
    };
}

inline dfield_screen_camera perspective(double half_width, double half_height) {
    dfield_screen_camera camera{};
    camera.half_width = static_cast<float>(half_width);
    camera.half_height = static_cast<float>(half_height);
    return camera;
}
inline dfield_screen_camera orthographic(double half_width, double half_height) {
    dfield_screen_camera camera = perspective(half_width, half_height);
    camera.projection = DFIELD_PROJECTION_ORTHOGRAPHIC;
    return camera;
}

inline Picture take(const World& world, std::uint32_t width, std::uint32_t height,
                    const dfield_screen_camera& camera) {
    Picture picture{width, height, camera, {}, {}, {}, true};
    for (std::uint32_t row = 0; row < height; ++row)
        for (std::uint32_t column = 0; column < width; ++column) {
            const double u = 2 * (column + 0.5) / width - 1, v = 1 - 2 * (row + 0.5) / height;
            const double x = static_cast<double>(camera.offset_x) +
                             u * static_cast<double>(camera.half_width),
                         y = static_cast<double>(camera.offset_y) +
                             v * static_cast<double>(camera.half_height);
            const bool orthographic = camera.projection == DFIELD_PROJECTION_ORTHOGRAPHIC;
            const Met met = orthographic ? world({x, y, 0}, {0, 0, -1}) : world({0, 0, 0}, {x, y, -1});
            picture.depth.push_back(static_cast<float>(met.t));
            const bool away =
                glm::dot(met.normal, glm::dvec3(orthographic ? 0 : x, orthographic ? 0 : y, -1)) > 0;
            for (int i = 0; i < 3; ++i) {
                picture.normals.push_back(static_cast<float>(away ? -met.normal[i] : met.normal[i]));
                picture.radiance.push_back(static_cast<float>(met.radiance[i]));
            }
        }
    return picture;
}

struct Shot {
    std::vector<float> visibility, indirect;
};

inline Shot shade(const Picture& picture, const dfield_screen_desc& desc, const Context& context,
                  bool indirect = false) {
    Shot shot;
    shot.visibility.resize(picture.size());
    if (indirect) shot.indirect.resize(3 * picture.size());
    dfield_screen_outputs outputs = no_screen_outputs();
    outputs.visibility.data = shot.visibility.data();
    outputs.indirect.data = indirect ? shot.indirect.data() : nullptr;
    Screen(context, desc).shade(picture.buffers(), outputs);
    return shot;
}
inline Context context_of(dfield_simd simd) {
    dfield_context_desc desc{};
    desc.struct_size = sizeof desc;
    desc.simd = simd;
    return Context(&desc);
}

// The limit of what a desc's estimator computes, at some pixels.
inline Shot integral(const Picture& picture, const dfield_screen_desc& desc,
                     const std::vector<std::uint32_t>& pixels, bool indirect = false) {
    Shot shot;
    shot.visibility.resize(pixels.size());
    if (indirect) shot.indirect.resize(3 * pixels.size());
    const Context context;
    Screen(context, desc)
        .integral(picture.buffers(), pixels.data(), pixels.size(), shot.visibility.data(),
                  indirect ? shot.indirect.data() : nullptr);
    return shot;
}

}  // namespace dfield::test
