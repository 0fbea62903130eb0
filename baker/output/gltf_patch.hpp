// A glTF file as JSON and bytes, to change a document without losing what this program knows nothing about.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "baker/import/gltf_document.hpp"

namespace dfield {

using Json = nlohmann::ordered_json;  // keeps the order of keys

constexpr int kGltfUnsignedShort = 5123, kGltfUnsignedInt = 5125, kGltfFloat = 5126;
constexpr int kGltfArrayBuffer = 34962, kGltfElementArrayBuffer = 34963;

class GltfPatch {
  public:
    // An empty document whose data goes into the GLB's BIN chunk.
    GltfPatch();

    // .glb or .gltf, told apart by their contents. Throws InputError.
    explicit GltfPatch(const std::filesystem::path& path);

    Json json;

    // The file as it is, for reading its accessors; loaded at the first call. Throws InputError.
    const GltfDocument& original();

    // Entry `index` of a top-level array such as "nodes". Throws InputError where there is none.
    Json& entry(const char* array, std::size_t index);
    std::size_t append(const char* array, Json value);  // index of the new entry

    // An index stored in `object`, as glTF does, or nothing where the key is missing. Throws InputError for
    // anything but a non-negative whole number.
    std::optional<std::size_t> index_in(const Json& object, const char* key) const;

    // New data with a buffer view (target 0 = none) and accessor of its own, 4-byte aligned.
    std::size_t append_view(std::span<const std::byte> bytes, int target);
    std::size_t append_accessor(std::span<const std::byte> bytes, int component_type, std::string_view type,
                                std::size_t count, int target);

    // Throws InputError with the document's path in front of the message.
    [[noreturn]] void fail(const std::string& what) const;

    // Writes .glb, or .gltf with appended data in a .bin beside it (see gltf_output.hpp for the rules).
    // Atomic, file by file, the document last. Call it once: URIs may have changed. Throws InputError,
    // OutputError.
    void write(const std::filesystem::path& output);

  private:
    void read_glb(std::span<const std::byte> file);
    void parse_json(std::span<const std::byte> text);
    std::size_t data_buffer();  // the buffer that holds bin_, made when there is none
    void move_all_into_bin();
    void embed_images();
    void relocate_files(const std::filesystem::path& output);
    std::string bin_name(const std::filesystem::path& output) const;
    void write_glb(const std::filesystem::path& output) const;

    std::filesystem::path path_;
    std::optional<GltfDocument> original_;
    std::vector<std::byte> bin_;             // contents of buffer bin_buffer_
    std::optional<std::size_t> bin_buffer_;  // 0 when read from a GLB's BIN chunk
    std::vector<std::pair<std::uint32_t, std::vector<std::byte>>> other_chunks_;  // type and contents
};

}  // namespace dfield
