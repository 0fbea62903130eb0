// Local ambient occlusion as callers describe it, checked.
#pragma once

#include "dfield/local.h"
#include "volume/checks.hpp"
#include "volume/local.hpp"

namespace dfield::runtime::volume {

dfield_volume_samples checked_volume(const dfield_volume_samples* given);
dfield_local_desc checked_local(const dfield_local_desc* given);
std::vector<glm::dvec3> directions_of(const dfield_local_desc& desc);
LocalRays rays_of(dfield_context* context, const Grid& grid, const dfield_local_desc& desc);
OpacityFunction opacity_of(dfield_context* context, const dfield_opacity_desc* given,
                           const dfield_local_desc& local, const Grid& grid, SampleType type);
// A sample that is not finite, as an error.
void require_finite(bool finite);

}  // namespace dfield::runtime::volume
