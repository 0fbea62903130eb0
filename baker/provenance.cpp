#include "baker/provenance.hpp"

#include <embree3/rtcore_config.h>

#include <nlohmann/json.hpp>

#include "baker/hash.hpp"

namespace dfield {
namespace {

// Grows when equal parameters begin to give another payload, so that caches and folders bake again.
constexpr int kBakeRevision = 1;

}  // namespace

const char* name_of(Positions positions) {
    return positions == Positions::kSlater ? "slater" : "latlong";
}

const char* name_of(Mapping mapping) {
    switch (mapping) {
        case Mapping::kConcentric:
            return "concentric";
        case Mapping::kPolar:
            return "polar";
        default:
            return "rejection";
    }
}

std::string provenance_json(const TriangleMesh& mesh, const BakeOptions& options,
                            const std::string& instruction_set) {
    const FieldParameters& parameters = options.parameters;
    nlohmann::ordered_json json;
    json["tool"] = "dfield " DFIELD_VERSION;
    json["revision"] = kBakeRevision;
    json["mesh"] = {
        {"hash", mesh_hash(mesh)}, {"vertices", mesh.positions.size()}, {"triangles", mesh.triangles.size()}};
    json["parameters"] = {{"positions", name_of(parameters.positions)},
                          {"subdivision", parameters.subdivision},
                          {"mapping", name_of(parameters.mapping)},
                          {"map_size", parameters.map_size},
                          {"bits", parameters.bits}};
    if (options.self_visibility) {
        json["parameters"]["self_rays"] = options.self_rays;
        json["mesh"]["normal_hash"] =
            ContentHash().add(mesh.normals.data(), mesh.normals.size() * sizeof(glm::vec3)).hex();
    }
    json["embree"] = {{"version", RTC_VERSION_STRING}, {"instruction_set", instruction_set}};
    return json.dump();
}

}  // namespace dfield
