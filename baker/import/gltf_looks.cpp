#include "baker/import/gltf_looks.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/error.hpp"

namespace dfield {
namespace {

using nlohmann::json;

const json& list_of(const json& document, const char* name) {
    static const json kNone = json::array();
    const auto list = document.find(name);
    return list != document.end() && list->is_array() ? *list : kNone;
}

const json& object_of(const json& parent, const char* name) {
    static const json kNone = json::object();
    if (!parent.is_object()) return kNone;
    const auto object = parent.find(name);
    return object != parent.end() && object->is_object() ? *object : kNone;
}

GltfMaterial material_of(const std::string& where, const json& source) {
    const json& pbr = object_of(source, "pbrMetallicRoughness");
    GltfMaterial material;
    material.textured = pbr.contains("baseColorTexture");
    const auto factor = pbr.find("baseColorFactor");
    if (factor == pbr.end()) return material;
    if (!factor->is_array() || factor->size() != 4)
        throw InputError(where + ": baseColorFactor needs 4 numbers");
    for (int c = 0; c < 3; ++c) {
        const json& number = (*factor)[static_cast<std::size_t>(c)];
        if (!number.is_number() || !(number.get<double>() >= 0 && number.get<double>() <= 1))
            throw InputError(where + ": baseColorFactor has a number outside 0..1");
        material.base_colour[c] = number.get<float>();
    }
    return material;
}

float positive(const std::string& where, const json& object, const char* name) {
    const auto number = object.find(name);
    const double value = number != object.end() && number->is_number() ? number->get<double>() : NAN;
    if (!(value > 0 && value < 1e30)) throw InputError(where + ": " + name + " is no number above 0");
    return static_cast<float>(value);
}

SceneCamera camera_of(const std::string& where, const json& source) {
    SceneCamera camera;
    const json type = source.is_object() ? source.value("type", json()) : json();
    if (type != "perspective" && type != "orthographic")
        throw InputError(where + ": its type is neither perspective nor orthographic");
    if (source.contains("name") && source["name"].is_string()) camera.name = source["name"];
    camera.orthographic = type == "orthographic";
    const json& lens = object_of(source, camera.orthographic ? "orthographic" : "perspective");
    if (camera.orthographic) {
        camera.half_height = positive(where, lens, "ymag");
        // 0 is allowed here, and only here.
        camera.near = lens.contains("znear") && lens["znear"] == 0 ? 0 : positive(where, lens, "znear");
    } else {
        const float angle = positive(where, lens, "yfov");
        if (!(angle < 3.14f)) throw InputError(where + ": yfov is half a turn or more");
        camera.half_height = std::tan(0.5f * angle);
        camera.near = positive(where, lens, "znear");
    }
    if (camera.orthographic || lens.contains("zfar")) camera.far = positive(where, lens, "zfar");
    if (!(camera.far > camera.near)) throw InputError(where + ": zfar is not beyond znear");
    return camera;
}

}  // namespace

GltfLooks read_gltf_looks(const std::string& file, const json& document) {
    GltfLooks looks;
    for (const json& source : list_of(document, "materials"))
        looks.materials.push_back(
            material_of(file + ": material " + std::to_string(looks.materials.size()), source));
    for (const json& source : list_of(document, "cameras")) {
        const std::string index = std::to_string(looks.cameras.size());
        looks.cameras.push_back(camera_of(file + ": camera " + index, source));
        if (looks.cameras.back().name.empty()) looks.cameras.back().name = "camera_" + index;
    }
    return looks;
}

}  // namespace dfield
