// Meshes with closed forms, for tests.
#pragma once

#include <array>
#include <cmath>

#include "baker/mesh.hpp"

namespace dfield::test {

// Axis-aligned box, twelve triangles, outward winding.
inline TriangleMesh box_mesh(const glm::vec3& low, const glm::vec3& high) {
    TriangleMesh mesh;
    for (int corner = 0; corner < 8; ++corner)
        mesh.positions.emplace_back(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y,
                                    corner & 4 ? high.z : low.z);
    constexpr std::array<std::array<unsigned, 4>, 6> kFaces{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (const auto& [a, b, c, d] : kFaces) {
        mesh.triangles.emplace_back(a, b, c);
        mesh.triangles.emplace_back(a, c, d);
    }
    return mesh;
}

// Latitude-longitude sphere, vertices on the sphere, outward winding and exact normals.
inline TriangleMesh sphere_mesh(const glm::vec3& centre, float radius, unsigned rings = 48) {
    TriangleMesh mesh;
    const unsigned columns = 2 * rings;
    for (unsigned i = 0; i <= rings; ++i)
        for (unsigned j = 0; j < columns; ++j) {
            const double theta = 3.14159265358979 * i / rings, phi = 2 * 3.14159265358979 * j / columns;
            const glm::vec3 n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                              std::cos(theta));
            mesh.normals.push_back(n);
            mesh.positions.push_back(centre + radius * n);
        }
    for (unsigned i = 0; i < rings; ++i)
        for (unsigned j = 0; j < columns; ++j) {
            const unsigned a = i * columns + j, b = i * columns + (j + 1) % columns;
            if (i + 1 < rings) mesh.triangles.emplace_back(a, a + columns, b + columns);
            if (i > 0) mesh.triangles.emplace_back(a, b + columns, b);
        }
    return mesh;
}

inline void append(TriangleMesh& mesh, const TriangleMesh& other) {
    const auto first = static_cast<unsigned>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
    for (const glm::uvec3& triangle : other.triangles) mesh.triangles.push_back(triangle + first);
}

}  // namespace dfield::test
