// A scene for light between surfaces: things of strong colours close to each other and to pale ones.
#pragma once

#include <string>

namespace dfield::models {

// The bytes of a GLB, up = +y: a quay on the water with a warehouse, crates, containers and barrels, a crane,
// and boats with masts and sails alongside. Colours by material and, on hulls, by vertex; one camera.
std::string harbour_glb();

}  // namespace dfield::models
