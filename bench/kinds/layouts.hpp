// Layouts of many instances over a ground that receives: the same on every run and for any meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "baker/cli/runtime_scene.hpp"
#include "baker/mesh.hpp"

namespace dfield::kinds {

struct Placement {
    std::size_t object;  // index into the bounds that the layout was made for
    glm::mat4 transform;
};

// Objects are scaled so that the longest side of their box is 1; up is +y, the ground is y = 0 and faces up.
// The lowest corner of a box is a tenth above it, as in the paper's corner.

// A square of objects, each turned in its own way about all axes and just above the ground, and in another
// way in every frame. The neighbours' centres are 1.5 apart.
std::vector<Placement> crowd(const Bounds& object, std::size_t count, std::uint32_t frame);

// Objects of several kinds in turn, of sizes from 0.7 to 1.3, standing or hovering; each goes round in a
// circle of its own and turns about the vertical as the frames pass. The circles' centres are 1.5 apart.
std::vector<Placement> swarm(std::span<const Bounds> objects, std::size_t count, std::uint32_t frame);

// About `count` vertices of a grid over the ground beneath `instances` such objects and 1 around them, in
// rows; as many as make whole rows.
cli::Receivers ground(std::size_t instances, std::size_t count);

}  // namespace dfield::kinds
