// Low-frequency shadows from any direction (section 4.1): one octant swept on a grid of its own, turned so
// that the octant's diagonal is the light's direction.
#pragma once

#include "volume/field.hpp"
#include "volume/occlusion.hpp"

namespace dfield::runtime::volume {

// visibility: a float a voxel of the field, 1 = lit. `light`: unit, towards the light. The turned grid has
// the field's smallest spacing and covers it; what lies outside the field is open.
void sweep_light(dfield_context* context, const SignedField& field, const glm::vec3& light, bool improved,
                 float alpha, float* visibility);

}  // namespace dfield::runtime::volume
