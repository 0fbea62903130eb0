#include "models/scene_instances.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "models/shapes.hpp"

namespace dfield::models {
namespace {

using Json = nlohmann::ordered_json;

template<class T>
void append_bytes(std::string& bytes, const T& value) {
    const auto* begin = reinterpret_cast<const char*>(&value);
    bytes.append(begin, sizeof value);
}

class GlbBuilder {
  public:
    Json json = {
        {"asset",
         {{"version", "2.0"}, {"generator", "dfield models/generate.cpp"}, {"copyright", "CC0 1.0"}}},
        {"scene", 0},
        {"scenes", Json::array({Json::object({{"name", "instances"}, {"nodes", Json::array()}})})},
        {"nodes", Json::array()},
        {"meshes", Json::array()},
        {"materials", Json::array()},
        {"accessors", Json::array()},
        {"bufferViews", Json::array()},
        {"buffers", Json::array({Json::object({{"byteLength", 0}})})}};

    std::size_t add_vectors(std::span<const glm::dvec3> vectors, bool with_bounds) {
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

    // 16-bit indices, quads as two triangles.
    std::size_t add_indices(std::span<const Face> faces) {
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

    std::size_t add_material(const char* name, const glm::dvec3& colour, bool double_sided) {
        return append("materials", {{"name", name},
                                    {"doubleSided", double_sided},
                                    {"pbrMetallicRoughness",
                                     {{"baseColorFactor", {colour.x, colour.y, colour.z, 1.0}},
                                      {"metallicFactor", 0.0},
                                      {"roughnessFactor", 1.0}}}});
    }

    std::size_t append(const char* list, Json entry) {
        json[list].push_back(std::move(entry));
        return json[list].size() - 1;
    }

    std::string finish() {
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

  private:
    std::size_t add_view(std::size_t start, int target) {
        const std::size_t length = binary_.size() - start;
        binary_.resize((binary_.size() + 3) / 4 * 4, '\0');
        return append("bufferViews",
                      {{"buffer", 0}, {"byteOffset", start}, {"byteLength", length}, {"target", target}});
    }

    std::string binary_;
};

// One normal a face: every face gets its own vertices.
std::size_t add_faceted(GlbBuilder& glb, const char* name, const Shape& shape, std::size_t material) {
    std::vector<glm::dvec3> positions, normals;
    std::vector<Face> faces;
    for (const Part& part : shape.parts)
        for (const Face& face : part.faces) {
            const auto first = static_cast<std::uint32_t>(positions.size());
            const glm::dvec3 a = shape.positions[face.a], b = shape.positions[face.b],
                             c = shape.positions[face.c];
            positions.insert(positions.end(), {a, b, c});
            normals.insert(normals.end(), 3, glm::normalize(glm::cross(b - a, c - a)));
            faces.push_back({first, first + 1, first + 2});
        }
    Json attributes = {{"POSITION", glb.add_vectors(positions, true)},
                       {"NORMAL", glb.add_vectors(normals, false)}};
    Json primitive = {
        {"attributes", attributes}, {"indices", glb.add_indices(faces)}, {"material", material}};
    return glb.append("meshes", {{"name", name}, {"primitives", Json::array({primitive})}});
}

std::size_t add_room(GlbBuilder& glb, double side, std::size_t material) {
    const Shape room = corner(side);
    std::vector<glm::dvec3> normals;
    std::vector<Face> faces;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        glm::dvec3 normal(0);
        normal[static_cast<int>(axis)] = 1;
        normals.insert(normals.end(), kCornerVertices * kCornerVertices, normal);
        faces.insert(faces.end(), room.parts[axis].faces.begin(), room.parts[axis].faces.end());
    }
    Json attributes = {{"POSITION", glb.add_vectors(room.positions, true)},
                       {"NORMAL", glb.add_vectors(normals, false)}};
    Json primitive = {
        {"attributes", attributes}, {"indices", glb.add_indices(faces)}, {"material", material}};
    return glb.append("meshes", {{"name", "room"}, {"primitives", Json::array({primitive})}});
}

// Wood and leaves are two primitives that share their positions and have no normals: readers have to make
// them.
std::size_t add_tree(GlbBuilder& glb, std::size_t wood, std::size_t leaf) {
    const Shape tree = leafy_tree();
    const std::size_t position = glb.add_vectors(tree.positions, true);
    Json primitives = Json::array();
    for (std::size_t i = 0; i < 2; ++i)
        primitives.push_back({{"attributes", {{"POSITION", position}}},
                              {"indices", glb.add_indices(tree.parts[i].faces)},
                              {"material", i == 0 ? wood : leaf}});
    return glb.append("meshes", {{"name", "leafy_tree"}, {"primitives", std::move(primitives)}});
}

Json node(const char* name, const glm::dvec3& translation, double yaw_degrees, const glm::dvec3& scale) {
    const double half = glm::radians(yaw_degrees) / 2;
    const auto rounded = [](double value) { return std::round(value * 1e6) / 1e6 + 0.0; };
    return {{"name", name},
            {"translation", {translation.x, translation.y, translation.z}},
            {"rotation", {0.0, rounded(std::sin(half)), 0.0, rounded(std::cos(half))}},
            {"scale", {scale.x, scale.y, scale.z}}};
}

}  // namespace

std::string scene_instances_glb() {
    GlbBuilder glb;
    const std::size_t wall = glb.add_material("wall", {0.8, 0.78, 0.74}, false);
    const std::size_t stone = glb.add_material("stone", {0.7, 0.7, 0.72}, false);
    const std::size_t wood = glb.add_material("wood", {0.35, 0.24, 0.15}, false);
    const std::size_t leaf = glb.add_material("leaf", {0.18, 0.42, 0.1}, true);
    const std::size_t room = add_room(glb, 8, wall);
    const std::size_t cube = add_faceted(glb, "cube_with_hole", cube_with_hole(), stone);
    const std::size_t tree = add_tree(glb, wood, leaf);

    const auto with_mesh = [](Json entry, std::size_t mesh) {
        entry["mesh"] = mesh;
        return entry;
    };
    const auto at_root = [&](Json entry) {
        const std::size_t index = glb.append("nodes", std::move(entry));
        glb.json["scenes"][0]["nodes"].push_back(index);
        return index;
    };
    at_root({{"name", "room"}, {"mesh", room}});
    at_root(with_mesh(node("tree", {2.4, 0, 2.2}, 0, {1, 1, 1}), tree));
    at_root(with_mesh(node("tree_slim", {5.9, 0, 1.9}, 130, {0.7, 1.05, 0.7}), tree));
    at_root(with_mesh(node("tree_mirrored", {1.8, 0, 5.8}, 40, {-0.85, 0.75, 0.85}), tree));
    at_root(with_mesh(node("cube", {4.6, 0.5, 4.2}, 30, {1, 1, 1}), cube));
    at_root(with_mesh(node("cube_mirrored", {3.4, 0.45, 6.6}, -20, {0.9, 0.9, -0.9}), cube));
    at_root(with_mesh(node("cube_flat", {6.4, 0.3, 3.6}, 65, {1.4, 0.6, 0.8}), cube));

    // A turned child under a non-uniformly scaled parent: the product is a shear.
    const std::size_t group = at_root(node("squeezed", {5.6, 0, 5.9}, 15, {1.6, 1, 0.7}));
    const std::size_t lower =
        glb.append("nodes", with_mesh(node("cube_sheared", {0, 0.4, 0}, 40, {0.8, 0.8, 0.8}), cube));
    const std::size_t upper = glb.append(
        "nodes", with_mesh(node("cube_sheared_mirrored", {0, 1.05, 0}, -25, {-0.5, 0.5, 0.5}), cube));
    glb.json["nodes"][group]["children"] = {lower, upper};
    return glb.finish();
}

}  // namespace dfield::models
