// A frame as the estimators see it: world depths, unit normals, and what is known of a shaded point.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "context.hpp"
#include "screen/camera.hpp"
#include "screen/pixels.hpp"

namespace dfield::runtime::screen {

struct Frame {
    Layout layout;
    Camera camera;
    Camera sight;  // of the rays of sight: all 0 where they are parallel to the axis
    float radius = 0;
    DepthDecoder decode;
    StridedPixels<const float> depths, normals, radiance, albedo;  // the caller's
    const float* depth = nullptr;                                  // world units, the border is sky
};

// A point to be shaded. Lengths around it are in units of R, with x and y from it and z towards the viewer.
struct Shaded {
    std::int32_t column, row;
    float depth;             // world units, finite
    float sight_x, sight_y;  // the ray of sight is (sight_x, sight_y, -1)
    float sight_2;           // its squared length
    float pixel_x, pixel_y;  // a pixel's size
    glm::vec3 normal;        // towards the viewer
};

// The cosine between the normal and the ray of sight is at least this.
constexpr float kGrazing = 1e-3f;

// A unit normal that does not look away from the viewer. 0,0,0 where there is none.
inline glm::vec3 towards_viewer(glm::vec3 normal, const glm::vec3& viewer) {
    const float facing = normal.x * viewer.x + normal.y * viewer.y + normal.z * viewer.z;
    if (!(facing < kGrazing)) return normal;
    const glm::vec3 across = normal - facing * viewer;
    const float length = std::sqrt(across.x * across.x + across.y * across.y + across.z * across.z);
    return length > 0.5f ? across / length * std::sqrt(1 - kGrazing * kGrazing) + kGrazing * viewer : viewer;
}

// The caller's normal at a pixel, or the one that its neighbours' depths suggest: unit length.
glm::vec3 normal_at(const Frame& frame, std::int32_t column, std::int32_t row);

// A pixel that is not sky.
inline Shaded shaded_at(const Frame& frame, std::int32_t column, std::int32_t row) {
    Shaded s;
    s.column = column;
    s.row = row;
    s.depth = frame.depth[frame.layout.index(column, row)];
    s.sight_x = frame.sight.at_x(column);
    s.sight_y = frame.sight.at_y(row);
    s.sight_2 = s.sight_x * s.sight_x + (s.sight_y * s.sight_y + 1);
    const float scale = (frame.camera.perspective ? s.depth : 1.0f) / frame.radius;
    s.pixel_x = frame.camera.step_x * scale;
    s.pixel_y = frame.camera.step_y * scale;
    const float inverse = 1 / std::sqrt(s.sight_2);
    s.normal =
        towards_viewer(normal_at(frame, column, row), {-s.sight_x * inverse, -s.sight_y * inverse, inverse});
    return s;
}

// How many pixels of a row R spans, as it is seen across the ray of sight.
inline float reach_of(const Shaded& s) {
    return std::sqrt(s.sight_2) / s.pixel_x;
}
// A neighbourhood within half a pixel, and one of no size: nothing is seen of it.
inline bool empty(const Shaded& s) {
    return !(std::max(std::sqrt(s.sight_2) / s.pixel_x, std::sqrt(s.sight_2) / s.pixel_y) > 0.5f);
}

// How the depth of the tangent plane changes from a pixel to the next to the right, and downwards: world
// units.
inline glm::vec2 slopes_of(const Frame& frame, const Shaded& s) {
    const float facing = s.normal.z - (s.normal.x * s.sight_x + s.normal.y * s.sight_y);
    const float scale = frame.radius / facing;
    return {s.normal.x * s.pixel_x * scale, -s.normal.y * s.pixel_y * scale};
}

// Where a point at (x, y, z) from s is looked up: on the plane of s, along the ray of sight.
struct Seen {
    float x, y;                // on that plane
    std::int32_t column, row;  // -1 and width, or height, for what is outside
    float rise;                // the surface's z there: -infinity for sky
};
inline Seen look_up(const Frame& frame, const Shaded& s, float x, float y) {
    const Layout& layout = frame.layout;
    Seen seen{x, y, 0, 0, 0};
    // In floats, so that nothing is too far away to be clamped.
    const float column = std::floor(x / s.pixel_x + 0.5f) + static_cast<float>(s.column);
    const float row = std::floor(0.5f - y / s.pixel_y) + static_cast<float>(s.row);
    seen.column = static_cast<std::int32_t>(std::clamp(column, -1.0f, static_cast<float>(layout.width)));
    seen.row = static_cast<std::int32_t>(std::clamp(row, -1.0f, static_cast<float>(layout.height)));
    seen.rise = (s.depth - frame.depth[layout.index(seen.column, seen.row)]) / frame.radius;
    return seen;
}
inline Seen look_up(const Frame& frame, const Shaded& s, const glm::vec3& point) {
    return look_up(frame, s, point.x + point.z * s.sight_x, point.y + point.z * s.sight_y);
}

// Fills frame.depth, a plane of frame.layout, from the caller's.
void decode_depth(const dfield_context& context, const Frame& frame, float* depth);

}  // namespace dfield::runtime::screen
