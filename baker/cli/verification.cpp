#include "baker/cli/verification.hpp"

#include "baker/cli/accuracy.hpp"

namespace dfield::cli {

Json verification_json(const TriangleMesh& mesh, const DisplacementField& field,
                       std::span<const std::byte> bytes, int threads) {
    std::vector<dfield_kind> kinds;
    if (has_maps(field.parameters)) kinds.push_back(DFIELD_KIND_MAPS);
    if (field.lines) kinds.push_back(DFIELD_KIND_LINES);
    if (!field.directions.empty()) kinds.push_back(DFIELD_KIND_DIRECTIONS);
    if (field.volume) kinds.push_back(DFIELD_KIND_VOLUME);

    const ThreadedContext context(threads);
    const Field loaded = Field::load(context.get(), bytes.data(), bytes.size());
    Json verified = Json::object();
    for (const StandardScene& standard : kStandardScenes) {
        const AccuracyScene scene(mesh, standard.gap, threads);
        for (const dfield_kind kind : kinds)
            verified[name_of(kind)][standard.name] = scene.measure(context.get(), loaded, kind).json();
    }
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
