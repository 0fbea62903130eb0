#include "baker/output/gltf_patch.hpp"

#include <cstring>

#include "baker/error.hpp"
#include "baker/file_io.hpp"

namespace dfield {
namespace {

constexpr std::uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;

std::uint32_t read_u32(std::span<const std::byte> bytes, std::size_t offset) {
    std::uint32_t value;  // glTF and every machine that Embree runs on are little-endian
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

}  // namespace

GltfPatch::GltfPatch() : bin_buffer_(0) {
    json["asset"] = Json::object({{"version", "2.0"}, {"generator", "dfield"}});
    json["buffers"] = Json::array({Json::object({{"byteLength", 0}})});
}

GltfPatch::GltfPatch(const std::filesystem::path& path) : path_(path) {
    const std::vector<std::byte> file = read_file(path);
    if (file.size() >= 4 && read_u32(file, 0) == kGlbMagic)
        read_glb(file);
    else
        parse_json(file);
}

void GltfPatch::parse_json(std::span<const std::byte> text) {
    const auto* begin = reinterpret_cast<const char*>(text.data());
    try {
        json = Json::parse(begin, begin + text.size());
    } catch (const Json::exception& error) {
        fail(std::string("not valid JSON: ") + error.what());
    }
    if (!json.is_object()) fail("the glTF document is not a JSON object; export it again");
}

void GltfPatch::read_glb(std::span<const std::byte> file) {
    if (file.size() < 20 || read_u32(file, 4) != 2 || read_u32(file, 8) > file.size() ||
        read_u32(file, 8) < 20)
        fail("not a whole GLB of version 2; export it again");
    file = file.first(read_u32(file, 8));
    std::optional<std::vector<std::byte>> bin;
    for (std::size_t offset = 12; offset + 8 <= file.size();) {
        const std::uint32_t length = read_u32(file, offset), type = read_u32(file, offset + 4);
        if (length > file.size() - offset - 8) fail("a GLB chunk is longer than the file; export it again");
        const auto contents = file.subspan(offset + 8, length);
        if (offset == 12) {
            if (type != kJsonChunk) fail("the first GLB chunk is not JSON; export it again");
            parse_json(contents);
        } else if (type == kBinChunk && !bin) {
            bin.emplace(contents.begin(), contents.end());
        } else {
            other_chunks_.emplace_back(type, std::vector<std::byte>(contents.begin(), contents.end()));
        }
        offset += 8 + (std::size_t{length} + 3) / 4 * 4;
    }
    // The BIN chunk is the first buffer's contents, if that has no URI; otherwise nothing refers to the
    // chunk.
    const auto buffers = json.find("buffers");
    if (bin && buffers != json.end() && buffers->is_array() && !buffers->empty() &&
        !buffers->front().contains("uri")) {
        bin_ = std::move(*bin);
        bin_buffer_ = 0;
    }
}

void GltfPatch::fail(const std::string& what) const {
    throw InputError(path_.string() + ": " + what);
}

const GltfDocument& GltfPatch::original() {
    if (!original_) original_ = load_gltf_document(path_);
    return *original_;
}

Json& GltfPatch::entry(const char* array, std::size_t index) {
    const auto found = json.find(array);
    if (found == json.end() || !found->is_array() || index >= found->size() || !(*found)[index].is_object())
        fail(std::string("no entry ") + std::to_string(index) + " in \"" + array +
             "\"; export the file again");
    return (*found)[index];
}

std::size_t GltfPatch::append(const char* array, Json value) {
    Json& list = json[array];
    list.push_back(std::move(value));
    return list.size() - 1;
}

std::optional<std::size_t> GltfPatch::index_in(const Json& object, const char* key) const {
    const auto found = object.find(key);
    if (found == object.end()) return std::nullopt;
    if (!found->is_number_integer() || found->get<std::int64_t>() < 0)
        fail(std::string("\"") + key + "\" is not a non-negative whole number; export the file again");
    return found->get<std::size_t>();
}

std::size_t GltfPatch::data_buffer() {
    if (!bin_buffer_) bin_buffer_ = append("buffers", Json::object({{"byteLength", 0}}));
    return *bin_buffer_;
}

std::size_t GltfPatch::append_view(std::span<const std::byte> bytes, int target) {
    const std::size_t buffer = data_buffer();
    bin_.resize((bin_.size() + 3) / 4 * 4);
    Json view = Json::object({{"buffer", buffer}, {"byteOffset", bin_.size()}, {"byteLength", bytes.size()}});
    if (target) view["target"] = target;
    bin_.insert(bin_.end(), bytes.begin(), bytes.end());
    entry("buffers", buffer)["byteLength"] = bin_.size();
    return append("bufferViews", std::move(view));
}

std::size_t GltfPatch::append_accessor(std::span<const std::byte> bytes, int component_type,
                                       std::string_view type, std::size_t count, int target) {
    const std::size_t view = append_view(bytes, target);
    return append(
        "accessors",
        Json::object(
            {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}}));
}

}  // namespace dfield
