#include <algorithm>
#include <array>
#include <cctype>

#include "baker/error.hpp"
#include "baker/import/import_formats.hpp"
#include "baker/import/text_scan.hpp"

namespace dfield {

std::string ImportReport::left_out() const {
    std::string text;
    const auto add = [&](std::uint64_t count, const char* what) {
        if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
    };
    add(degenerate, "without area");
    add(not_finite, "with a NaN or infinite position");
    add(index_out_of_range, "with an index beyond the vertices");
    add(skipped_primitives, "points or lines");
    return text;
}

ImportedScene import_scene(const std::filesystem::path& path, const ImportOptions& options) {
    const std::string extension = path.extension().string();
    const auto is = [&](std::string_view name) { return equal_ignoring_case(extension, name); };
    ImportedScene scene;
    if (is(".gltf") || is(".glb"))
        scene = import_gltf(path, options);
    else if (is(".obj") || is(".ply") || is(".off") || is(".stl"))
        scene = import_openmesh(path, options);
    else
        throw InputError(path.string() + ": unknown kind of file '" + extension +
                         "'; dfield reads .obj, .ply, .off, .stl, .gltf and .glb");

    const bool usable = std::any_of(
        scene.instances.begin(), scene.instances.end(),
        [&](const SceneInstance& instance) { return !scene.meshes[instance.mesh].mesh.triangles.empty(); });
    if (!usable) {
        const std::string left_out = scene.report.left_out();
        throw InputError(path.string() + ": no usable triangle (" + std::to_string(scene.report.faces) +
                         " faces in the file" + (left_out.empty() ? "" : "; left out: " + left_out) +
                         "); check that it was exported with faces" +
                         (scene.instances.empty() ? " and that its scene has nodes with meshes" : ""));
    }
    return scene;
}

}  // namespace dfield
