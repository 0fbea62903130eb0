// Where one bit does not decide: receivers whose tangent plane cuts the object, where a hit on the line may
// lie behind; and what says that a receiver cannot be blocked at all.
#pragma once

#include <algorithm>
#include <cmath>

#include "batch/chunk.hpp"

namespace dfield::runtime {

// A line's place in a direction's maps.
struct MapPlace {
    std::uint32_t index;  // of the stored direction
    float u, v;           // texel coordinates, within [0, map_size)
    float height;         // of the receiver along the stored direction, unit space
    glm::vec3 direction;  // the stored one, unit space
};

// The nearest and the farthest hit of a line that hits, as distances from the receiver in units of `ray`,
// negative behind it. Without depth maps the object is taken for one lump, where the ray passes the middle of
// its box.
struct HitSpan {
    float nearest, farthest;
};
inline HitSpan hit_span(const DirectionCaster& caster, const glm::vec3& position, const glm::vec3& ray,
                        const MapPlace& place) {
    const Instance& instance = caster.instance;
    const DirectionMaps& maps = caster.maps;
    const glm::vec3 direction = instance.carry_direction(ray);
    const std::uint32_t size = maps.parameters.depth_size;
    if (size == 0) {
        const glm::vec3 away = instance.box_centre - instance.carry_point(position);
        const float middle = glm::dot(away, direction) / glm::dot(direction, direction);
        return {middle, middle};
    }
    const float scale = static_cast<float>(size) / static_cast<float>(maps.parameters.map_size);
    const auto s = std::min(static_cast<std::uint32_t>(place.u * scale), size - 1);
    const auto t = std::min(static_cast<std::uint32_t>(place.v * scale), size - 1);
    const DirectionDepth& depth = maps.depths[(std::size_t{place.index} * size + t) * size + s];
    // The ray climbs along the stored direction by `speed` a unit; downwards where it is flipped.
    const float speed = glm::dot(direction, place.direction);
    const auto distance = [&](std::uint8_t q) {
        return ((static_cast<float>(q) - 127.5f) * (1 / 127.5f) - place.height) / speed;
    };
    const float low = distance(depth.nearest), high = distance(depth.farthest);
    return {std::min(low, high), std::max(low, high)};
}

// Whether a line that hits does so ahead of a receiver that the object may surround.
inline bool hit_is_ahead(const DirectionCaster& caster, const glm::vec3& position, const glm::vec3& ray,
                         const MapPlace& place) {
    return hit_span(caster, position, ray, place).farthest > caster.bias;
}

// Receivers farther from an object's box than this (in bounding radii) are not tested for rays that leave it:
// their lines hardly graze it.
inline constexpr float kNearBox = 0.1f;

// How an instance lies to a receiver.
struct ReceiverSide {
    bool behind;  // the tangent plane, or read from another level of detail: hides nothing
    bool cut;     // by the tangent plane
    bool near_box;
    LeavingBox leaving;
};
inline ReceiverSide side_of_receiver(const DirectionCaster& caster, const glm::vec3& position,
                                     const glm::vec3& normal) {
    const Instance& instance = caster.instance;
    const glm::vec3 origin = instance.carry_point(position);
    const PlaneSide plane(instance, origin, normal);
    const glm::vec3 beside = glm::abs(instance.box_centre - origin) - instance.box_half;
    const float distance = glm::dot(origin, origin);
    const bool read = distance >= caster.from && distance < caster.to;
    return {!read || plane.behind, plane.cut, std::max({beside.x, beside.y, beside.z}) < kNearBox,
            instance.leaving_box(origin)};
}

}  // namespace dfield::runtime
