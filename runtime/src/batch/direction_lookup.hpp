// One direction's lookups in an instance's direction maps. FORMAT.md, "How direction maps are read".
#pragma once

#include "batch/confirm.hpp"
#include "format/direction_maps.hpp"
#include "format/sphere_points.hpp"

namespace dfield::runtime {

// A line along k crosses the stored direction's pivot plane
//     x.d = depth + slope_u (x.a - centre_u) + slope_v (x.b - centre_v),   a, b the rectangle's axes,
// at x + t k with t affine in x, so that the texel it crosses is affine in x too.
class DirectionLookup {
  public:
    // `ray` in world space, of any length.
    DirectionLookup(const DirectionMaps& maps, const Instance& instance, const glm::vec3& ray)
        : maps_(maps), instance_(instance) {
        const glm::vec3 unit = glm::normalize(instance.carry_direction(ray));
        const NearestDirection nearest = nearest_direction(maps.parameters.subdivision, unit);
        index_ = nearest.index;
        const glm::vec3 k = nearest.flipped ? -unit : unit;
        const DirectionFrame f = unpack_direction_frame(
            maps.frames[index_], stored_direction(maps.parameters.subdivision, index_));
        const glm::vec3 local(glm::dot(k, f.axis_u), glm::dot(k, f.axis_v), glm::dot(k, f.direction));
        const float approach = local.z - f.slope_u * local.x - f.slope_v * local.y;
        const glm::vec3 gradient = (f.slope_u * f.axis_u + f.slope_v * f.axis_v - f.direction) / approach;
        const float offset = (f.depth - f.slope_u * f.centre_u - f.slope_v * f.centre_v) / approach;
        const float m = static_cast<float>(maps.parameters.map_size);
        scale_u_ = 0.5f * m / f.half_u;
        scale_v_ = 0.5f * m / f.half_v;
        u_ = scale_u_ * (f.axis_u + local.x * gradient);
        v_ = scale_v_ * (f.axis_v + local.y * gradient);
        offset_u_ = scale_u_ * (local.x * offset - f.centre_u) + 0.5f * m;
        offset_v_ = scale_v_ * (local.y * offset - f.centre_v) + 0.5f * m;
        direction_ = f.direction;
    }

    // Whether the line through a point (world space) hits, and where it lies in the map.
    bool hits(const glm::vec3& position, MapPlace& place) const {
        const glm::vec3 x = instance_.carry_point(position);
        const float u = glm::dot(u_, x) + offset_u_, v = glm::dot(v_, x) + offset_v_;
        const auto m = maps_.parameters.map_size;
        if (!(u >= 0 && v >= 0 && u < static_cast<float>(m) && v < static_cast<float>(m))) return false;
        const std::uint32_t texel = static_cast<std::uint32_t>(v) * m + static_cast<std::uint32_t>(u);
        place = {index_, u, v, glm::dot(direction_, x), direction_};
        return maps_.texels[index_ * direction_map_words(m) + texel / 32] >> texel % 32 & 1;
    }

  private:
    const DirectionMaps& maps_;
    const Instance& instance_;
    std::uint32_t index_;
    glm::vec3 u_, v_, direction_;
    float scale_u_, scale_v_, offset_u_, offset_v_;
};

}  // namespace dfield::runtime
