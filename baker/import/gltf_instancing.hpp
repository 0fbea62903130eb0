// EXT_mesh_gpu_instancing: from one node with many instances to one node for each.
#pragma once

#include <cstddef>
#include <vector>

#include "baker/output/gltf_patch.hpp"

namespace dfield {

// Gives the node a child for every instance, with the instance's translation, rotation and scale and the
// node's mesh (and skin and weights), and takes mesh and extension off the node. Custom instance attributes
// such as _ID go into the children's extras. Indices of the children, in the order of the instances. Throws
// InputError.
std::vector<std::size_t> expand_gpu_instances(GltfPatch& document, std::size_t node);

// Takes the extension out of extensionsUsed and extensionsRequired when no node has it any more.
void forget_unused_gpu_instancing(GltfPatch& document);

}  // namespace dfield
