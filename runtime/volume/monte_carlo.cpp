#include "volume/monte_carlo.hpp"

#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>

#include "dfield/dfield.h"
#include "volume/random.hpp"

namespace dfield::runtime::volume {
namespace {

// Two numbers in [0, 1) from an index.
glm::vec2 turn_of(std::uint64_t seed) {
    const std::uint64_t z = mixed(seed);
    constexpr float kScale = 0x1p-24f;
    return {static_cast<float>(z >> 40) * kScale, static_cast<float>(z & 0xffffff) * kScale};
}

// Sphere tracing: the distance field says how far a step may go. Fast sweeping overestimates distances by a
// few per cent along diagonals, hence steps are shorter than it says; steps below a quarter voxel are not
// taken.
bool is_open(const SignedField& field, const glm::vec3& origin, const glm::vec3& direction) {
    const Grid& g = field.grid;
    const glm::vec3 extent(static_cast<float>(g.nx - 1) * g.hx, static_cast<float>(g.ny - 1) * g.hy,
                           static_cast<float>(g.nz - 1) * g.hz);
    constexpr float kStep = 0.9f, kShortest = 0.25f;
    const float shortest = kShortest * g.h();
    for (float t = 0;;) {
        const glm::vec3 p = origin + t * direction;
        for (int axis = 0; axis < 3; ++axis)
            if (direction[axis] > 0 ? p[axis] > extent[axis] : direction[axis] < 0 && p[axis] < 0)
                return true;
        const float distance = field.at(p);
        if (distance < 0) return false;
        t += std::max(shortest, kStep * distance);
    }
}

}  // namespace

float visibility_by_rays(const SignedField& field, const glm::vec3& point, const glm::vec3& normal,
                         std::uint32_t rays, std::uint64_t seed) {
    glm::vec3 tangent, bitangent;
    dfield_frame(&normal.x, &tangent.x, &bitangent.x);
    // Rays start a little off the surface: the field's own noise on a flat wall must not hide the sky.
    constexpr float kOffset = 0.1f;
    const glm::vec3 origin = point + kOffset * field.grid.h() * normal;
    const glm::vec2 turn = turn_of(seed);
    std::uint32_t open = 0;
    for (std::uint32_t i = 0; i < rays; ++i) {
        // The golden-ratio lattice on the unit square, mapped to the disc below the hemisphere.
        const float u = (static_cast<float>(i) + turn.x) / static_cast<float>(rays);
        const float v = glm::fract(static_cast<double>(i) * 0.6180339887498949 + turn.y);
        const float radius = std::sqrt(u), angle = 2 * glm::pi<float>() * v;
        const glm::vec3 direction = radius * std::cos(angle) * tangent +
                                    radius * std::sin(angle) * bitangent +
                                    std::sqrt(std::max(0.0f, 1 - u)) * normal;
        if (is_open(field, origin, direction)) ++open;
    }
    return static_cast<float>(open) / static_cast<float>(rays);
}

}  // namespace dfield::runtime::volume
