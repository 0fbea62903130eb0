// Triangle soup: what the baker traces.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace dfield {

struct TriangleMesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  // unit, one per position; empty when neither file nor caller made any
    std::vector<glm::uvec3> triangles;
};

struct Bounds {
    glm::vec3 min{0}, max{0};
    glm::vec3 centre() const { return 0.5f * (min + max); }
    glm::vec3 size() const { return max - min; }
};

// Box of the positions that triangles use. The mesh has at least one triangle.
Bounds triangle_bounds(const TriangleMesh& mesh);

// XXH3-128 of positions and triangles, 32 hex digits: the identity of a mesh for caches and provenance.
std::string mesh_hash(const TriangleMesh& mesh);

// Angle-weighted vertex normals (through OpenMesh's half-edge mesh where connectivity allows it). Faces that
// meet at more than `crease_degrees` do not smooth into each other: their vertices are split, so positions
// and triangles may grow; 180 never splits. Vertices that no triangle uses get (0,0,1).
void compute_normals(TriangleMesh& mesh, float crease_degrees = 180.0f);

}  // namespace dfield
