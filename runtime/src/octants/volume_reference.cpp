// The lookup of an occlusion volume, receiver by receiver; how it is meant is in docs/decisions.md,
// "Occlusion volumes".
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>

#include "format/octahedral.hpp"
#include "octants/volume_caster.hpp"
#include "stretch.hpp"

namespace dfield::runtime {

VolumeCaster::VolumeCaster(const Instance& instance)
    : volume(&*instance.field->maps.volume),
      to_unit(instance.to_unit),
      unit_offset(instance.unit_offset),
      to_world(instance.to_world),
      unit_volume(std::fabs(glm::determinant(instance.to_world))),
      bounding_ball(1.0001f * stretch(instance.to_world)),
      box_centre(instance.box_centre),
      box_half(instance.box_half),
      cones(instance.to_world) {
    const DisplacementField& field = instance.field->maps;
    const float samples = field.radius / volume->spacing;
    to_grid = samples * to_unit;
    grid_offset = samples * unit_offset + (field.centre - volume->origin) / volume->spacing;
    last = {volume->dims[0] - 1, volume->dims[1] - 1, volume->dims[2] - 1};
    blend = volume->spacing / volume->blend;
}

namespace {

using OctantDarkness = std::array<float, kOctantCount>;  // 0 = open

// Within 0..high; 0 for NaN, which transforms of huge positions may give.
float within(float value, float high) {
    return value > 0 ? std::min(value, high) : 0.0f;
}

// Trilinear, at the grid's nearest place.
OctantDarkness darkness_at(const OcclusionVolume& volume, const glm::vec3& at) {
    std::array<std::size_t, 3> low;
    glm::vec3 fraction;
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t a = static_cast<std::size_t>(axis);
        const float place = within(at[axis], static_cast<float>(volume.dims[a] - 1));
        low[a] = std::min(static_cast<std::size_t>(place), std::size_t{volume.dims[a]} - 2);
        fraction[axis] = place - static_cast<float>(low[a]);
    }
    OctantDarkness sum{};
    for (std::size_t corner = 0; corner < 8; ++corner) {
        std::array<std::size_t, 3> sample;
        float weight = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool high = (corner >> axis & 1) != 0;
            sample[axis] = low[axis] + (high ? 1 : 0);
            weight *= high ? fraction[static_cast<int>(axis)] : 1 - fraction[static_cast<int>(axis)];
        }
        const std::size_t index = sample[0] + volume.dims[0] * (sample[1] + volume.dims[1] * sample[2]);
        for (std::size_t octant = 0; octant < kOctantCount; ++octant)
            sum[octant] += weight * (1 - static_cast<float>(volume.octant(index, octant)) / 255);
    }
    return sum;
}

struct Ball {
    glm::vec3 middle;
    float radius;
};

// The ball that stands for the object in a direction; unit sphere's space.
Ball far_ball(const OcclusionVolume& volume, const glm::vec3& direction) {
    const float nodes = static_cast<float>(volume.far_size - 1);
    const glm::vec2 place = (octahedral_place(direction) + 1.0f) * (0.5f * nodes);
    const glm::vec2 at(within(place.x, nodes), within(place.y, nodes));
    const glm::vec2 low = glm::min(glm::floor(at), glm::vec2(nodes - 1)), f = at - low;
    Ball sum{glm::vec3(0), 0};
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const std::size_t s = static_cast<std::size_t>(low.x) + (corner & 1),
                          t = static_cast<std::size_t>(low.y) + (corner >> 1);
        const FarBall ball = unpack_far_ball(volume.far[t * volume.far_size + s]);
        const float weight = (corner & 1 ? f.x : 1 - f.x) * (corner & 2 ? f.y : 1 - f.y);
        sum.middle += weight * (glm::vec3(ball.x, ball.y, ball.z) - 128.0f) / 127.0f;
        sum.radius += weight * static_cast<float>(ball.radius) / 255;
    }
    return sum;
}

// Equation 4 of the paper, darkness for light, in the axes of the instance.
float near_occlusion(const VolumeCaster& caster, const glm::vec3& at, const glm::vec3& normal) {
    const OctantDarkness darkness = darkness_at(*caster.volume, at);
    const auto terms = octant_terms(caster.cones, normal);
    float sum = 0;
    for (std::size_t octant = 0; octant < kOctantCount; ++octant) sum += darkness[octant] * terms[octant];
    return sum / glm::pi<float>();
}

float visibility_of(const VolumeCaster& caster, const glm::vec3& position, const glm::vec3& normal) {
    // Nothing of what lies behind the receiver's tangent plane, box and all. Planes are carried by the
    // transpose.
    const glm::vec3 unit = caster.to_unit * position + caster.unit_offset, plane = normal * caster.to_world;
    if (glm::dot(plane, caster.box_centre - unit) + glm::dot(glm::abs(plane), caster.box_half) <= 0) return 1;

    // Within the grid, a little off the surface.
    const glm::vec3 step = caster.to_grid * normal;
    const glm::vec3 at = caster.to_grid * position + caster.grid_offset +
                         step * (kOffSurface / std::sqrt(glm::dot(step, step)));
    const glm::vec3 margin = glm::min(at, caster.last - at);
    const float share = within(caster.blend * std::min({margin.x, margin.y, margin.z}), 1);
    const float near = near_occlusion(caster, at, normal);

    // Beyond it: a ball. Of the cone in which it is seen, the linear map scales the area that it cuts out of
    // the plane at distance 1 by its volume over the cube of its stretch, so the cone's tan^2 = sin^2 / (1 -
    // sin^2).
    const float from_middle = std::sqrt(std::max(glm::dot(unit, unit), 1e-12f));
    const Ball ball = far_ball(*caster.volume, unit / from_middle);
    const glm::vec3 to_ball = ball.middle - unit, way = caster.to_world * to_ball;
    const float square_unit = glm::dot(to_ball, to_ball), unit_distance = std::sqrt(square_unit),
                distance = std::max(std::sqrt(glm::dot(way, way)), 1e-20f),
                stretch = unit_distance / distance,
                scaled = ball.radius * ball.radius * caster.unit_volume * stretch * stretch * stretch;
    const float rest = std::max(square_unit - ball.radius * ball.radius, 0.0f);
    const float far =
        ball_occlusion(std::sqrt(scaled / std::max(rest + scaled, 1e-20f)), glm::dot(normal, way) / distance);

    // Never more than the ball around the object would hide; nothing where that lies behind the receiver.
    const glm::vec3 to_middle = -(caster.to_world * unit);
    const float middle_distance = std::max(std::sqrt(glm::dot(to_middle, to_middle)), 1e-20f);
    const float bound = caster.bounding_ball < middle_distance
                            ? ball_occlusion(caster.bounding_ball / middle_distance,
                                             glm::dot(normal, to_middle) / middle_distance)
                            : 1.0f;
    return 1 - within(std::min(far + share * (near - far), bound), 1);
}

}  // namespace

void volume_visibility_reference(const VolumeCaster& caster, const VolumeBlock& receivers,
                                 float* visibility) {
    for (std::size_t i = 0; i < receivers.count; ++i)
        visibility[i] = visibility_of(caster, {receivers.x[i], receivers.y[i], receivers.z[i]},
                                      {receivers.nx[i], receivers.ny[i], receivers.nz[i]});
}

}  // namespace dfield::runtime
