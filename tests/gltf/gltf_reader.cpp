#include "tests/gltf/gltf_reader.hpp"

#include <catch2/catch.hpp>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "baker/file_io.hpp"

namespace dfield::test {
namespace {

std::uint32_t word(const std::vector<std::byte>& bytes, std::size_t offset) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, 4);
    return value;
}

double component(const std::byte* from, int type) {
    std::uint16_t u16 = 0;
    std::uint32_t u32 = 0;
    float f32 = 0;
    switch (type) {
        case 5121:
            return std::to_integer<int>(*from);
        case 5123:
            std::memcpy(&u16, from, 2);
            return u16;
        case 5125:
            std::memcpy(&u32, from, 4);
            return u32;
        default:
            std::memcpy(&f32, from, 4);
            return f32;
    }
}

}  // namespace

GltfFile read_gltf(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = read_file(path);
    GltfFile file;
    file.folder = path.parent_path();
    const auto* text = reinterpret_cast<const char*>(bytes.data());
    if (std::memcmp(text, "glTF", 4) != 0) {
        file.json = Json::parse(text, text + bytes.size());
        return file;
    }
    REQUIRE(word(bytes, 4) == 2);
    REQUIRE(word(bytes, 8) == bytes.size());
    for (std::size_t offset = 12; offset < bytes.size();) {
        const std::size_t length = word(bytes, offset), begin = offset + 8;
        REQUIRE(length % 4 == 0);
        REQUIRE(begin + length <= bytes.size());
        const std::vector<std::byte> contents(bytes.begin() + static_cast<std::ptrdiff_t>(begin),
                                              bytes.begin() + static_cast<std::ptrdiff_t>(begin + length));
        if (word(bytes, offset + 4) == 0x4E4F534A)
            file.json = Json::parse(text + begin, text + begin + length);
        else
            (word(bytes, offset + 4) == 0x004E4942 ? file.bin : file.other_chunk) = contents;
        offset = begin + length;
    }
    return file;
}

std::vector<std::byte> GltfFile::buffer(std::size_t index) const {
    const Json& entry = json.at("buffers").at(index);
    std::vector<std::byte> bytes = bin;
    if (entry.contains("uri")) {
        std::string name = entry["uri"];
        for (std::size_t i; (i = name.find("%20")) != std::string::npos;)
            name = name.substr(0, i) + ' ' + name.substr(i + 3);
        bytes = read_file(folder / name);
    }
    REQUIRE(bytes.size() >= entry.at("byteLength").get<std::size_t>());
    return bytes;
}

std::vector<double> GltfFile::accessor(std::size_t index) const {
    const Json& entry = json.at("accessors").at(index);
    const Json& view = json.at("bufferViews").at(entry.at("bufferView").get<std::size_t>());
    const std::vector<std::byte> bytes = buffer(view.at("buffer").get<std::size_t>());
    const int type = entry.at("componentType");
    const std::size_t size = type == 5121 ? 1 : type == 5123 ? 2 : 4;
    const std::size_t components =
        entry.at("type") == "SCALAR" ? 1 : entry.at("type").get<std::string>().back() - '0';
    const std::size_t stride = view.value("byteStride", size * components);
    const std::size_t start =
        view.value("byteOffset", std::size_t{0}) + entry.value("byteOffset", std::size_t{0});
    REQUIRE(start % size == 0);
    std::vector<double> values;
    for (std::size_t i = 0; i < entry.at("count").get<std::size_t>(); ++i)
        for (std::size_t c = 0; c < components; ++c) {
            REQUIRE(start + i * stride + (c + 1) * size <= bytes.size());
            values.push_back(component(&bytes[start + i * stride + c * size], type));
        }
    return values;
}

std::vector<std::byte> glb_bytes(const std::string& json, const std::vector<std::byte>& bin,
                                 const std::vector<std::byte>& other_chunk) {
    std::vector<std::byte> file;
    const auto append_word = [&](std::size_t value) {
        const auto number = static_cast<std::uint32_t>(value);
        const auto* begin = reinterpret_cast<const std::byte*>(&number);
        file.insert(file.end(), begin, begin + 4);
    };
    const auto append_chunk = [&](std::uint32_t type, const std::byte* data, std::size_t size, char padding) {
        append_word((size + 3) / 4 * 4);
        append_word(type);
        file.insert(file.end(), data, data + size);
        file.resize((file.size() + 3) / 4 * 4, static_cast<std::byte>(padding));
    };
    append_word(0x46546C67);
    append_word(2);
    append_word(0);
    append_chunk(0x4E4F534A, reinterpret_cast<const std::byte*>(json.data()), json.size(), ' ');
    if (!bin.empty()) append_chunk(0x004E4942, bin.data(), bin.size(), '\0');
    if (!other_chunk.empty()) append_chunk(0x58585858, other_chunk.data(), other_chunk.size(), '\0');
    const auto size = static_cast<std::uint32_t>(file.size());
    std::memcpy(&file[8], &size, 4);
    return file;
}

std::filesystem::path scratch(const std::string& test) {
    const std::filesystem::path folder = std::filesystem::path(DFIELD_SCRATCH) / test;
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

SmallGltf::SmallGltf() {
    json = Json::parse(R"({
        "asset": {"version": "2.0", "generator": "by hand", "extras": {"kept": [1, 2.5, "three"]}},
        "extensionsUsed": ["VENDOR_unknown"],
        "extensions": {"VENDOR_unknown": {"anything": {"at": "all"}}},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "first", "extras": {"id": 7}, "extensions": {"VENDOR_unknown": {"speed": 1e-3}}}],
        "meshes": [{"name": "quad", "extras": {"big": 9007199254740993},
                    "primitives": [{"attributes": {}, "material": 0, "extras": "primitive"}]}],
        "materials": [{"name": "plain", "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.30000000000000004, 1]}}],
        "accessors": [], "bufferViews": [], "buffers": [{"byteLength": 0, "name": "geometry"}]})");
    const float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const float coordinates[] = {0, 0, 1, 0, 1, 1, 0, 1};
    const std::uint8_t indices[] = {0, 1, 2, 0, 2, 3};
    Json& primitive = json["meshes"][0]["primitives"][0];
    primitive["indices"] = add_accessor(indices, sizeof indices, 5121, "SCALAR", 6);
    primitive["attributes"]["POSITION"] = add_accessor(positions, sizeof positions, 5126, "VEC3", 4);
    json["accessors"][1]["min"] = {0, 0, 0};
    json["accessors"][1]["max"] = {1, 1, 0};
    primitive["attributes"]["TEXCOORD_0"] = add_accessor(coordinates, sizeof coordinates, 5126, "VEC2", 4);
}

std::size_t SmallGltf::add_view(const void* data, std::size_t size) {
    bin.resize((bin.size() + 3) / 4 * 4);
    json["bufferViews"].push_back(
        Json::object({{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", size}}));
    const auto* begin = static_cast<const std::byte*>(data);
    bin.insert(bin.end(), begin, begin + size);
    json["buffers"][0]["byteLength"] = bin.size();
    return json["bufferViews"].size() - 1;
}

std::size_t SmallGltf::add_accessor(const void* data, std::size_t size, int component_type, const char* type,
                                    std::size_t count) {
    const std::size_t view = add_view(data, size);
    json["accessors"].push_back(Json::object(
        {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}}));
    return json["accessors"].size() - 1;
}

void SmallGltf::write_glb(const std::filesystem::path& path,
                          const std::vector<std::byte>& other_chunk) const {
    write_file_atomic(path, glb_bytes(json.dump(), bin, other_chunk));
}

void SmallGltf::write_gltf(const std::filesystem::path& path, const std::string& buffer_uri) const {
    Json document = json;
    document["buffers"][0]["uri"] = buffer_uri;
    write_file_atomic(path.parent_path() / buffer_uri, bin);
    write_file_atomic(path, document.dump());
}

std::vector<std::vector<float>> test_visibility(const ImportedScene& scene) {
    std::vector<std::vector<float>> visibility;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const SceneMesh& mesh = scene.meshes[scene.instances[i].mesh];
        std::vector<float>& values = visibility.emplace_back(mesh.mesh.positions.size());
        for (const PrimitiveRange& range : mesh.primitives)
            for (std::uint32_t v = 0; v < range.vertex_count; ++v)
                values[range.first_vertex + v] = static_cast<float>((v * 7919 + i * 104729) % 65521) / 65520;
    }
    return visibility;
}

void check_occlusion(const std::filesystem::path& written, const ImportedScene& scene,
                     const std::vector<std::vector<float>>& visibility) {
    INFO(written);
    const ImportedScene again = import_scene(written);
    const GltfFile file = read_gltf(written);
    REQUIRE(again.instances.size() == scene.instances.size());
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const SceneMesh &before = scene.meshes[scene.instances[i].mesh],
                        &after = again.meshes[again.instances[i].mesh];
        REQUIRE(after.mesh.positions == before.mesh.positions);
        REQUIRE(after.mesh.triangles == before.mesh.triangles);
        for (int column = 0; column < 4; ++column)
            REQUIRE(glm::distance(again.instances[i].transform[column],
                                  scene.instances[i].transform[column]) < 1e-5f);
        const auto node = static_cast<std::size_t>(again.instances[i].source_node);
        const Json& mesh = file.json["meshes"].at(file.json["nodes"].at(node).at("mesh").get<std::size_t>());
        for (const PrimitiveRange& range : before.primitives) {
            const Json& attributes = mesh.at("primitives").at(range.primitive).at("attributes");
            const auto index = attributes.at("_OCCLUSION").get<std::size_t>();
            const Json& accessor = file.json["accessors"].at(index);
            REQUIRE(accessor.at("componentType") == 5126);
            REQUIRE(accessor.at("type") == "SCALAR");
            REQUIRE(file.json["bufferViews"].at(accessor.at("bufferView").get<std::size_t>()).at("target") ==
                    34962);
            const std::vector<double> values = file.accessor(index);
            REQUIRE(values.size() == range.vertex_count);
            bool same = true;
            for (std::uint32_t v = 0; v < range.vertex_count; ++v)
                same = same && values[v] == static_cast<double>(visibility[i][range.first_vertex + v]);
            REQUIRE(same);
        }
    }
}

}  // namespace dfield::test
