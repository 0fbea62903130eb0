// What a field was baked from and with, as the JSON text of the file's provenance section.
#pragma once

#include <string>

#include "baker/bake.hpp"

namespace dfield {

// Mesh hash, parameters and versions; no times, no paths: equal bakes give equal text.
std::string provenance_json(const TriangleMesh& mesh, const BakeOptions& options,
                            const std::string& instruction_set);

// Names as the command line and JSON spell them.
const char* name_of(Positions positions);
const char* name_of(Mapping mapping);

}  // namespace dfield
