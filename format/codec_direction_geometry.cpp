#include "format/codec_direction_geometry.hpp"

#include <cmath>

namespace dfield::codec {
namespace {

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

constexpr double kQuarterTurn = 1.5707963267948966;

// (cos, sin) of j / k quarter turns. The C library's may differ in the last bit from one to the next.
std::array<double, 2> unit_circle(std::uint32_t j, std::uint32_t k) {
    const double x = kQuarterTurn * (j % k) / k, squared = x * x;
    double cosine = 1, sine = 1;
    for (int i = 20; i >= 2; i -= 2) {
        cosine = 1 - cosine * squared / ((i - 1) * i);
        sine = 1 - sine * squared / (i * (i + 1));
    }
    sine = sine * x;
    switch (j / k) {
        case 0:
            return {cosine, sine};
        case 1:
            return {-sine, cosine};
        case 2:
            return {-cosine, -sine};
        default:
            return {sine, -cosine};
    }
}

}  // namespace

DirectionPlane direction_plane(std::uint32_t subdivision, const DirectionPlace& place,
                               const PackedDirectionFrame& frame) {
    const double share = static_cast<double>(place.ring) / subdivision;
    const double z = (1 - share) * (1 + share), radius = share * std::sqrt(1 + z);
    const auto [cosine, sine] = unit_circle(place.j, std::max(1u, place.ring));
    const double x = radius * cosine, y = radius * sine;

    // The frame rule, with sigma = 1, and its turn by the rectangle's angle.
    const double a = -1 / (1 + z), b = x * y * a;
    const Vector tangent = {1 + x * x * a, b, -x}, bitangent = {b, 1 + y * y * a, -y};
    const double half_tangent = frame[0] / 256.0;
    const double scale = 1 / (1 + half_tangent * half_tangent);
    const double c = (1 - half_tangent * half_tangent) * scale, s = 2 * half_tangent * scale;

    DirectionPlane plane;
    plane.direction = {x, y, z};
    for (std::size_t i = 0; i < 3; ++i) {
        plane.axis_u[i] = c * tangent[i] + s * bitangent[i];
        plane.axis_v[i] = c * bitangent[i] - s * tangent[i];
    }
    plane.centre_u = (frame[1] - 128) / 128.0;
    plane.centre_v = (frame[2] - 128) / 128.0;
    plane.half_u = (frame[3] + 1) / 256.0;
    plane.half_v = (frame[4] + 1) / 256.0;
    plane.depth = (frame[5] - 128) / 128.0;
    plane.slope_u = (frame[6] - 128) / 64.0;
    plane.slope_v = (frame[7] - 128) / 64.0;
    return plane;
}

TexelTransform texel_transform(const DirectionPlane& from, const DirectionPlane& to, std::uint32_t map_size) {
    const double m = map_size;
    struct Place {
        double s, t;
    };
    const auto seen = [&](double s, double t) {
        const double u = ((2 * s + 1) / m - 1) * from.half_u, v = ((2 * t + 1) / m - 1) * from.half_v;
        const double w = from.depth + from.slope_u * u + from.slope_v * v;
        Vector x;
        for (std::size_t i = 0; i < 3; ++i)
            x[i] = (from.centre_u + u) * from.axis_u[i] + (from.centre_v + v) * from.axis_v[i] +
                   w * from.direction[i];
        const auto texel = [&](double coordinate, double centre, double half) {
            return (((coordinate - centre) / half + 1) * m - 1) / 2;
        };
        return Place{texel(dot(x, to.axis_u), to.centre_u, to.half_u),
                     texel(dot(x, to.axis_v), to.centre_v, to.half_v)};
    };
    const Place origin = seen(0, 0), right = seen(1, 0), down = seen(0, 1);
    const auto fixed = [](double value) {
        return static_cast<std::int64_t>(std::floor(value * 65536 + 0.5));
    };
    return {fixed(origin.s), fixed(right.s - origin.s), fixed(down.s - origin.s),
            fixed(origin.t), fixed(right.t - origin.t), fixed(down.t - origin.t)};
}

}  // namespace dfield::codec
