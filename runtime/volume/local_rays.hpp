// The rays of local ambient occlusion: the same directions and steps for every voxel, so that all that a
// sample needs is a table's entry: a whole offset in voxels, a fraction, a weight. A. Titov, M.
// Kersten-Oertel, S. Drouin: Contextual Ambient Occlusion, 2024, equations 2 and 3.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <span>
#include <vector>

#include "volume/grid.hpp"

namespace dfield::runtime::volume {

// The paper's sets (section 4): 6 and 14 directions of a voxel's neighbours at Manhattan distance 1, and 1
// and 3; all 26; the 54 centres of a Rubik's cube's stickers. Any other number: the spherical Fibonacci set
// (B. Keinert et al. 2015). Unit vectors.
std::vector<glm::dvec3> neighbour_directions(std::size_t count);  // 6, 14, 26 or 54
std::vector<glm::dvec3> fibonacci_directions(std::size_t count);

// Sample i (1, 2, ...) of a ray: at voxel + offset + fraction.
struct RayStep {
    std::array<std::int32_t, 3> offset;
    std::array<float, 3> fraction;  // [0, 1), 0 exactly where the sample lies on a plane of voxels
    // What the light that this sample takes away costs the voxel: of equation 2's M terms those from i + 1 on
    // have its factor, so (M - i) / M, times w_k / K.
    float weight;
    // Approximate rays: a step between s samples stands for all of them, and lets (1 - a)^s pass. What it
    // takes away costs weight - slope (1 - a)^s: the more opaque, the sooner.
    float slope = 0;
};

// A ray's steps, from the voxel on: how many stand for one sample, how many for two, how many for four.
struct RayGroups {
    std::size_t ones = 0, twos = 0, fours = 0;

    std::size_t steps() const { return ones + twos + fours; }
};

// Turns of rays at random, other ones at every voxel.
struct Jitter {
    float most = 0;  // 0..1, of half the angle between neighbouring rays
    std::uint64_t seed = 0;
};

struct LocalRays {
    std::size_t count = 0;    // K
    std::size_t samples = 0;  // M
    float open = 1;           // A where nothing occludes: the mean of w_k
    Jitter jitter;
    glm::dvec3 step{1};                       // voxels along the axes, per length of a direction
    std::pmr::vector<glm::dvec3> directions;  // unit vectors
    std::pmr::vector<float> weights;          // w_k / K
    // per_ray of each. A ray's last sample is not among them: equation 2 multiplies nothing by its opacity.
    std::pmr::vector<RayStep> steps;
    std::size_t per_ray = 0;  // kept(), or fewer if approximate
    RayGroups groups{};       // these
    bool approximate = false;
    // Voxels that are read lie within [x + low, x + high].
    std::array<std::int32_t, 3> low{}, high{};
    float reach = 0;  // the farthest sample that counts, world units

    std::size_t kept() const { return samples - 1; }
    std::span<const RayStep> ray(std::size_t k) const {
        return std::span(steps).subspan(k * per_ray, per_ray);
    }
};

struct RayOptions {
    std::span<const glm::dvec3> directions;
    std::span<const float> weights;  // one a direction, or none: all 1
    std::size_t samples = 20;
    double step = 1;  // between samples, in voxels or world units
    bool world = false;
    Jitter jitter;
    bool approximate = false;  // without jitter
};
LocalRays make_local_rays(std::pmr::memory_resource* memory, const Grid& grid, const RayOptions& options);

}  // namespace dfield::runtime::volume
