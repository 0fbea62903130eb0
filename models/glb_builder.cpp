#include "models/glb_builder.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <utility>

namespace dfield::models {
namespace {

template<class T>
void append_bytes(std::string& bytes, const T& value) {
    const auto* begin = reinterpret_cast<const char*>(&value);
    bytes.append(begin, sizeof value);
}

}  // namespace

GlbBuilder::GlbBuilder(const char* scene_name)
    : json{{"asset",
            {{"version", "2.0"}, {"generator", "dfield models/generate.cpp"}, {"copyright", "CC0 1.0"}}},
           {"scene", 0},
           {"scenes", Json::array({Json::object({{"name", scene_name}, {"nodes", Json::array()}})})},
           {"nodes", Json::array()},
           {"meshes", Json::array()},
           {"materials", Json::array()},
           {"accessors", Json::array()},
           {"bufferViews", Json::array()},
           {"buffers", Json::array({Json::object({{"byteLength", 0}})})}} {}

std::size_t GlbBuilder::add_vectors(std::span<const glm::dvec3> vectors, bool with_bounds) {
    const std::size_t start = binary_.size();
    glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
    for (const glm::dvec3& vector : vectors)
        for (int axis = 0; axis < 3; ++axis) {
            const auto value = static_cast<float>(vector[axis]);
            low[axis] = std::min<double>(low[axis], value);
            high[axis] = std::max<double>(high[axis], value);
            append_bytes(binary_, value);
        }
    Json accessor = {{"bufferView", add_view(start, 34962)},
                     {"componentType", 5126},
                     {"count", vectors.size()},
                     {"type", "VEC3"}};
    if (with_bounds) {
        accessor["min"] = {low.x, low.y, low.z};
        accessor["max"] = {high.x, high.y, high.z};
    }
    return append("accessors", std::move(accessor));
}

std::size_t GlbBuilder::add_indices(std::span<const Face> faces) {
    const std::size_t start = binary_.size();
    std::size_t count = 0;
    const auto add = [&](std::uint32_t index) {
        append_bytes(binary_, static_cast<std::uint16_t>(index));
        ++count;
    };
    for (const Face& face : faces) {
        for (const std::uint32_t index : {face.a, face.b, face.c}) add(index);
        if (face.d == kNoIndex) continue;
        for (const std::uint32_t index : {face.a, face.c, face.d}) add(index);
    }
    Json accessor = {{"bufferView", add_view(start, 34963)},
                     {"componentType", 5123},
                     {"count", count},
                     {"type", "SCALAR"}};
    return append("accessors", std::move(accessor));
}

std::size_t GlbBuilder::add_material(const char* name, const glm::dvec3& colour, bool double_sided) {
    return append("materials", {{"name", name},
                                {"doubleSided", double_sided},
                                {"pbrMetallicRoughness",
                                 {{"baseColorFactor", {colour.x, colour.y, colour.z, 1.0}},
                                  {"metallicFactor", 0.0},
                                  {"roughnessFactor", 1.0}}}});
}

std::size_t GlbBuilder::add_faceted(const char* name, const Shape& shape, std::size_t material,
                                    std::span<const glm::dvec3> colours) {
    std::vector<glm::dvec3> positions, normals, shades;
    std::vector<Face> faces;
    const auto add = [&](const Face& face) {
        const auto first = static_cast<std::uint32_t>(positions.size());
        const glm::dvec3 a = shape.positions[face.a], b = shape.positions[face.b],
                         c = shape.positions[face.c];
        positions.insert(positions.end(), {a, b, c});
        normals.insert(normals.end(), 3, glm::normalize(glm::cross(b - a, c - a)));
        if (!colours.empty())
            shades.insert(shades.end(), {colours[face.a], colours[face.b], colours[face.c]});
        faces.push_back({first, first + 1, first + 2});
    };
    for (const Part& part : shape.parts)
        for (const Face& face : part.faces) {
            add(face);
            if (face.d != kNoIndex) add({face.a, face.c, face.d});
        }
    Json attributes = {{"POSITION", add_vectors(positions, true)}, {"NORMAL", add_vectors(normals, false)}};
    if (!shades.empty()) attributes["COLOR_0"] = add_vectors(shades, false);
    Json primitive = {{"attributes", attributes}, {"indices", add_indices(faces)}, {"material", material}};
    return append("meshes", {{"name", name}, {"primitives", Json::array({primitive})}});
}

std::size_t GlbBuilder::append(const char* list, Json entry) {
    json[list].push_back(std::move(entry));
    return json[list].size() - 1;
}

std::size_t GlbBuilder::add_root(Json node) {
    const std::size_t index = append("nodes", std::move(node));
    json["scenes"][0]["nodes"].push_back(index);
    return index;
}

std::string GlbBuilder::finish() {
    json["buffers"][0]["byteLength"] = binary_.size();
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string file = "glTF";
    append_bytes(file, std::uint32_t{2});
    append_bytes(file, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + binary_.size()));
    append_bytes(file, static_cast<std::uint32_t>(text.size()));
    file += "JSON" + text;
    append_bytes(file, static_cast<std::uint32_t>(binary_.size()));
    file.append("BIN\0", 4);
    return file + binary_;
}

std::size_t GlbBuilder::add_view(std::size_t start, int target) {
    const std::size_t length = binary_.size() - start;
    binary_.resize((binary_.size() + 3) / 4 * 4, '\0');
    return append("bufferViews",
                  {{"buffer", 0}, {"byteOffset", start}, {"byteLength", length}, {"target", target}});
}

Json placed_node(const char* name, const glm::dvec3& translation, double yaw_degrees,
                 const glm::dvec3& scale) {
    const double half = glm::radians(yaw_degrees) / 2;
    const auto rounded = [](double value) { return std::round(value * 1e6) / 1e6 + 0.0; };
    return {{"name", name},
            {"translation", {translation.x, translation.y, translation.z}},
            {"rotation", {0.0, rounded(std::sin(half)), 0.0, rounded(std::cos(half))}},
            {"scale", {scale.x, scale.y, scale.z}}};
}

}  // namespace dfield::models
