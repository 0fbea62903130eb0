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
    Camera sight;                      // of the rays of sight: all 0 where they are parallel to the axis
    float radius = 0, per_radius = 0;  // world units, and its inverse
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
    float per_x, per_y;      // and its inverse
    glm::vec3 normal;        // towards the viewer
};

// The cosine between the normal and the ray of sight is at least this.
constexpr float kGrazing = 1e-3f;

// What R spans at most, in pixels: so much more than a picture that more makes no difference.
constexpr float kMostPixels = 1e30f;

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
    s.per_x = std::min(1 / s.pixel_x, kMostPixels);
    s.per_y = std::min(1 / s.pixel_y, kMostPixels);
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

// Where a point around s is looked up, along the ray of sight on the plane of s: columns to the right of s
// and rows below it; and its z. Linear in the point.
inline glm::vec3 in_pixels(const Shaded& s, const glm::vec3& point) {
    return {(point.x + point.z * s.sight_x) * s.per_x, (point.y + point.z * s.sight_y) * -s.per_y, point.z};
}

// What is seen there.
struct Seen {
    float x, y;                // on the plane of s
    std::int32_t column, row;  // -1 and width, or height, for what is outside
    float rise;                // the surface's z there: -infinity for sky
};
inline Seen look_up(const Frame& frame, const Shaded& s, float columns, float rows) {
    const Layout& layout = frame.layout;
    // In floats, so that nothing is too far away to be clamped; NaN is 0.
    const auto pixel = [](float by, std::int32_t from, std::int32_t count) {
        const float at = by + (static_cast<float>(from) + 1.5f);
        return static_cast<std::int32_t>(std::min(std::max(0.0f, at), static_cast<float>(count + 1))) - 1;
    };
    Seen seen{columns * s.pixel_x, -rows * s.pixel_y, pixel(columns, s.column, layout.width),
              pixel(rows, s.row, layout.height), 0};
    seen.rise = (s.depth - frame.depth[layout.index(seen.column, seen.row)]) * frame.per_radius;
    return seen;
}

// Fills frame.depth, a plane of frame.layout, from the caller's.
void decode_depth(const dfield_context& context, const Frame& frame, float* depth);

}  // namespace dfield::runtime::screen
