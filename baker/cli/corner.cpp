#include "baker/cli/corner.hpp"

#include <algorithm>

namespace dfield::cli {

TriangleMesh corner_room(const Bounds& caster, float gap) {
    const glm::vec3 size = caster.size();
    const float longest = std::max({size.x, size.y, size.z});
    const float step = 2 * longest / (kCornerVertices - 1);
    const glm::vec3 origin = caster.min - glm::vec3(gap * longest);
    TriangleMesh room;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;  // u x v = axis: triangles face the room
        const auto first = static_cast<std::uint32_t>(room.positions.size());
        for (unsigned i = 0; i < kCornerVertices; ++i)
            for (unsigned j = 0; j < kCornerVertices; ++j) {
                glm::vec3 position = origin, normal(0);
                position[u] += step * static_cast<float>(i);
                position[v] += step * static_cast<float>(j);
                normal[axis] = 1;
                room.positions.push_back(position);
                room.normals.push_back(normal);
            }
        for (unsigned i = 0; i + 1 < kCornerVertices; ++i)
            for (unsigned j = 0; j + 1 < kCornerVertices; ++j) {
                const std::uint32_t a = first + i * kCornerVertices + j, b = a + kCornerVertices;
                room.triangles.emplace_back(a, b, b + 1);
                room.triangles.emplace_back(a, b + 1, a + 1);
            }
    }
    return room;
}

}  // namespace dfield::cli
