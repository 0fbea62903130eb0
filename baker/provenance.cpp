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

const char* lookup_name(const LineParameters& parameters) {
    return parameters.pivot ? "pivot" : parameters.filtered ? "filtered" : "nearest";
}

std::string provenance_json(const TriangleMesh& mesh, const FieldPlan& plan, const BakeOptions& options,
                            const std::string& instruction_set) {
    nlohmann::ordered_json json;
    json["tool"] = "dfield " DFIELD_VERSION;
    json["revision"] = kBakeRevision;
    json["mesh"] = {
        {"hash", mesh_hash(mesh)}, {"vertices", mesh.positions.size()}, {"triangles", mesh.triangles.size()}};
    if (plan.maps)
        json["parameters"] = {{"positions", name_of(plan.maps->positions)},
                              {"subdivision", plan.maps->subdivision},
                              {"mapping", name_of(plan.maps->mapping)},
                              {"map_size", plan.maps->map_size},
                              {"bits", plan.maps->bits}};
    if (plan.lines)
        json["lines"] = {{"lattice", plan.lines->lattice},
                         {"depth_bits", plan.lines->depth_bits},
                         {"depth_lattice", plan.lines->depth_lattice},
                         {"lookup", lookup_name(*plan.lines)},
                         {"space", plan.lines->ellipsoid ? "ellipsoid" : "sphere"}};
    for (const DirectionParameters& level : plan.directions)
        json["directions"].push_back({{"subdivision", level.subdivision},
                                      {"map_size", level.map_size},
                                      {"depth_size", level.depth_size}});
    if (plan.volume) json["volume"] = {{"size", plan.volume->size}};
    if (options.budget != 0) json["budget"] = {{"bytes", options.budget}, {"kind", options.budget_kind}};
    if (options.self_visibility) {
        json["parameters"]["self_rays"] = options.self_rays;
        json["mesh"]["normal_hash"] =
            ContentHash().add(mesh.normals.data(), mesh.normals.size() * sizeof(glm::vec3)).hex();
    }
    json["embree"] = {{"version", RTC_VERSION_STRING}, {"instruction_set", instruction_set}};
    return json.dump();
}

std::string with_verification(const std::string& provenance, const std::string& verified) {
    auto json = nlohmann::ordered_json::parse(provenance, nullptr, false);
    if (!json.is_object()) return provenance;
    json["verified"] = nlohmann::ordered_json::parse(verified);
    return json.dump();
}

std::string without_verification(const std::string& provenance) {
    auto json = nlohmann::ordered_json::parse(provenance, nullptr, false);
    if (!json.is_object()) return provenance;
    json.erase("verified");
    return json.dump();
}

}  // namespace dfield
