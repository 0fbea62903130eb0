// Pixels and camera space.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "dfield/screen.h"

namespace dfield::runtime::screen {

constexpr float kSky = std::numeric_limits<float>::infinity();

// Pixel (column, row) at depth d shows the point (x, y, -d) with x = at_x(column), y = at_y(row), both times
// d with perspective.
struct Camera {
    bool perspective = true;
    float left = 0, top = 0;       // of the first pixel's centre
    float step_x = 0, step_y = 0;  // from a pixel to the next, > 0; y falls with the row

    Camera() = default;
    Camera(const dfield_screen_camera& given, std::uint32_t width, std::uint32_t height)
        : perspective(given.projection == DFIELD_PROJECTION_PERSPECTIVE),
          left(given.offset_x - given.half_width + given.half_width / static_cast<float>(width)),
          top(given.offset_y + given.half_height - given.half_height / static_cast<float>(height)),
          step_x(2 * given.half_width / static_cast<float>(width)),
          step_y(2 * given.half_height / static_cast<float>(height)) {}

    float at_x(std::int64_t column) const { return left + static_cast<float>(column) * step_x; }
    float at_y(std::int64_t row) const { return top - static_cast<float>(row) * step_y; }
};

// World depth of a pixel, kSky for sky.
struct DepthDecoder {
    bool device = false, perspective = true;
    // The planes' depths, or their inverses: what the value runs between linearly. Interpolated, and not by a
    // constant and a slope, since 1 - value is exact where it is small.
    float at_zero = 0, at_one = 0;
    float farthest = 0;  // the value of the farther plane: sky

    DepthDecoder() = default;
    DepthDecoder(const dfield_screen_camera& camera, std::uint32_t encoding)
        : device(encoding == DFIELD_DEPTH_DEVICE),
          perspective(camera.projection == DFIELD_PROJECTION_PERSPECTIVE) {
        if (!device) return;
        const float near = camera.near_plane, far = camera.far_plane;
        at_zero = perspective ? 1 / near : near;
        at_one = perspective ? 1 / far : far;
        farthest = far > near ? 1.0f : 0.0f;
    }
    float operator()(float value) const {
        if (device) {
            if (!(value >= 0 && value <= 1) || value == farthest) return kSky;
            value = (1 - value) * at_zero + value * at_one;
            if (perspective) value = 1 / value;
        }
        return value > 0 && value < kSky ? value : kSky;
    }
};

}  // namespace dfield::runtime::screen
