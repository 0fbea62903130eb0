// Visibility at every vertex of every instance of a scene: what `dfield ao` computes.
#pragma once

#include <filesystem>
#include <vector>

#include "baker/cli/options.hpp"
#include "baker/plan.hpp"
#include "baker/scene.hpp"

namespace dfield::cli {

enum class Method { kLookup, kRays };

struct SceneVisibilityOptions {
    Method method = Method::kLookup;
    bool self = true;           // objects occlude themselves too
    dfield_ao_desc ao;          // sampling and kind included
    std::vector<float> ground;  // empty, or n.x n.y n.z d
    FieldPlan plan;             // of the fields baked for lookups
    std::filesystem::path cache;
    int threads = 0;
    bool quiet = false;
};

struct SceneVisibility {
    std::vector<std::vector<float>> values;  // one a vertex of each instance, 1 = open
    std::size_t vertices = 0, baked = 0, from_cache = 0;
    double bake_seconds = 0, self_seconds = 0, visibility_seconds = 0;
    std::uint64_t field_bytes = 0;
    std::string kind = "none";  // that answered, as --kind has it; none where nothing was looked up
};

// By lookup: each distinct mesh is baked once (or found in the cache); others' occlusion is looked up, an
// object's own is ray cast. Shared directions: the two are united ray by ray; otherwise multiplied, which
// counts twice what both hide. By rays: everything is ray cast at once. Interrupted: Error(kInterrupted).
SceneVisibility scene_visibility(const ImportedScene& scene, const SceneVisibilityOptions& options);

}  // namespace dfield::cli
