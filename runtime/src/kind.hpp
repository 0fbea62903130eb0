// Which kind of precomputed visibility answers a query.
#pragma once

#include "ao.hpp"
#include "field.hpp"
#include "scene.hpp"

namespace dfield::runtime {

bool has_kind(const dfield_field& field, dfield_kind kind);

// The kind for these settings: the forced one, or the best that the field has. DFIELD_KIND_AUTO: it has none.
dfield_kind kind_for(const dfield_ao& ao, const dfield_field& field);

// Throws where an active instance's field cannot answer; `rays`: where it cannot tell which rays are blocked.
void require_kinds(const dfield_ao& ao, const SceneState& scene, bool rays);

}  // namespace dfield::runtime
