// The node graph of a glTF file: who is drawn where.
#pragma once

#include <glm/mat4x4.hpp>
#include <vector>

#include "baker/import/gltf_document.hpp"
#include "baker/scene.hpp"

namespace dfield {

// Names and parents of all nodes. Throws InputError: a child that does not exist, a node with two parents, a
// cycle.
std::vector<SceneNode> gltf_nodes(const GltfDocument& document);

// One instance per node with a mesh, or per GPU instance where the node has EXT_mesh_gpu_instancing, for the
// nodes of the default scene; without one, for all nodes. In the order of the scene's depth-first walk.
// Instance i draws meshes[node.mesh]: SceneInstance::mesh is the glTF mesh index. Throws InputError:
// references to what does not exist, transforms that are not finite, instancing attributes of different
// lengths.
//
// `cameras`: where not null, the nodes' cameras are appended in the same order.
std::vector<SceneInstance> gltf_instances(const GltfDocument& document, const std::vector<SceneNode>& nodes,
                                          std::vector<SceneCamera>* cameras = nullptr);

}  // namespace dfield
