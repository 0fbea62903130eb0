// GltfPatch::write: where the bytes go when the container or the folder changes.
#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <system_error>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/import/gltf_uri.hpp"
#include "baker/output/gltf_patch.hpp"

namespace dfield {
namespace {

namespace fs = std::filesystem;

void append_u32(std::vector<std::byte>& bytes, std::size_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    const auto* begin = reinterpret_cast<const std::byte*>(&word);
    bytes.insert(bytes.end(), begin, begin + sizeof word);
}

// What glTF calls the picture's format; nothing where the bytes are none that it (or an extension) knows.
std::optional<std::string> mime_type(std::span<const std::byte> picture) {
    const std::string_view bytes(reinterpret_cast<const char*>(picture.data()),
                                 std::min<std::size_t>(picture.size(), 16));
    if (bytes.starts_with("\x89PNG")) return "image/png";
    if (bytes.starts_with("\xff\xd8\xff")) return "image/jpeg";
    if (bytes.starts_with("\xabKTX 20")) return "image/ktx2";
    if (bytes.starts_with("RIFF") && bytes.substr(8).starts_with("WEBP")) return "image/webp";
    if (bytes.substr(std::min<std::size_t>(4, bytes.size())).starts_with("ftypavif")) return "image/avif";
    return std::nullopt;
}

Json* find_array(Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_array() ? &*found : nullptr;
}

std::string extension_of(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

}  // namespace

// All buffers, one behind the other, become the BIN chunk and buffer 0.
void GltfPatch::move_all_into_bin() {
    const std::size_t appended = data_buffer();
    Json& buffers = json["buffers"];
    std::vector<std::size_t> offsets;
    std::vector<std::byte> merged;
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        std::span<const std::byte> bytes = bin_;
        if (i != appended) bytes = std::as_bytes(std::span(original().model.buffers.at(i).data));
        merged.resize((merged.size() + 3) / 4 * 4);
        offsets.push_back(merged.size());
        merged.insert(merged.end(), bytes.begin(), bytes.end());
    }
    const auto move = [&](Json& view) {
        const auto index = index_in(view, "buffer");
        if (!index) return;
        if (*index >= offsets.size())
            fail("a buffer view names buffer " + std::to_string(*index) + ", which is none");
        view["buffer"] = 0;
        if (offsets[*index]) view["byteOffset"] = index_in(view, "byteOffset").value_or(0) + offsets[*index];
    };
    if (Json* views = find_array(json, "bufferViews"))
        for (Json& view : *views) {
            move(view);
            // Compression extensions keep the place of the packed data in the same two keys.
            if (const auto extensions = view.find("extensions"); extensions != view.end())
                for (Json& extension : *extensions)
                    if (extension.is_object()) move(extension);
        }
    Json first = buffers.front();
    first.erase("uri");
    first["byteLength"] = merged.size();
    buffers = Json::array({std::move(first)});
    bin_ = std::move(merged);
    bin_buffer_ = 0;
}

// Images in files go into buffer views. One that is missing or of unknown format keeps its URI.
void GltfPatch::embed_images() {
    Json* images = find_array(json, "images");
    for (std::size_t i = 0; images && i < images->size(); ++i) {
        const auto uri = (*images)[i].find("uri");
        if (uri == (*images)[i].end() || !uri->is_string()) continue;
        const auto relative = relative_path_of_uri(uri->get<std::string>());
        std::error_code ignored;
        if (!relative || !fs::is_regular_file(path_.parent_path() / *relative, ignored)) continue;
        const std::vector<std::byte> picture = read_file(path_.parent_path() / *relative);
        const auto type = mime_type(picture);
        if (!type) continue;
        (*images)[i].erase("uri");
        (*images)[i]["mimeType"] = *type;
        (*images)[i]["bufferView"] = append_view(picture, 0);
    }
}

// Makes the relative URIs hold from another folder: what lies in or below the input's folder is copied to the
// same place below the output's; what lies elsewhere ("../textures/a.png") is reached by a new relative path.
void GltfPatch::relocate_files(const fs::path& output) {
    const fs::path input_folder = fs::weakly_canonical(fs::absolute(path_).parent_path());
    const fs::path output_folder = fs::weakly_canonical(fs::absolute(output).parent_path());
    if (input_folder == output_folder) return;
    for (const char* key : {"buffers", "images"}) {
        Json* list = find_array(json, key);
        for (std::size_t i = 0; list && i < list->size(); ++i) {
            Json& entry = (*list)[i];
            const auto uri = entry.find("uri");
            if (uri == entry.end() || !uri->is_string()) continue;
            const auto relative = relative_path_of_uri(uri->get<std::string>());
            std::error_code ignored;
            if (!relative || !fs::is_regular_file(input_folder / *relative, ignored)) continue;
            const fs::path normal = relative->lexically_normal();
            if (*normal.begin() == "..") {
                entry["uri"] = uri_of_relative_path(
                    (input_folder / normal).lexically_normal().lexically_relative(output_folder));
                continue;
            }
            const std::vector<std::byte> contents = read_file(input_folder / normal);
            const fs::path copy = output_folder / normal;
            if (fs::exists(copy, ignored)) {
                if (read_file(copy) == contents) continue;
                throw OutputError(
                    copy.string() + ": differs from " + (input_folder / normal).string() +
                    ", which the output needs at this place; write into another folder, or to a .glb");
            }
            fs::create_directories(copy.parent_path(), ignored);
            write_file_atomic(copy, contents);
        }
    }
}

// OUT.bin, unless the document refers to a file of that name already.
std::string GltfPatch::bin_name(const fs::path& output) const {
    const auto taken = [&](const std::string& name) {
        for (const char* key : {"buffers", "images"})
            if (const auto list = json.find(key); list != json.end() && list->is_array())
                for (const Json& entry : *list) {
                    const auto uri = entry.find("uri");
                    if (uri == entry.end() || !uri->is_string()) continue;
                    const auto path = relative_path_of_uri(uri->get<std::string>());
                    if (path && path->lexically_normal() == fs::path(name)) return true;
                }
        return false;
    };
    const std::string stem = output.stem().string();
    std::string name = stem + ".bin";
    for (int i = 1; taken(name); ++i) name = stem + "_occlusion" + (i > 1 ? std::to_string(i) : "") + ".bin";
    return name;
}

void GltfPatch::write_glb(const fs::path& output) const {
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::size_t bin_size = (bin_.size() + 3) / 4 * 4;
    std::size_t size = 12 + 8 + text.size() + 8 + bin_size;
    for (const auto& chunk : other_chunks_) size += 8 + (chunk.second.size() + 3) / 4 * 4;
    if (size > UINT32_MAX)
        throw OutputError(output.string() +
                          ": would be larger than 4 GiB, the limit of GLB; write .gltf instead");

    std::vector<std::byte> file;
    file.reserve(size);
    const auto append_chunk = [&](std::uint32_t type, std::span<const std::byte> contents) {
        append_u32(file, (contents.size() + 3) / 4 * 4);
        append_u32(file, type);
        file.insert(file.end(), contents.begin(), contents.end());
        file.resize((file.size() + 3) / 4 * 4);
    };
    append_u32(file, 0x46546C67);
    append_u32(file, 2);
    append_u32(file, size);
    append_chunk(0x4E4F534A, std::as_bytes(std::span(text)));
    append_chunk(0x004E4942, bin_);
    for (const auto& [type, contents] : other_chunks_) append_chunk(type, contents);
    write_file_atomic(output, file);
}

void GltfPatch::write(const fs::path& output) {
    const std::string extension = extension_of(output);
    if (extension != ".glb" && extension != ".gltf")
        throw OutputError(output.string() + ": not a name for glTF; let it end in .glb or .gltf");
    try {
        if (extension == ".glb") {
            // A GLB that has files beside it keeps them; a .gltf becomes one file.
            if (bin_buffer_ != std::size_t{0}) {
                move_all_into_bin();
                embed_images();
            }
            if (!path_.empty()) relocate_files(output);
            write_glb(output);
            return;
        }
        if (!path_.empty()) relocate_files(output);
        if (bin_buffer_) {
            const std::string name = bin_name(output);
            entry("buffers", *bin_buffer_)["uri"] = uri_of_relative_path(name);
            write_file_atomic(output.parent_path() / name, bin_);
        }
        write_file_atomic(output, json.dump(2) + "\n");
    } catch (const Json::exception& error) {
        fail(std::string("malformed glTF: ") + error.what());
    } catch (const fs::filesystem_error& error) {
        throw OutputError(output.string() + ": " + error.what());
    }
}

}  // namespace dfield
