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

std::optional<DisplacementField> field_with_provenance(const std::filesystem::path& path,
                                                       const std::string& provenance) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return {};
    try {
        DisplacementField field = read_field(read_file(path));
        if (field.provenance == provenance) return field;
    } catch (const std::exception&) {
        // Unreadable or broken: bake again.
    }
    return {};
}

}  // namespace

std::optional<DisplacementField> matching_field(const std::filesystem::path& path, const TriangleMesh& mesh,
                                                const BakeOptions& options) {
    return field_with_provenance(path, provenance_json(mesh, options, bake_instruction_set()));
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

BakedField cached_field(const TriangleMesh& mesh, const BakeOptions& options,
                        const std::filesystem::path& cache) {
    BakedField result;
    const std::string provenance = provenance_json(mesh, options, bake_instruction_set());
    const std::filesystem::path path = cache.empty() ? cache : cache / (hash_hex(provenance) + ".dfield");
    if (!path.empty() && field_with_provenance(path, provenance)) {
        result.bytes = read_file(path);
        result.from_cache = true;
        return result;
    }
    result.bytes =
        write_field(bake_field(mesh, options, &result.report), {.threads = thread_count(options.threads)});
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
