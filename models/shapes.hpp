// The meshes that the project makes itself. All coordinates are multiples of 1/1000, so that a last-bit
// difference between two maths libraries changes no byte of the files.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace dfield::models {

// A flat polygon of three or four corners (a quad's fourth index is not kNoIndex), anticlockwise from its
// front.
constexpr std::uint32_t kNoIndex = ~0u;
struct Face {
    std::uint32_t a, b, c, d = kNoIndex;
};

// Faces of one material; they index the positions of the whole shape.
struct Part {
    std::string name;
    std::vector<Face> faces;
};

struct Shape {
    std::vector<glm::dvec3> positions;
    std::vector<Part> parts;
};

glm::dvec3 quantized(const glm::dvec3& point);  // to multiples of 1/1000
std::size_t triangle_count(const Shape& shape);

// Side 1, centred at the origin, with a square hole of side 1/2 through it along z: 16 vertices, 32
// triangles, closed and manifold.
Shape cube_with_hole();

// The paper's receiver: the planes x = 0, y = 0 and z = 0 from 0 to `side`, 33 x 33 vertices each, facing
// inwards to the positive octant. The parts share no vertices, so each has one normal: +x, +y and +z in this
// order.
Shape corner(double side);
constexpr int kCornerVertices = 33;

// A tree of about 4 units, up = +y, standing on y = 0: tapering boughs, twigs and one-sided leaves, each a
// quad. Parts "wood" and "leaf". Not watertight, on purpose.
Shape leafy_tree();

}  // namespace dfield::models
