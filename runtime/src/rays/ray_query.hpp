// Rays against one instance, in the space where its bounding sphere (of a line table: sphere or ellipsoid) is
// the unit sphere. What the scalar lookups and the kernels are handed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "lookup.hpp"
#include "rays/ray_groups.hpp"
#include "scene.hpp"

namespace dfield::runtime {

// LeavingBox for directions of another space than the box's, which `carry` leads from.
struct LeavingDirections {
    std::array<glm::vec3, 3> outward{glm::vec3(0), glm::vec3(0),
                                     glm::vec3(0)};  // zero: nothing leaves that way

    LeavingDirections() = default;
    LeavingDirections(const LeavingBox& box, const glm::mat3& carry) {
        for (int axis = 0; axis < 3; ++axis)
            outward[axis] = box.outward[axis] * glm::vec3(carry[0][axis], carry[1][axis], carry[2][axis]);
    }
    bool leaves(const glm::vec3& d) const {
        const glm::vec3 away(glm::dot(outward[0], d), glm::dot(outward[1], d), glm::dot(outward[2], d));
        return (away.x > 0) | (away.y > 0) | (away.z > 0);
    }
};

// Rays from one origin. Their directions are given in a frame of the caller's, such as a receiver's.
struct RayQuery {
    const dfield_field* field;
    glm::vec3 origin;           // in the sphere's space
    glm::mat3 carry;            // directions from the caller's frame to it
    LeavingDirections leaving;  // in the caller's frame
    float minimum;              // hits count from this t on
    bool in_front;              // no hit lies at or before `minimum`, wherever the line's origin is
};

// The chord of a ray of this direction; false where it cannot hit the object.
inline bool chord_of_query(const RayQuery& query, const glm::vec3& direction, Chord& chord) {
    return !query.leaving.leaves(direction) && chord_of_line(query.origin, query.carry * direction, chord);
}

// Rays, each with its own origin, world space, one array a component.
struct RayBlock {
    const float *origin_x, *origin_y, *origin_z;
    const float *x, *y, *z;
    std::size_t count;  // at most kRayBlock
};

}  // namespace dfield::runtime
