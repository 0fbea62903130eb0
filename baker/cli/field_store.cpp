#include "baker/cli/field_store.hpp"

#include <cstdlib>

#include "baker/embree_scene.hpp"
#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/hash.hpp"
#include "baker/parallel.hpp"
#include "baker/provenance.hpp"
#include "format/file.hpp"
#include "format/writer.hpp"

namespace dfield::cli {
namespace {

// provenance(field): what the field's must be but for figures of verification, which `verified` wants.
template<class Provenance>
std::optional<DisplacementField> field_with_provenance(const std::filesystem::path& path,
                                                       const Provenance& provenance, bool verified) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return {};
    try {
        DisplacementField field = read_field(read_file(path));
        const std::string parameters = without_verification(field.provenance);
        if (parameters == provenance(field) && (!verified || field.provenance != parameters)) return field;
    } catch (const std::exception&) {
        // Unreadable or broken: bake again.
    }
    return {};
}

}  // namespace

std::optional<DisplacementField> matching_field(const std::filesystem::path& path, const TriangleMesh& mesh,
                                                const FieldPlan& plan, const BakeOptions& options,
                                                bool verified) {
    const std::string provenance = provenance_json(mesh, plan, options, bake_instruction_set());
    return field_with_provenance(
        path, [&](const DisplacementField&) { return provenance; }, verified);
}

std::optional<DisplacementField> matching_field(const std::filesystem::path& path, const TriangleMesh& mesh,
                                                const BakeOptions& options, bool verified) {
    const auto provenance = [&](const DisplacementField& field) {
        return provenance_json(mesh, plan_of(field), options, bake_instruction_set());
    };
    return field_with_provenance(path, provenance, verified);
}

std::filesystem::path default_cache_folder() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return std::filesystem::path(value ? value : "");
    };
    if (const auto folder = variable("DFIELD_CACHE"); !folder.empty()) return folder;
    if (const auto folder = variable("XDG_CACHE_HOME"); !folder.empty()) return folder / "dfield";
#if defined(_WIN32)
    if (const auto folder = variable("LOCALAPPDATA"); !folder.empty()) return folder / "dfield";
#endif
    if (const auto folder = variable("HOME"); !folder.empty()) return folder / ".cache" / "dfield";
    return {};
}

BakedField cached_field(const TriangleMesh& mesh, const FieldPlan& plan, const BakeOptions& options,
                        const std::filesystem::path& cache) {
    BakedField result;
    const std::string provenance = provenance_json(mesh, plan, options, bake_instruction_set());
    const std::filesystem::path path = cache.empty() ? cache : cache / (hash_hex(provenance) + ".dfield");
    if (!path.empty() && matching_field(path, mesh, plan, options)) {
        result.bytes = read_file(path);
        result.from_cache = true;
        return result;
    }
    result.bytes = write_field(bake_plan(mesh, plan, options, &result.report),
                               {.threads = thread_count(options.threads)});
    if (!path.empty()) {
        std::error_code error;
        std::filesystem::create_directories(cache, error);
        try {
            write_file_atomic(path, result.bytes);
        } catch (const OutputError&) {
            // The next run bakes again; this one has its field.
        }
    }
    return result;
}

}  // namespace dfield::cli
