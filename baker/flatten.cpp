#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <set>

#include "baker/error.hpp"
#include "baker/scene.hpp"

namespace dfield {
namespace {

std::string listed(const std::set<std::string>& names) {
    constexpr std::size_t kMost = 20;
    std::string text;
    std::size_t count = 0;
    for (const std::string& name : names) {
        if (++count > kMost) break;
        text += (text.empty() ? "'" : ", '") + name + "'";
    }
    if (names.size() > kMost) text += " and " + std::to_string(names.size() - kMost) + " more";
    return text.empty() ? "none" : text;
}

// Normals go by the cofactors, the inverse transpose without the division: they exist for flattened
// (singular) matrices too. The determinant's sign keeps them on the outer side under mirroring.
glm::dmat3 normal_matrix(const glm::dmat3& m) {
    const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    return glm::dot(m[0], cofactors[0]) < 0 ? -cofactors : cofactors;
}

void append(TriangleMesh& world, const TriangleMesh& mesh, const glm::mat4& transform,
            const std::string& name) {
    const std::size_t first = world.positions.size();
    if (first + mesh.positions.size() > std::numeric_limits<std::uint32_t>::max())
        throw InputError(
            "the flattened scene has more than 2^32 - 1 vertices; choose a part of it with --node");
    const glm::dmat4 matrix(transform);
    const glm::dmat3 normals = normal_matrix(glm::dmat3(matrix));
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::vec3 position(matrix * glm::dvec4(glm::dvec3(mesh.positions[i]), 1));
        if (!std::isfinite(position.x + position.y + position.z))
            throw InputError("node '" + name + "': its transform throws vertices to infinity");
        world.positions.push_back(position);
        glm::dvec3 normal = normals * glm::dvec3(mesh.normals[i]);
        const double length = glm::length(normal);
        world.normals.push_back(length > 0 ? glm::vec3(normal / length) : mesh.normals[i]);
    }
    const glm::uvec3 offset(static_cast<std::uint32_t>(first));
    for (const glm::uvec3& triangle : mesh.triangles) world.triangles.push_back(triangle + offset);
}

TriangleMesh one_mesh(const ImportedScene& scene, const std::string& mesh_name) {
    const TriangleMesh* found = nullptr;
    std::set<std::string> names;
    for (const SceneMesh& mesh : scene.meshes) {
        names.insert(mesh.name);
        if (mesh.name != mesh_name) continue;
        if (found != nullptr)
            throw InputError("several meshes are called '" + mesh_name +
                             "': rename them, or choose a node by --node");
        found = &mesh.mesh;
    }
    if (found == nullptr)
        throw InputError("no mesh is called '" + mesh_name + "'; the meshes are " + listed(names));
    return *found;
}

// Nodes of that name and everything below them, by index into ImportedScene::nodes.
std::vector<bool> subtree(const ImportedScene& scene, const std::string& node_name) {
    std::vector<bool> inside(scene.nodes.size(), false);
    for (std::size_t i = 0; i < scene.nodes.size(); ++i)
        for (std::int32_t up = static_cast<std::int32_t>(i); up >= 0 && !inside[i];
             up = scene.nodes[static_cast<std::size_t>(up)].parent)
            inside[i] = scene.nodes[static_cast<std::size_t>(up)].name == node_name;
    return inside;
}

}  // namespace

TriangleMesh flatten_scene(const ImportedScene& scene, const std::string& mesh_name,
                           const std::string& node_name) {
    if (!mesh_name.empty() && !node_name.empty()) throw InputError("choose a mesh or a node, not both");
    TriangleMesh world;
    if (!mesh_name.empty()) {
        world = one_mesh(scene, mesh_name);
    } else {
        const std::vector<bool> inside = subtree(scene, node_name);
        std::set<std::string> names;
        for (const SceneNode& node : scene.nodes) names.insert(node.name);
        for (const SceneInstance& instance : scene.instances) {
            names.insert(instance.name);
            const bool wanted =
                node_name.empty() || instance.name == node_name ||
                (instance.source_node >= 0 && inside[static_cast<std::size_t>(instance.source_node)]);
            if (wanted) append(world, scene.meshes[instance.mesh].mesh, instance.transform, instance.name);
        }
        if (!node_name.empty() && names.count(node_name) == 0)
            throw InputError("no node is called '" + node_name + "'; the nodes are " + listed(names));
    }
    if (world.triangles.empty()) {
        const std::string part = !mesh_name.empty()   ? "mesh '" + mesh_name + "'"
                                 : !node_name.empty() ? "node '" + node_name + "' in the scene"
                                                      : "scene";
        throw InputError("the " + part + " has no usable triangle");
    }
    return world;
}

}  // namespace dfield
