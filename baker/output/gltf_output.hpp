// Writing per-vertex visibility into the glTF document that it was computed for, into a new one, and as PLY.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "baker/scene.hpp"

namespace dfield {

struct OcclusionOutputOptions {
    // Also COLOR_0, 16-bit normalised RGBA: visibility as grey with alpha 1 or, where the primitive has
    // colours already, these times visibility. Renderers multiply base colour by COLOR_0, so direct light is
    // darkened too.
    bool color = false;
};

// In all three, visibility[i] belongs to scene.instances[i]: one value for each vertex of that instance's
// SceneMesh, 1 = open. They throw std::invalid_argument for counts that do not fit and values outside 0..1.
// Outputs are atomic.

// Reads `input` (.glb or .gltf) again and writes it to `output` (.glb or .gltf) with `_OCCLUSION`, a float
// scalar, on every triangle primitive of every instance. Throws InputError (also when the file is no longer
// what `scene` was imported from) and OutputError.
//
// The original JSON document is patched; what the program does not know comes through as it was. A mesh that
// several nodes use is cloned for each but one, and the clones share all other accessors; primitives that
// share a POSITION accessor share the attribute where their values agree. A node with EXT_mesh_gpu_instancing
// is expanded into child nodes, since its instances would otherwise share one attribute; the extension leaves
// the lists of used and required ones with its last node.
//
// Where the bytes go. From .glb to .glb: to the end of the BIN chunk; buffers and images in files stay in
// files. From .gltf (or a GLB without BIN chunk) to .glb: one self-contained file, buffers and images moved
// into the BIN chunk. To .gltf: into OUT.bin beside it, which takes a GLB's BIN chunk too; if the document
// refers to a file of that name already, it is OUT_occlusion.bin (2, 3, ...). OUT.bin is written before
// OUT.gltf.
//
// Where the output's folder is another than the input's, files that the document refers to in or below the
// input's folder are copied to the same place in the output's, but never over a file with other contents
// (OutputError); files elsewhere ("../") stay where they are and get a new relative URI.
void write_gltf_occlusion(const std::filesystem::path& input, const std::filesystem::path& output,
                          const ImportedScene& scene, std::span<const std::vector<float>> visibility,
                          const OcclusionOutputOptions& options);

// All instances in world space as one binary PLY: x y z, nx ny nz, quality (visibility, float), red green
// blue greys. Faces of mirrored instances are turned round, so that all fronts stay fronts.
void write_ply_occlusion(const std::filesystem::path& output, const ImportedScene& scene,
                         std::span<const std::vector<float>> visibility);

// A new .glb (or .gltf with .bin) made from the scene itself, for inputs that are not glTF (OBJ, PLY, ...):
// one mesh for each instance with POSITION, NORMAL, _OCCLUSION (and COLOR_0 when asked), all but the last
// shared between instances, and nodes with matrices. An instance whose axes are not orthogonal, which glTF
// does not allow, gets its own vertices in world space. The material is two-sided.
void write_new_glb_occlusion(const std::filesystem::path& output, const ImportedScene& scene,
                             std::span<const std::vector<float>> visibility,
                             const OcclusionOutputOptions& options);

}  // namespace dfield
