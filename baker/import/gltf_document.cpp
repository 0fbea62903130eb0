#include "baker/import/gltf_document.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/import/gltf_uri.hpp"

namespace dfield {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uint32_t kMagic = 0x46546c67, kJsonChunk = 0x4e4f534a,
                        kBinaryChunk = 0x004e4942;  // "glTF" "JSON" "BIN"

// Extensions that change nothing about where triangles are, or that the importer reads.
bool is_supported(const std::string& extension) {
    static const char* const kGeometry[] = {"EXT_mesh_gpu_instancing", "KHR_mesh_quantization"};
    static const char* const kLooks[] = {
        "KHR_lights_punctual",   "KHR_texture_basisu",   "KHR_texture_transform", "KHR_xmp_json_ld",
        "KHR_animation_pointer", "EXT_texture_webp",     "EXT_texture_avif",      "EXT_lights_image_based",
        "MSFT_texture_dds",      "KHR_techniques_webgl", "EXT_texture_video"};
    const auto is_same = [&](const char* name) { return extension == name; };
    return extension.starts_with("KHR_materials_") ||
           std::any_of(std::begin(kGeometry), std::end(kGeometry), is_same) ||
           std::any_of(std::begin(kLooks), std::end(kLooks), is_same);
}

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 4; ++i)
        word |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    return word;
}

void append_word(std::string& bytes, std::uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((word >> shift) & 0xff);
}

struct Container {
    bool binary = false;
    std::string_view json_text;
    std::optional<std::string_view> chunk;  // GLB's BIN
};

Container open_container(const std::string& file, std::string_view bytes) {
    Container container;
    if (bytes.size() < 4 || word_at(bytes, 0) != kMagic) {
        container.json_text = bytes;
        return container;
    }
    container.binary = true;
    if (bytes.size() < 20)
        throw InputError(file + ": the GLB is cut off: it has " + std::to_string(bytes.size()) + " bytes");
    if (word_at(bytes, 4) != 2)
        throw InputError(file + ": GLB version " + std::to_string(word_at(bytes, 4)) +
                         "; dfield reads glTF 2.0 only");
    const std::uint64_t length = word_at(bytes, 8);
    if (length > bytes.size())
        throw InputError(file + ": the GLB is cut off: its header says " + std::to_string(length) +
                         " bytes, the file has " + std::to_string(bytes.size()));
    for (std::uint64_t at = 12; at + 8 <= length;) {
        const std::uint64_t size = word_at(bytes, at);
        const std::uint32_t type = word_at(bytes, at + 4);
        if (size > length - at - 8) throw InputError(file + ": a chunk of the GLB reaches beyond its end");
        const std::string_view chunk = bytes.substr(at + 8, size);
        if (at == 12 && type != kJsonChunk)
            throw InputError(file + ": the first chunk of the GLB is not JSON");
        if (at == 12)
            container.json_text = chunk;
        else if (type == kBinaryChunk && !container.chunk)
            container.chunk = chunk;
        at += 8 + size + (4 - size % 4) % 4;
    }
    return container;
}

// tinygltf walks JSON by recursion: a few thousand brackets would end on a full stack.
void check_depth(const std::string& file, std::string_view text) {
    constexpr int kMaxDepth = 100;
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > kMaxDepth) throw InputError(file + ": its JSON is nested deeper than 100 levels");
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
}

json parse(const std::string& file, std::string_view text) {
    check_depth(file, text);
    json document;
    try {
        document = json::parse(text);
    } catch (const json::parse_error& error) {
        throw InputError(file + ": is no glTF: its JSON is broken at byte " + std::to_string(error.byte));
    }
    if (!document.is_object()) throw InputError(file + ": is no glTF: its JSON is not an object");
    const auto asset = document.find("asset");
    if (asset == document.end() || !asset->is_object() || !asset->contains("version") ||
        !(*asset)["version"].is_string())
        throw InputError(file + ": is no glTF: it has no asset.version");
    const auto version = (*asset)["version"].get<std::string>();
    if (!version.starts_with("2."))
        throw InputError(file + ": glTF version " + version + "; dfield reads glTF 2.0 only");
    return document;
}

void check_extensions(const std::string& file, const json& document) {
    const auto required = document.find("extensionsRequired");
    if (required == document.end() || !required->is_array()) return;
    for (const json& name : *required) {
        const std::string extension = name.is_string() ? name.get<std::string>() : name.dump();
        if (!is_supported(extension))
            throw InputError(file + ": requires the glTF extension " + extension +
                             ", which dfield does not support; export the file without it");
    }
}

// tinygltf would also look for external buffers in the working directory, wants them at exactly byteLength
// bytes, and knows few media types. So external and data-URI buffers are brought into one shape here.
void prepare_buffers(const std::string& file, const fs::path& folder, json& document, bool has_chunk) {
    const auto buffers = document.find("buffers");
    if (buffers == document.end() || !buffers->is_array()) return;
    for (std::size_t i = 0; i < buffers->size(); ++i) {
        json& buffer = (*buffers)[i];
        const std::string where = file + ": buffer " + std::to_string(i);
        if (!buffer.is_object() || !buffer.contains("byteLength") ||
            !buffer["byteLength"].is_number_unsigned())
            throw InputError(where + " has no byteLength");
        if (!buffer.contains("uri")) {
            if (i != 0 || !has_chunk)
                throw InputError(where + " has no data: no uri, and no binary chunk for it");
            continue;
        }
        if (!buffer["uri"].is_string()) throw InputError(where + " has a uri that is no text");
        const auto uri = buffer["uri"].get<std::string>();
        if (uri.starts_with("data:")) {
            const std::size_t comma = uri.find(";base64,");
            if (comma == std::string::npos) throw InputError(where + " has a data URI that is not base64");
            buffer["uri"] = "data:application/octet-stream" + uri.substr(comma);
            continue;
        }
        const std::optional<fs::path> name = relative_path_of_uri(uri);
        if (!name) throw InputError(where + " is at '" + uri.substr(0, 100) + "', which is no relative path");
        const fs::path place = folder / *name;
        std::error_code error;
        const std::uintmax_t size = fs::file_size(place, error);
        if (error) throw InputError(where + " is missing: no file " + place.string());
        if (size != buffer["byteLength"].get<std::uint64_t>())
            throw InputError(where + ": " + place.string() + " has " + std::to_string(size) +
                             " bytes, the glTF says " +
                             std::to_string(buffer["byteLength"].get<std::uint64_t>()));
    }
}

// The document without what has nothing to do with geometry, so that tinygltf need not read it (images, above
// all).
std::string reduced_json(json& document) {
    for (const char* key : {"images", "textures", "samplers", "materials", "animations", "cameras", "skins",
                            "extras", "extensions", "extensionsRequired"})
        document.erase(key);
    return document.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string make_glb(std::string text, std::string_view chunk) {
    text.append((4 - text.size() % 4) % 4, ' ');
    const std::size_t padding = (4 - chunk.size() % 4) % 4;
    std::string glb;
    append_word(glb, kMagic);
    append_word(glb, 2);
    append_word(glb, static_cast<std::uint32_t>(28 + text.size() + chunk.size() + padding));
    append_word(glb, static_cast<std::uint32_t>(text.size()));
    append_word(glb, kJsonChunk);
    glb += text;
    append_word(glb, static_cast<std::uint32_t>(chunk.size() + padding));
    append_word(glb, kBinaryChunk);
    glb += chunk;
    glb.append(padding, '\0');
    return glb;
}

}  // namespace

GltfDocument load_gltf_document(const fs::path& path, bool looks) {
    GltfDocument result;
    result.file = path.string();
    const std::vector<std::byte> bytes = read_file(path);
    if (bytes.size() > 0xffffff00u) throw InputError(result.file + ": larger than 4 GB");
    const Container container =
        open_container(result.file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    json document = parse(result.file, container.json_text);
    check_extensions(result.file, document);
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    const bool has_chunk = container.chunk && !container.chunk->empty();
    prepare_buffers(result.file, folder, document, has_chunk);
    if (looks) result.looks = read_gltf_looks(result.file, document);
    std::vector<std::size_t> primitive_counts;
    if (document.contains("meshes") && document["meshes"].is_array())
        for (const json& mesh : document["meshes"])
            primitive_counts.push_back(
                mesh.is_object() && mesh.contains("primitives") ? mesh["primitives"].size() : 0);

    tinygltf::TinyGLTF loader;
    loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int,
                             const unsigned char*, int, void*) { return true; },
                          nullptr);
    std::string errors, warnings;
    bool loaded = false;
    try {
        std::string text = reduced_json(document);
        if (has_chunk) {
            const std::string glb = make_glb(std::move(text), *container.chunk);
            loaded = loader.LoadBinaryFromMemory(&result.model, &errors, &warnings,
                                                 reinterpret_cast<const unsigned char*>(glb.data()),
                                                 static_cast<unsigned>(glb.size()), folder.string());
        } else {
            loaded = loader.LoadASCIIFromString(&result.model, &errors, &warnings, text.data(),
                                                static_cast<unsigned>(text.size()), folder.string());
        }
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        errors += error.what();  // std::out_of_range and the like from inside tinygltf
    }
    while (!errors.empty() && errors.back() == '\n') errors.pop_back();
    if (errors.size() > 300) errors = errors.substr(0, 300) + "...";  // it may quote a whole data URI
    if (!loaded) throw InputError(result.file + ": tinygltf could not read it: " + errors);
    for (std::size_t i = 0; i < primitive_counts.size();
         ++i)  // tinygltf drops primitives that it cannot read
        if (result.model.meshes[i].primitives.size() != primitive_counts[i])
            throw InputError(result.file + ": mesh " + std::to_string(i) + " has a malformed primitive" +
                             (errors.empty() ? "" : ": " + errors));
    for (const std::string* said : {&errors, &warnings})
        if (!said->empty()) result.warnings.push_back("tinygltf: " + *said);
    return result;
}

}  // namespace dfield
