#include "baker/import/gltf_instancing.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "baker/import/gltf_accessor.hpp"

namespace dfield {
namespace {

constexpr const char* kExtension = "EXT_mesh_gpu_instancing";

// Quantised quaternions are not quite of unit length, which glTF asks of a node's.
void normalize_rotation(Json& rotation) {
    double square = 0;
    for (const Json& value : rotation) square += value.get<double>() * value.get<double>();
    if (!(square > 0) || std::abs(square - 1) < 1e-6) return;
    for (Json& value : rotation) value = value.get<double>() / std::sqrt(square);
}

void erase_key(Json& object, const char* key) {
    if (const auto found = object.find(key); found != object.end()) object.erase(found);
}

}  // namespace

std::vector<std::size_t> expand_gpu_instances(GltfPatch& document, std::size_t node) {
    const Json original = document.entry("nodes", node);
    struct Attribute {
        std::vector<float> values;
        std::size_t components = 0;
    };
    std::map<std::string, Attribute> attributes;
    const std::string place = "node " + std::to_string(node) + ", ";
    std::size_t count = 0;
    for (const auto& [name, accessor] : original.at("extensions").at(kExtension).at("attributes").items()) {
        const int index = accessor.get<int>();
        const std::size_t own_count = accessor_count(document.original(), index, place + name);
        const int type = document.original().model.accessors[static_cast<std::size_t>(index)].type;
        const int stored = std::max(1, tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
        const int components = name == "ROTATION" ? 4 : name == "TRANSLATION" || name == "SCALE" ? 3 : stored;
        if (!attributes.empty() && own_count != count)
            document.fail(place + "instancing attributes of different lengths; export the file again");
        count = own_count;
        attributes[name] = {read_accessor(document.original(), index, components, place + name),
                            static_cast<std::size_t>(components)};
    }

    std::vector<std::size_t> children;
    for (std::size_t i = 0; i < count; ++i) {
        Json child = Json::object();
        if (original.contains("name") && original["name"].is_string())
            child["name"] = original["name"].get<std::string>() + "_" + std::to_string(i);
        for (const char* key : {"mesh", "skin", "weights"})
            if (original.contains(key)) child[key] = original[key];
        for (const auto& [name, attribute] : attributes) {
            Json values = Json::array();
            for (std::size_t c = 0; c < attribute.components; ++c)
                values.push_back(attribute.values[i * attribute.components + c]);
            if (name == "ROTATION") normalize_rotation(values);
            if (name == "TRANSLATION" || name == "ROTATION" || name == "SCALE")
                child[name == "TRANSLATION" ? "translation"
                      : name == "ROTATION"  ? "rotation"
                                            : "scale"] = std::move(values);
            else
                child["extras"][name] = attribute.components == 1 ? values[0] : values;
        }
        children.push_back(document.append("nodes", std::move(child)));
    }

    Json& parent = document.entry("nodes", node);
    for (const char* key : {"mesh", "skin", "weights"}) erase_key(parent, key);
    erase_key(parent["extensions"], kExtension);
    if (parent["extensions"].empty()) erase_key(parent, "extensions");
    for (const std::size_t child : children) parent["children"].push_back(child);
    return children;
}

void forget_unused_gpu_instancing(GltfPatch& document) {
    if (const auto nodes = document.json.find("nodes"); nodes != document.json.end())
        for (const Json& node : *nodes)
            if (const auto extensions = node.find("extensions");
                extensions != node.end() && extensions->contains(kExtension))
                return;
    for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
        const auto list = document.json.find(key);
        if (list == document.json.end() || !list->is_array()) continue;
        Json kept = Json::array();
        for (const Json& name : *list)
            if (name != kExtension) kept.push_back(name);
        if (kept.empty())
            document.json.erase(list);  // glTF has no empty arrays
        else
            *list = std::move(kept);
    }
}

}  // namespace dfield
