// The importers behind import_scene(). Each throws InputError; the caller checks that anything usable came
// out.
#pragma once

#include "baker/scene.hpp"

namespace dfield {

ImportedScene import_openmesh(const std::filesystem::path& path,
                              const ImportOptions& options);  // OBJ, PLY, OFF, STL
ImportedScene import_gltf(const std::filesystem::path& path, const ImportOptions& options);  // glTF 2.0, GLB

}  // namespace dfield
