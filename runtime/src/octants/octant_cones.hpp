// The octants of an object's space as they lie in the world, and how much a receiver's normal faces each.
//
// An octant is the cone between three axes, here the images of the object's own. Rotation, even scale and
// mirrors keep them at right angles, and so does a scale along them: then the terms are equation 5's of
// "Fast Occlusion Sweeping" (volume/octant_geometry.hpp) for the normal in their frame. A shear does not; the
// closed form below is Lambert's sum over the edges of a spherical triangle, cut off at the receiver's
// horizon, for any three axes.
#pragma once

#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace dfield::runtime {

inline constexpr std::size_t kOctantCount = 8;

// Of axes k, and of the two others of each k.
struct OctantCones {
    std::array<glm::vec3, 3> axis;             // unit, world
    std::array<glm::vec3, 3> normal;           // unit: of the plane of the two others, towards axis k
    std::array<float, 3> cosine, sine, angle;  // between the two others
    float volume;                              // that the axes span, > 0

    // object_to_world: any invertible linear map; its columns are the axes, but for their lengths.
    explicit OctantCones(const glm::mat3& object_to_world);
};

// By octant (bit k of its index: on the positive side of axis k), the integral of max(0, N.w) over its
// directions; sums to pi. N is unit.
std::array<float, kOctantCount> octant_terms(const OctantCones& cones, const glm::vec3& normal);

// The cosine-weighted share of a receiver's hemisphere that a ball hides: `sine` of half the angle under
// which it is seen, 0..1, and `cosine` between the normal and the way to its middle. Exact where the horizon
// cuts the ball (the form factor of a sphere).
float ball_occlusion(float sine, float cosine);

}  // namespace dfield::runtime
