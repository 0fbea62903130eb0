// The kinds that a field holds, as reports show them.
#pragma once

#include <string>
#include <vector>

#include "baker/cli/report.hpp"
#include "format/file.hpp"

namespace dfield::cli {

// One object a kind and level of detail: section, kind, parameters, bytes in memory and in the file.
Json kinds_json(const DisplacementField& field, const FileInfo& file);

// The same for people, a line each: "maps", "4098 slater (subdivision 32 ...".
struct KindLine {
    std::string kind, description;
};
std::vector<KindLine> kind_lines(const DisplacementField& field, const FileInfo& file);

// Bytes of all kinds in memory.
std::uint64_t kinds_bytes(const DisplacementField& field);

}  // namespace dfield::cli
