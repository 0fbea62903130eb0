#include "baker/cli/verification.hpp"

#include "baker/cli/comparison.hpp"
#include "baker/cli/corner.hpp"
#include "format/hemisphere_map.hpp"

namespace dfield::cli {
namespace {

constexpr std::uint32_t kHemisphereRays = 256, kSharedRays = 512;

struct StandardScene {
    const char* name;
    float gap;  // between the caster's box and the planes, in its longest sides
};
constexpr StandardScene kScenes[] = {{"corner", 0.1f}, {"corner-contact", 0}};

Json errors_json(const Comparison& comparison) {
    return {{"rms_grey", significant(comparison.rms_grey, 4)},
            {"bias_grey", significant(comparison.bias_grey, 4)},
            {"max_grey", significant(comparison.max_grey, 4)},
            {"rms_grey_converged", significant(comparison.rms_grey_converged, 4)}};
}

}  // namespace

Json verification_json(const TriangleMesh& mesh, const DisplacementField& field,
                       std::span<const std::byte> bytes, int threads) {
    Json verified = Json::object();
    const auto verify = [&](dfield_kind kind) {
        ComparisonInput input;
        input.kind = kind;
        input.shared = kind == DFIELD_KIND_DIRECTIONS;
        input.directions = input.shared ? fibonacci_sphere(kSharedRays) : cosine_directions(kHemisphereRays);
        input.converged_rays = kVerificationRays;
        input.threads = threads;
        input.repetitions = 1;
        input.fields.emplace_back(bytes.begin(), bytes.end());
        input.casters.push_back({&mesh, 0});
        Json& of_kind = verified[name_of(kind)];
        for (const StandardScene& scene : kScenes) {
            const TriangleMesh room = corner_room(triangle_bounds(mesh), scene.gap);
            input.groups.assign(1, {placed_vertices(room, glm::mat4(1))});
            of_kind[scene.name] = errors_json(compare(input));
        }
    };
    if (has_maps(field.parameters)) verify(DFIELD_KIND_MAPS);
    if (field.lines) verify(DFIELD_KIND_LINES);
    if (!field.directions.empty()) verify(DFIELD_KIND_DIRECTIONS);
    return verified;
}

std::vector<std::string> verification_lines(const Json& verified) {
    std::vector<std::string> lines;
    for (const auto& [kind, scenes] : verified.items()) {
        std::string line = kind;
        for (const auto& [scene, errors] : scenes.items()) {
            // A file's provenance may hold anything.
            const auto rms = errors.is_object() ? errors.find("rms_grey") : errors.end();
            if (rms == errors.end() || !rms->is_number()) continue;
            line += text("%s %.4g grey RMS (%s)", line == kind ? "" : ",", rms->get<double>(), scene.c_str());
        }
        lines.push_back(line);
    }
    return lines;
}

}  // namespace dfield::cli
