// How far a baked field is from ray casting, on a standard set of receivers: `dfield bake --verify`.
#pragma once

#include <cstddef>
#include <span>

#include "baker/cli/report.hpp"
#include "baker/mesh.hpp"
#include "format/field.hpp"

namespace dfield::cli {

// The errors of every kind that the field holds, as AccuracyScene measures them in the standard scenes:
// {"maps": {"corner": {"rms_grey": …}, …}, …}. `bytes` is a .dfield of `field`, which is baked from `mesh`.
Json verification_json(const TriangleMesh& mesh, const DisplacementField& field,
                       std::span<const std::byte> bytes, int threads);

// "maps 2.15 grey (corner), 3.1 grey (corner-contact)", a kind.
std::vector<std::string> verification_lines(const Json& verified);

}  // namespace dfield::cli
