// Baked fields on disk: whether a file already holds what a bake would give, and the cache that `ao` and
// `compare` bake into.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "baker/plan.hpp"

namespace dfield::cli {

// The field in `path` when it is valid and was baked from this mesh to this plan by this version, and
// measured
// (`bake --verify`) where `verified`.
std::optional<DisplacementField> matching_field(const std::filesystem::path& path, const TriangleMesh& mesh,
                                                const FieldPlan& plan, const BakeOptions& options,
                                                bool verified = false);

// The same where options.budget chose the plan: to whatever plan the field has.
std::optional<DisplacementField> matching_field(const std::filesystem::path& path, const TriangleMesh& mesh,
                                                const BakeOptions& options, bool verified = false);

// Where fields are kept between runs: $DFIELD_CACHE, $XDG_CACHE_HOME/dfield, ~/.cache/dfield
// (%LOCALAPPDATA%\dfield on Windows), whichever is set first; empty when none is.
std::filesystem::path default_cache_folder();

struct BakedField {
    std::vector<std::byte> bytes;  // a whole .dfield
    bool from_cache = false;
    BakeReport report;  // zeros when from the cache
};

// The mesh's field after the plan, from the cache folder where it lies there, otherwise baked and put there.
// An empty folder means no cache. A cache that cannot be written is no error.
BakedField cached_field(const TriangleMesh& mesh, const FieldPlan& plan, const BakeOptions& options,
                        const std::filesystem::path& cache);

}  // namespace dfield::cli
