// Section 4.5: pipes along the ray of sight, and the integral h along them.
//
// docs/screen.md derives what stands here. With q the pipe's nearest point to s, at distance rho, and t along
// the ray towards the viewer, the points of the pipe lie at distance r = sqrt(rho^2 + t^2) and (o - s).N = a
// + b t, so
//     h = integral mu'(r) / r^3 (a + b t) dt.
#pragma once

#include <algorithm>
#include <cmath>

#include "screen/frame.hpp"
#include "screen/measure.hpp"

namespace dfield::runtime::screen {

struct Pipe {
    float rho2, a, b;
    float low,
        high;      // where it lies in the sphere and in front of the tangent plane: empty unless low < high
    float ground;  // t of the surface's end of it, -infinity for sky

    // The pipe through the pixel `columns` to the right of s's and `rows` below it, whose surface has the z
    // `rise`.
    Pipe(const Shaded& s, float columns, float rows, float rise) {
        const float x = columns * s.pixel_x, y = -rows * s.pixel_y;
        const float length = std::sqrt(s.sight_2);
        const float along = (x * s.sight_x + y * s.sight_y) / length;
        const float facing = (s.normal.z - s.normal.x * s.sight_x - s.normal.y * s.sight_y) / length;
        rho2 = x * x + y * y - along * along;
        a = s.normal.x * x + s.normal.y * y + along * facing;
        b = facing;
        ground = rise * length - along;
        const float half = std::sqrt(std::max(0.0f, 1 - rho2));
        high = half;
        low = std::clamp(-a / b, -half, half);  // b >= kGrazing
    }
};

// h between t = low and t = high. Only the quartic measure's is bounded in the middle: rho2 is not 0 for
// others.
float pipe_integral(const Measure& measure, const Pipe& pipe, float low, float high);

// The squared distance that stands for those within s's own pixel, whose disk of the same area has the radius
// p: p / 2 has the mean of 1 / rho over it.
inline float own_rho2(float pixel_x, float pixel_y) {
    return pixel_x * pixel_y / (4 * 3.14159265f);
}

// Gauss and Legendre's eight points between -1 and 1: these and their opposites.
constexpr float kGaussNodes[4] = {0.1834346425f, 0.5255324099f, 0.7966664774f, 0.9602898565f};
constexpr float kGaussWeights[4] = {0.3626837834f, 0.3137066459f, 0.2223810345f, 0.1012285363f};

}  // namespace dfield::runtime::screen
