// Meshes to clip with, and poses for them.
#pragma once

#include <dfield/dfield.hpp>
#include <vector>

#include "tests/random.hpp"
#include "tests/shapes.hpp"

namespace dfield::test {

// Around the z axis: two layers along it.
inline TriangleMesh torus_mesh(float radius, float tube, unsigned rings = 24, unsigned sides = 12) {
    TriangleMesh mesh;
    for (unsigned i = 0; i < rings; ++i)
        for (unsigned j = 0; j < sides; ++j) {
            const float a = 6.2831853f * static_cast<float>(i) / static_cast<float>(rings),
                        b = 6.2831853f * static_cast<float>(j) / static_cast<float>(sides),
                        r = radius + tube * std::cos(b);
            mesh.positions.emplace_back(r * std::cos(a), r * std::sin(a), tube * std::sin(b));
            const unsigned here = i * sides, next = (i + 1) % rings * sides, k = (j + 1) % sides;
            mesh.triangles.emplace_back(here + j, next + j, next + k);
            mesh.triangles.emplace_back(here + j, next + k, here + k);
        }
    return mesh;
}

// Two nested shells and a detached box: more than two layers along every axis.
inline TriangleMesh layered_mesh() {
    TriangleMesh mesh = torus_mesh(1, 0.3f);
    TriangleMesh turned = torus_mesh(1, 0.25f);
    for (glm::vec3& p : turned.positions) p = glm::vec3(p.x + 1, p.z, p.y);
    for (glm::uvec3& t : turned.triangles) std::swap(t.y, t.z);
    append(mesh, turned);
    append(mesh, box_mesh({-0.4f, -0.3f, 0.6f}, {0.5f, 0.4f, 1.1f}));
    return mesh;
}

inline ClipMesh clip_mesh(const Context& context, const TriangleMesh& mesh,
                          dfield_clip_method method = DFIELD_CLIP_AUTO, std::uint32_t resolution = 512) {
    dfield_clip_mesh_desc desc = clip_mesh_defaults();
    desc.positions = &mesh.positions.front().x;
    desc.vertex_count = mesh.positions.size();
    desc.indices = &mesh.triangles.front().x;
    desc.triangle_count = mesh.triangles.size();
    desc.method = method;
    desc.resolution = resolution;
    return ClipMesh(context, desc);
}

// Turned at random, `scale` times as large, at `centre`; with stretch: unevenly, and perhaps mirrored.
inline dfield_clip placed(const ClipMesh& mesh, dfield_clip_mode mode, Random& random,
                          const glm::dvec3& centre, double scale, bool stretch = false) {
    glm::dmat3 m = random.rotation();
    for (int axis = 0; axis < 3; ++axis)
        m[axis] *= scale * (stretch ? random.uniform(0.6, 1.5) * (random.below(2) ? 1 : -1) : 1);
    dfield_clip clip{};
    clip.mesh = mesh.get();
    clip.mode = mode;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row)
            clip.mesh_to_world[4 * column + row] = static_cast<float>(m[column][row]);
        clip.mesh_to_world[12 + column] = static_cast<float>(centre[column]);
    }
    clip.mesh_to_world[15] = 1;
    return clip;
}

}  // namespace dfield::test
