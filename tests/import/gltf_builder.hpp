// glTF files made in code: a JSON document and a binary buffer that accessors are appended to.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/import/test_files.hpp"

namespace dfield::test {

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
              kFloat = 5126;

class GltfBuilder {
  public:
    nlohmann::json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
    std::string buffer;

    // Appends bytes, aligned to 4; returns the buffer view's index.
    int view(const std::string& bytes, int stride = 0) {
        buffer.append((4 - buffer.size() % 4) % 4, '\0');
        nlohmann::json view = {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
        if (stride != 0) view["byteStride"] = stride;
        buffer += bytes;
        json["bufferViews"].push_back(view);
        return static_cast<int>(json["bufferViews"].size()) - 1;
    }
    // On an own view of `bytes`; `more` adds to the accessor ("normalized", "byteOffset", ...).
    int accessor(const std::string& bytes, int component_type, const char* type, std::size_t count,
                 const nlohmann::json& more = nlohmann::json::object(), int stride = 0) {
        nlohmann::json accessor = {{"componentType", component_type}, {"type", type}, {"count", count}};
        if (!bytes.empty()) accessor["bufferView"] = view(bytes, stride);
        accessor.update(more);
        json["accessors"].push_back(accessor);
        return static_cast<int>(json["accessors"].size()) - 1;
    }
    int floats(std::initializer_list<float> values, const char* type = "VEC3", std::size_t components = 3) {
        return accessor(bytes_of(values), kFloat, type, values.size() / components);
    }
    // A mesh of one primitive; returns the mesh's index.
    int mesh(int positions, int indices = -1, int mode = 4) {
        nlohmann::json primitive = {{"attributes", {{"POSITION", positions}}}, {"mode", mode}};
        if (indices >= 0) primitive["indices"] = indices;
        json["meshes"].push_back({{"primitives", {primitive}}});
        return static_cast<int>(json["meshes"].size()) - 1;
    }
    int node(const nlohmann::json& node) {
        json["nodes"].push_back(node);
        return static_cast<int>(json["nodes"].size()) - 1;
    }

    std::string glb() const {
        nlohmann::json document = json;
        if (!buffer.empty()) document["buffers"] = {{{"byteLength", buffer.size()}}};
        std::string text = document.dump();
        text.append((4 - text.size() % 4) % 4, ' ');
        std::string chunk = buffer;
        chunk.append((4 - chunk.size() % 4) % 4, '\0');
        const auto size = [](std::size_t n) { return static_cast<std::uint32_t>(n); };
        const std::size_t total = 20 + text.size() + (chunk.empty() ? 0 : 8 + chunk.size());
        std::string file =
            bytes_of<std::uint32_t>({0x46546c67, 2, size(total), size(text.size()), 0x4e4f534a}) + text;
        if (!chunk.empty()) file += bytes_of<std::uint32_t>({size(chunk.size()), 0x004e4942}) + chunk;
        return file;
    }
    std::string gltf(const std::string& uri) const {
        nlohmann::json document = json;
        document["buffers"] = {{{"byteLength", buffer.size()}, {"uri", uri}}};
        return document.dump();
    }
    std::string data_uri(const std::string& media_type) const {
        static const char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text = "data:" + media_type + ";base64,";
        for (std::size_t i = 0; i < buffer.size(); i += 3) {
            std::uint32_t bits = 0;
            for (std::size_t k = 0; k < 3; ++k)
                bits = bits << 8 | (i + k < buffer.size() ? static_cast<unsigned char>(buffer[i + k]) : 0u);
            for (std::size_t k = 0; k < 4; ++k)
                text += i + k > buffer.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
        }
        return text;
    }
};

}  // namespace dfield::test
