// Instances of fields and what queries need of them: the map from world space to the space where the
// instance's bounding sphere is the unit sphere.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <optional>
#include <vector>

#include "context.hpp"
#include "field.hpp"
#include "hierarchy.hpp"

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
    static constexpr float kContact = 1 - 1e-4f;  // rounding must not put what touches a face inside

    glm::vec3 outward{0};  // per axis: which way leads away (0: the origin lies between the box's faces)

    LeavingBox(const glm::vec3& origin, const glm::vec3& box_centre, const glm::vec3& box_half) {
        const glm::vec3 p = origin - box_centre;
        for (int axis = 0; axis < 3; ++axis)
            if (std::fabs(p[axis]) >= kContact * box_half[axis]) outward[axis] = p[axis];
    }
    bool leaves(float dx, float dy, float dz) const {
        return (outward.x * dx > 0) | (outward.y * dy > 0) | (outward.z * dz > 0);
    }
};

// Where an instance's line table looks things up: the space whose unit sphere is the table's bounding sphere
// or ellipsoid.
struct LineSpace {
    glm::mat3 to_unit{1};  // x_unit = to_unit * x_world + offset
    glm::vec3 offset{0};

    glm::vec3 carry_point(const glm::vec3& x) const { return to_unit * x + offset; }
};

struct Instance {
    dfield_field* field = nullptr;  // null: a free slot
    std::uint64_t revision = 0;     // another one after every change, never used twice by any scene
    bool hidden = false;            // occludes nothing, and is not active
    glm::mat3 to_unit{1};           // x_unit = to_unit * x_world + unit_offset
    glm::vec3 unit_offset{0};
    glm::mat3 to_world{1};  // linear part of the inverse
    // Box of the object in unit space.
    glm::vec3 box_centre{0}, box_half{0};
    Box bounds{};  // of all that queries look up: the bounding sphere or ellipsoid, in the world
    glm::mat4x3 object_to_world{1};  // as the caller gave it
    LineSpace lines;                 // of fields with a line table

    // Points carry the translation, directions do not; neither is renormalised, so t stays the world's.
    glm::vec3 carry_point(const glm::vec3& x) const { return to_unit * x + unit_offset; }
    glm::vec3 carry_direction(const glm::vec3& w) const { return to_unit * w; }

    // For a ray in unit space.
    LeavingBox leaving_box(const glm::vec3& origin) const { return {origin, box_centre, box_half}; }
};

// How an instance lies to a receiver's tangent plane.
struct PlaneSide {
    bool behind;  // the object hides nothing
    bool cut;     // a hit may lie behind the receiver; otherwise the whole object lies in front

    // Planes that cut less than this deep into an object's box (in radii) count as touching it: rounding of
    // positions and transforms must not turn contact into penetration.
    static constexpr float kContact = 1e-4f;

    // origin: the receiver in unit space.
    PlaneSide(const Instance& instance, const glm::vec3& origin, const glm::vec3& world_normal) {
        // Planes are carried by the transpose of the points' matrix.
        const glm::vec3 n = world_normal * instance.to_world;
        const float length = std::sqrt(glm::dot(n, n)), height = glm::dot(n, instance.box_centre - origin);
        const float extent = glm::dot(glm::abs(n), instance.box_half);
        behind = height + extent <= 0 || length - glm::dot(n, origin) <= 0;
        cut = height - extent < -kContact * length;
    }
};

// What queries read of a scene; they never change it. The live scene has one, every snapshot has one. Holds a
// reference to the field of each instance.
class SceneState {
  public:
    explicit SceneState(dfield_context* context) : instances(context), active(context), context_(context) {}
    // A copy without hierarchy.
    SceneState(const SceneState& other);
    SceneState& operator=(const SceneState&) = delete;
    ~SceneState();

    dfield_context* context() const noexcept { return context_; }

    std::pmr::vector<Instance> instances;      // by id
    std::pmr::vector<dfield_instance> active;  // ids in use and not hidden, ascending
    std::optional<Plane> ground;
    std::uint64_t ground_revision = 0;           // as Instance::revision
    std::optional<InstanceHierarchy> hierarchy;  // over `active`; only snapshots have one

  private:
    dfield_context* context_;
};

}  // namespace dfield::runtime

struct dfield_scene final : dfield::runtime::Shared<dfield_scene> {
    explicit dfield_scene(dfield_context* context) : Shared(context), state(context), committed(context) {}
    dfield_scene(dfield_context* context, const dfield::runtime::SceneState& other)
        : Shared(context), state(other), committed(context) {}

    dfield::runtime::SceneState state;
    // The hierarchy of the last commit, for the next one to start from.
    dfield::runtime::InstanceHierarchy committed;
    bool tree_stale = true;  // `committed` is over other ids than the active ones
};

// A scene that nobody can edit: the one reference to it that is not const is in here.
struct dfield_snapshot final : dfield::runtime::Shared<dfield_snapshot> {
    dfield_snapshot(dfield_context* context, const dfield::runtime::SceneState& state)
        : Shared(context), scene(context, state) {}

    dfield_scene scene;
};
