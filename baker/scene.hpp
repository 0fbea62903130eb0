// A scene as imported: distinct meshes and the nodes that place them. Formats without nodes give one mesh and
// one instance with the identity.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <limits>
#include <string>
#include <vector>

#include "baker/mesh.hpp"

namespace dfield {

// What was found and left out. Nothing is lost without being counted here.
struct ImportReport {
    std::uint64_t faces = 0;               // faces in the file, before triangulation
    std::uint64_t triangles = 0;           // usable triangles, those that are traced
    std::uint64_t degenerate = 0;          // triangles without area, or with a repeated index: cannot be hit
    std::uint64_t not_finite = 0;          // triangles left out for a NaN or infinite position
    std::uint64_t index_out_of_range = 0;  // faces left out for an index beyond the vertices
    std::uint64_t skipped_primitives = 0;  // glTF points and lines
    std::vector<std::string> warnings;     // in words, for people

    // The counts of what was left out in words: "3 without area, 1 points or lines"; empty when nothing was.
    std::string left_out() const;
};

// glTF: which vertices of a SceneMesh came from which primitive of the file's mesh.
struct PrimitiveRange {
    std::uint32_t primitive = 0;     // index in the glTF mesh's "primitives"
    std::uint32_t first_vertex = 0;  // into SceneMesh::mesh.positions; vertices keep the accessor's order
    std::uint32_t vertex_count = 0;  // = the POSITION accessor's count
    std::uint32_t first_triangle = 0, triangle_count = 0;
};

struct SceneMesh {
    std::string name;
    TriangleMesh mesh;  // object space; normals always present and unit after import_scene
    std::vector<glm::vec3>
        albedo;  // ImportOptions::looks, glTF only: linear, one a position; otherwise empty
    std::vector<PrimitiveRange> primitives;  // glTF only
    std::int32_t source_mesh = -1;           // glTF mesh index
};

struct SceneInstance {
    std::uint32_t mesh = 0;  // index into ImportedScene::meshes
    glm::mat4 transform{1};  // object to world, column-major, last row 0 0 0 1
    std::string name;
    std::int32_t source_node = -1;   // glTF node index
    std::int32_t gpu_instance = -1;  // index within EXT_mesh_gpu_instancing, -1 where the node has none
};

// A node of a glTF file, also one without a mesh: a group that --node can name.
struct SceneNode {
    std::string name;          // "node_<index>" where the file gives none; meshes likewise "mesh_<index>"
    std::int32_t parent = -1;  // index into ImportedScene::nodes, -1 = root
};

// A camera of a glTF file where the scene places it: it looks along its -z, y is up, x right.
struct SceneCamera {
    std::string name;
    glm::mat4 to_world{1};  // a rotation and a translation; scales of nodes do not count
    bool orthographic = false;
    // Perspective: the tangent of half the vertical field of view; orthographic: half the height, world
    // units.
    float half_height = 1;
    float near = 0, far = std::numeric_limits<float>::infinity();
};

struct ImportedScene {
    std::vector<SceneMesh> meshes;  // glTF: all of the file, in its order (index = source_mesh)
    std::vector<SceneInstance> instances;
    std::vector<SceneNode> nodes;  // glTF only: index = source_node
    std::vector<SceneCamera>
        cameras;  // ImportOptions::looks, glTF only: those that the scene places, in its order
    ImportReport report;
};

struct ImportOptions {
    float crease_degrees =
        180.0f;  // for normals where the file has none; must not split vertices of glTF primitives
    // Read albedos and cameras too. Off, they are not looked at, and what is wrong with them is no error.
    bool looks = false;
};

// OBJ, PLY, OFF, STL (OpenMesh) and glTF 2.0 / GLB (tinygltf), by extension, case-insensitive.
// Throws InputError: unreadable, malformed, unknown required extension, no usable triangle in the whole
// scene.
ImportedScene import_scene(const std::filesystem::path& path, const ImportOptions& options = {});

// The whole scene, or the mesh or the node (with its children) of that name, as one mesh in world space.
// An empty name means no restriction. A name given must exist; the error lists those that do.
// --mesh gives the mesh in its own object space, once, however many nodes use it. Throws InputError.
TriangleMesh flatten_scene(const ImportedScene& scene, const std::string& mesh_name = {},
                           const std::string& node_name = {});

}  // namespace dfield
