// Instances of fields and what queries need of them: the map from world space to the space where the
// instance's bounding sphere is the unit sphere.
#pragma once

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <optional>
#include <vector>

#include "context.hpp"
#include "field.hpp"

namespace dfield::runtime {

struct Plane {
    glm::vec3 normal;  // unit
    float distance;
};

// Half-lines that cannot meet a box because they start beside it and lead away, axis by axis. The bounding
// sphere and the maps cannot tell this near contact, where a ray's backward extension grazes the object:
// without it, receivers at the rim of a box that stands on their plane take half of their open rays for
// blocked.
struct LeavingBox {
    glm::vec3 outward{0};  // per axis: which way leads away (0: the origin lies between the box's faces)

    LeavingBox(const glm::vec3& origin, const glm::vec3& box_centre, const glm::vec3& box_half) {
        constexpr float kContact = 1 - 1e-4f;  // rounding must not put what touches a face inside
        const glm::vec3 p = origin - box_centre;
        for (int axis = 0; axis < 3; ++axis)
            if (std::fabs(p[axis]) >= kContact * box_half[axis]) outward[axis] = p[axis];
    }
    bool leaves(float dx, float dy, float dz) const {
        return (outward.x * dx > 0) | (outward.y * dy > 0) | (outward.z * dz > 0);
    }
};

struct Instance {
    dfield_field* field = nullptr;  // null: a free slot
    glm::mat3 to_unit{1};           // x_unit = to_unit * x_world + unit_offset
    glm::vec3 unit_offset{0};
    glm::mat3 to_world{1};  // linear part of the inverse
    // Box of the object in unit space.
    glm::vec3 box_centre{0}, box_half{0};

    // Points carry the translation, directions do not; neither is renormalised, so t stays the world's.
    glm::vec3 carry_point(const glm::vec3& x) const { return to_unit * x + unit_offset; }
    glm::vec3 carry_direction(const glm::vec3& w) const { return to_unit * w; }

    // For a ray in unit space.
    LeavingBox leaving_box(const glm::vec3& origin) const { return {origin, box_centre, box_half}; }
};

}  // namespace dfield::runtime

struct dfield_scene final : dfield::runtime::Shared<dfield_scene> {
    explicit dfield_scene(dfield_context* context) : Shared(context), instances(context), active(context) {}
    ~dfield_scene();

    std::pmr::vector<dfield::runtime::Instance> instances;  // by id
    std::pmr::vector<dfield_instance> active;               // ids in use, ascending
    std::optional<dfield::runtime::Plane> ground;
};
