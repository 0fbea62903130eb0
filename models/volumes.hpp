// Scalar volumes that the project makes itself: exact cases for the tests, and scenes like those that volume
// renderers are judged by. Values grow towards the inside: everywhere "inside" is value >= 0.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace dfield::models {

// x fastest, then y, then z. Voxel (x, y, z) lies at the point (x, y, z) * spacing.
struct ScalarVolume {
    std::array<std::uint32_t, 3> dims{};
    std::array<double, 3> spacing{1, 1, 1};
    std::vector<float> values;

    std::size_t index(std::size_t x, std::size_t y, std::size_t z) const {
        return x + dims[0] * (y + dims[1] * z);
    }
};

using Dims = std::array<std::uint32_t, 3>;
using Spacing = std::array<double, 3>;
constexpr Spacing kUnitSpacing{1, 1, 1};

// Signed distances, in world units and exact: radius - |p - centre|, thickness / 2 - |(p - centre) . normal|
// and (centre - p) . normal, the normal (unit) leading out of the matter.
ScalarVolume sphere_volume(Dims dims, const glm::dvec3& centre, double radius,
                           Spacing spacing = kUnitSpacing);
ScalarVolume slab_volume(Dims dims, const glm::dvec3& centre, const glm::dvec3& normal, double thickness,
                         Spacing spacing = kUnitSpacing);
ScalarVolume plane_volume(Dims dims, const glm::dvec3& centre, const glm::dvec3& normal,
                          Spacing spacing = kUnitSpacing);

// sin x cos y + sin y cos z + sin z cos x with `periods` periods along the longest axis: half matter, all of
// it curved.
ScalarVolume gyroid_volume(Dims dims, double periods);

// A floor normal to z, a fifth of the height thick, with boxes, some of them turned, standing on it: flat
// walls and hard edges, the hard case for occlusion sweeping. Voxel distances cut off at +-4.
ScalarVolume floor_volume(Dims dims);

// Branching tubes that grow from the x = 0 face through the volume, in voxel distances cut off at +-4: thin
// and sparse as capillaries are, half a per cent of the voxels inside at 256 cubed for five roots.
ScalarVolume vessels_volume(Dims dims, std::uint64_t seed, int roots = 5);

// A cumulus: a heap of spheres roughened by fractal noise, with a flat base at a quarter of the height.
ScalarVolume clouds_volume(Dims dims, std::uint64_t seed);

}  // namespace dfield::models
