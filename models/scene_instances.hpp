// A glTF scene that places few meshes many times, in all the ways that transforms can be awkward.
#pragma once

#include <string>

namespace dfield::models {

// The bytes of a GLB, up = +y: a room's corner, cubes with a hole and trees, among them mirrored,
// non-uniformly scaled and (through nested nodes) sheared instances.
std::string scene_instances_glb();

}  // namespace dfield::models
