// A glTF file, checked as a container and loaded by tinygltf: JSON, buffers, no images.
#pragma once

#include <tiny_gltf.h>

#include <filesystem>
#include <string>
#include <vector>

#include "baker/import/gltf_looks.hpp"

namespace dfield {

struct GltfDocument {
    std::string file;  // for messages
    tinygltf::Model model;
    std::vector<std::string> warnings;
    GltfLooks looks;  // empty unless asked for
};

// Throws InputError: no glTF 2.0, cut off, an extension in extensionsRequired that dfield does not know,
// nesting deeper than 100, a missing or too short buffer, anything that tinygltf refuses. Images and
// animations are not looked at, materials and cameras only for `looks`. References between objects (mesh ->
// accessor and so on) are NOT checked here.
GltfDocument load_gltf_document(const std::filesystem::path& path, bool looks = false);

}  // namespace dfield
