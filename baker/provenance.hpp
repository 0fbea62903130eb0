// What a field was baked from and with, as the JSON text of the file's provenance section.
#pragma once

#include <string>

#include "baker/plan.hpp"

namespace dfield {

// Mesh hash, parameters and versions; no times, no paths: equal bakes give equal text.
std::string provenance_json(const TriangleMesh& mesh, const FieldPlan& plan, const BakeOptions& options,
                            const std::string& instruction_set);

// The text with the figures of `dfield bake --verify` in it, and without: `verified` is a JSON value. A text
// that is no JSON object is left alone.
std::string with_verification(const std::string& provenance, const std::string& verified);
std::string without_verification(const std::string& provenance);

// Names as the command line and JSON spell them.
const char* name_of(Positions positions);
const char* name_of(Mapping mapping);
const char* lookup_name(const LineParameters& parameters);  // nearest, pivot or filtered

}  // namespace dfield
