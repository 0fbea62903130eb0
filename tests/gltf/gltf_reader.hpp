// A small reader and writer of glTF for the tests, which shares no code with what is tested.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/scene.hpp"

namespace dfield::test {

using Json = nlohmann::ordered_json;

struct GltfFile {
    Json json;
    std::vector<std::byte> bin;          // BIN chunk
    std::vector<std::byte> other_chunk;  // contents of the last chunk that is neither JSON nor BIN
    std::filesystem::path folder;

    std::vector<std::byte> buffer(std::size_t index) const;  // BIN chunk or file
    // Elements one behind the other, not sparse; integers as they are stored.
    std::vector<double> accessor(std::size_t index) const;
};

GltfFile read_gltf(const std::filesystem::path& path);

// Chunks in the order JSON, BIN (unless empty), other.
std::vector<std::byte> glb_bytes(const std::string& json, const std::vector<std::byte>& bin,
                                 const std::vector<std::byte>& other_chunk = {});

// An empty folder for one test, below the folder that the validator test looks through. Files that are meant
// to be invalid go elsewhere.
std::filesystem::path scratch(const std::string& test);

// A document with one mesh of one indexed quad (4 vertices, 2 triangles) with positions and texture
// coordinates, and one root node that shows it, with extras, a material, a texture without image and an
// unknown extension.
struct SmallGltf {
    Json json;
    std::vector<std::byte> bin;

    SmallGltf();
    std::size_t add_view(const void* data, std::size_t size);
    std::size_t add_accessor(const void* data, std::size_t size, int component_type, const char* type,
                             std::size_t count);
    void write_glb(const std::filesystem::path& path, const std::vector<std::byte>& other_chunk = {}) const;
    void write_gltf(const std::filesystem::path& path,
                    const std::string& buffer_uri) const;  // with its buffer
};

// Different values for every instance and vertex of a primitive; equal for primitives that share positions.
std::vector<std::vector<float>> test_visibility(const ImportedScene& scene);

// Whether every primitive of every instance has the values that it was given, in a file whose instances are
// those of `scene` in the same order and at the same places.
void check_occlusion(const std::filesystem::path& written, const ImportedScene& scene,
                     const std::vector<std::vector<float>>& visibility);

}  // namespace dfield::test
