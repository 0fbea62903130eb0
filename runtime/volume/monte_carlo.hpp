// The truth that occlusion sweeping is measured against: ambient occlusion by rays through the same distance
// field.
#pragma once

#include <cstdint>

#include "volume/field.hpp"

namespace dfield::runtime::volume {

// The share of `rays` cosine-weighted rays around the unit normal that leave the grid from this point without
// meeting D < 0; the integral of equation 2 divided by pi. The rays come from a stratified set turned by
// `seed`: the same seed gives the same rays everywhere.
float visibility_by_rays(const SignedField& field, const glm::vec3& point, const glm::vec3& normal,
                         std::uint32_t rays, std::uint64_t seed);

}  // namespace dfield::runtime::volume
