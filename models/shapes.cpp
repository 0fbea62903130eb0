#include "models/shapes.hpp"

#include <cmath>

namespace dfield::models {

glm::dvec3 quantized(const glm::dvec3& point) {
    // Adding zero turns -0 into 0, which would print differently.
    return {std::round(point.x * 1000) / 1000 + 0.0, std::round(point.y * 1000) / 1000 + 0.0,
            std::round(point.z * 1000) / 1000 + 0.0};
}

std::size_t triangle_count(const Shape& shape) {
    std::size_t count = 0;
    for (const Part& part : shape.parts)
        for (const Face& face : part.faces) count += face.d == kNoIndex ? 1 : 2;
    return count;
}

Shape cube_with_hole() {
    Shape shape;
    // Four squares, anticlockwise seen from +z: outer and inner at the back (z < 0), outer and inner at the
    // front.
    for (const double z : {-0.5, 0.5})
        for (const double half : {0.5, 0.25})
            for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
                shape.positions.emplace_back(x * half, y * half, z);
    std::vector<Face>& faces = shape.parts.emplace_back(Part{"cube", {}}).faces;
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        faces.push_back({a, b, c});
        faces.push_back({a, c, d});
    };
    for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t j = (i + 1) % 4;
        const std::uint32_t back_outer = 0, back_inner = 4, front_outer = 8, front_inner = 12;
        quad(back_outer + i, back_outer + j, front_outer + j, front_outer + i);    // outside
        quad(back_inner + j, back_inner + i, front_inner + i, front_inner + j);    // walls of the hole
        quad(front_outer + i, front_outer + j, front_inner + j, front_inner + i);  // front ring
        quad(back_outer + j, back_outer + i, back_inner + i, back_inner + j);      // back ring
    }
    return shape;
}

Shape corner(double side) {
    Shape shape;
    constexpr std::uint32_t n = kCornerVertices;
    for (int axis = 0; axis < 3; ++axis) {
        const auto first = static_cast<std::uint32_t>(shape.positions.size());
        Part& part = shape.parts.emplace_back(Part{std::string("plane_") + "xyz" [axis], {}});
        for (std::uint32_t v = 0; v < n; ++v)
            for (std::uint32_t u = 0; u < n; ++u) {
                // u and v run along the next two axes, so u x v is the plane's axis.
                glm::dvec3 point(0);
                point[(axis + 1) % 3] = side * u / (n - 1);
                point[(axis + 2) % 3] = side * v / (n - 1);
                shape.positions.push_back(quantized(point));
            }
        for (std::uint32_t v = 0; v + 1 < n; ++v)
            for (std::uint32_t u = 0; u + 1 < n; ++u) {
                const std::uint32_t a = first + v * n + u;
                part.faces.push_back({a, a + 1, a + n + 1, a + n});
            }
    }
    return shape;
}

}  // namespace dfield::models
