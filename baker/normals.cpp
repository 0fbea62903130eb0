#include <OpenMesh/Core/Mesh/TriConnectivity.hh>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numeric>

#include "baker/import/openmesh_log.hpp"
#include "baker/mesh.hpp"

namespace dfield {
namespace {

struct Corner {
    glm::dvec3 normal{0};  // of the triangle, unit; 0 for a triangle without area
    double angle = 0;      // of the triangle at this corner, radians
};

// Corner 3 * t + k belongs to vertex triangles[t][k].
std::vector<Corner> corners_of(const TriangleMesh& mesh) {
    std::vector<Corner> corners(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 p(mesh.positions[mesh.triangles[t][k]]);
            const glm::dvec3 a = glm::dvec3(mesh.positions[mesh.triangles[t][(k + 1) % 3]]) - p;
            const glm::dvec3 b = glm::dvec3(mesh.positions[mesh.triangles[t][(k + 2) % 3]]) - p;
            const glm::dvec3 cross = glm::cross(a, b);
            const double area = glm::length(cross);
            if (!(area > 0)) continue;
            corners[3 * t + k] = {cross / area, std::atan2(area, glm::dot(a, b))};
        }
    return corners;
}

// Disjoint sets of corners that share one normal.
class Groups {
  public:
    explicit Groups(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0u); }
    std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = find(a), b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<std::uint32_t> parent_;
};

// The half-edge mesh knows which two triangles meet at an edge. Where a third one wants the edge, or a
// neighbour is turned over, connectivity does not allow it: that triangle gets vertices of its own and so no
// neighbours.
OpenMesh::TriConnectivity connect(const TriangleMesh& mesh, std::vector<std::uint32_t>& triangle_of_face) {
    OpenMesh::TriConnectivity connected;
    connected.reserve(mesh.positions.size(), 3 * mesh.triangles.size() / 2, mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) connected.add_vertex();
    const OpenMeshLog quiet;  // add_face prints every complex edge
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::uvec3& v = mesh.triangles[t];
        if (v.x == v.y || v.y == v.z || v.z == v.x) continue;
        const auto handle = [](std::uint32_t index) {
            return OpenMesh::VertexHandle(static_cast<int>(index));
        };
        auto face = connected.add_face(handle(v.x), handle(v.y), handle(v.z));
        if (!face.is_valid()) {
            OpenMesh::VertexHandle own[3];
            for (OpenMesh::VertexHandle& vertex : own) vertex = connected.add_vertex();
            face = connected.add_face(own[0], own[1], own[2]);
        }
        triangle_of_face.resize(static_cast<std::size_t>(face.idx()) + 1);
        triangle_of_face[static_cast<std::size_t>(face.idx())] = static_cast<std::uint32_t>(t);
    }
    return connected;
}

std::uint32_t corner_at(const TriangleMesh& mesh, std::uint32_t triangle, std::uint32_t vertex) {
    const glm::uvec3& v = mesh.triangles[triangle];
    return 3 * triangle + (v.x == vertex ? 0 : v.y == vertex ? 1 : 2);
}

// Corners at one vertex belong together when a walk over edges flatter than the crease leads from one to the
// other.
Groups smooth_groups(const TriangleMesh& mesh, const std::vector<Corner>& corners, float crease_degrees) {
    Groups groups(corners.size());
    std::vector<std::uint32_t> triangle_of_face;
    const OpenMesh::TriConnectivity connected = connect(mesh, triangle_of_face);
    const double limit = std::cos(glm::radians(static_cast<double>(crease_degrees)));
    for (const auto edge : connected.edges()) {
        const auto first = connected.halfedge_handle(edge, 0), second = connected.halfedge_handle(edge, 1);
        if (connected.is_boundary(first) || connected.is_boundary(second)) continue;
        const std::uint32_t a =
            triangle_of_face[static_cast<std::size_t>(connected.face_handle(first).idx())];
        const std::uint32_t b =
            triangle_of_face[static_cast<std::size_t>(connected.face_handle(second).idx())];
        if (glm::dot(corners[3 * std::size_t{a}].normal, corners[3 * std::size_t{b}].normal) < limit - 1e-9)
            continue;
        for (const auto end : {connected.from_vertex_handle(first), connected.to_vertex_handle(first)}) {
            // Interior edges only join triangles on original vertices: a triangle set apart has three
            // borders.
            const auto vertex = static_cast<std::uint32_t>(end.idx());
            groups.join(corner_at(mesh, a, vertex), corner_at(mesh, b, vertex));
        }
    }
    return groups;
}

// The first group of a vertex keeps it, every further one gets a copy behind the others.
void split_vertices(TriangleMesh& mesh, Groups& groups) {
    constexpr std::uint32_t kNone = ~0u;
    std::vector<std::uint32_t> owner(mesh.positions.size(), kNone);     // vertex -> group that keeps it
    std::vector<std::uint32_t> copy(3 * mesh.triangles.size(), kNone);  // group -> vertex
    for (std::uint32_t corner = 0; corner < copy.size(); ++corner) {
        const std::uint32_t group = groups.find(corner);
        std::uint32_t& vertex = mesh.triangles[corner / 3][static_cast<int>(corner % 3)];
        if (copy[group] == kNone) {
            if (owner[vertex] == kNone) {
                owner[vertex] = group;
                copy[group] = vertex;
            } else {
                copy[group] = static_cast<std::uint32_t>(mesh.positions.size());
                mesh.positions.push_back(glm::vec3(mesh.positions[vertex]));
            }
        }
        vertex = copy[group];
    }
}

}  // namespace

// Angle weights: Thuermer and Wuethrich, "Computing vertex normals from polygonal facets", 1998.
void compute_normals(TriangleMesh& mesh, float crease_degrees) {
    const std::vector<Corner> corners = corners_of(mesh);
    if (crease_degrees < 180) {
        Groups groups = smooth_groups(mesh, corners, crease_degrees);
        split_vertices(mesh, groups);
    }
    std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0));
    std::vector<Corner> widest(mesh.positions.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const std::uint32_t vertex = mesh.triangles[i / 3][static_cast<int>(i % 3)];
        sums[vertex] += corners[i].angle * corners[i].normal;
        if (corners[i].angle > widest[vertex].angle) widest[vertex] = corners[i];
    }
    mesh.normals.resize(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        glm::dvec3 normal = sums[i];
        // Two sides of one sheet cancel; the widest triangle's side is as good as the other.
        if (glm::length(normal) < 1e-6 * widest[i].angle || normal == glm::dvec3(0))
            normal = widest[i].normal;
        if (normal == glm::dvec3(0)) normal = {0, 0, 1};
        mesh.normals[i] = glm::vec3(glm::normalize(normal));
    }
}

}  // namespace dfield
