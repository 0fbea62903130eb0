#include "baker/cli/arguments.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/kinds_report.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/report.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/cli/verification.hpp"
#include "baker/file_io.hpp"
#include "baker/provenance.hpp"
#include "format/file.hpp"

namespace dfield::cli {
namespace {

Json vector_json(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

Json info_json(const std::string& path, const FileInfo& file, const DisplacementField& field) {
    const FieldParameters& parameters = field.parameters;
    Json json;
    json["file"] = path;
    json["version"] = text("%u.%u", file.version_major, file.version_minor);
    json["file_bytes"] = file.file_bytes;
    json["field_bytes"] = kinds_bytes(field);
    if (has_maps(parameters)) {
        json["layout"] = name_of(parameters.positions);
        json["subdivision"] = parameters.subdivision;
        json["positions"] = position_count(parameters);
        json["paper_positions"] = paper_position_count(parameters);
        json["mapping"] = name_of(parameters.mapping);
        json["map_size"] = parameters.map_size;
        json["bits"] = parameters.bits;
    }
    json["kinds"] = kinds_json(field, file);
    json["centre"] = vector_json(field.centre);
    json["radius"] = field.radius;
    json["bounds_min"] = vector_json(field.bounds_min);
    json["bounds_max"] = vector_json(field.bounds_max);
    json["self_vertices"] = field.self_visibility.size();
    json["payload_hash"] = payload_hash(field);
    json["provenance"] = Json::parse(field.provenance, nullptr, false);
    if (json["provenance"].is_discarded()) json["provenance"] = field.provenance;
    Json sections = Json::array();
    for (const SectionInfo& section : file.sections)
        sections.push_back({{"id", section.id},
                            {"offset", section.offset},
                            {"stored_bytes", section.stored_bytes},
                            {"raw_bytes", section.raw_bytes}});
    json["sections"] = sections;
    return json;
}

void print_info(const std::string& target, const Json& json, const std::vector<KindLine>& kinds) {
    const auto line = [&](const char* label, const std::string& value) {
        say(target, text("%-12s %s", label, value.c_str()));
    };
    line("file", json["file"].get<std::string>() + ", format " + json["version"].get<std::string>());
    line("size",
         bytes_text(json["file_bytes"]) + " on disk, " + bytes_text(json["field_bytes"]) + " decoded");
    for (const KindLine& kind : kinds) line(kind.kind.c_str(), kind.description);
    line("sphere", "centre " + json["centre"].dump() + ", radius " + json["radius"].dump());
    line("box", json["bounds_min"].dump() + " to " + json["bounds_max"].dump());
    if (json["self_vertices"] != 0)
        line("self", json["self_vertices"].dump() + " vertices with baked self-occlusion");
    line("payload", json["payload_hash"].get<std::string>());
    if (json["provenance"].is_object() && json["provenance"].contains("verified"))
        for (const std::string& verified : verification_lines(json["provenance"]["verified"]))
            line("verified", verified);
    line("provenance", json["provenance"].dump());
    for (const Json& section : json["sections"])
        line("section",
             text("%s at %llu, %s stored, %s raw", section["id"].get<std::string>().c_str(),
                  section["offset"].get<unsigned long long>(), bytes_text(section["stored_bytes"]).c_str(),
                  bytes_text(section["raw_bytes"]).c_str()));
}

}  // namespace

void add_info_command(CLI::App& app, ExitCode&) {
    struct InfoCommand {
        std::string file, json;
    };
    auto command = std::make_shared<InfoCommand>();
    CLI::App* info = app.add_subcommand("info", "Show what a .dfield holds");
    info->add_option("FILE", command->file, "A .dfield")->required();
    add_json_option(*info, command->json, "it");
    info->footer(
        "The payload hash is that of the decoded field: equal for equal models and parameters, whatever "
        "wrote "
        "the\nfile. Provenance names the mesh by its hash, the parameters and the versions that baked it.");
    info->callback([command] {
        const std::vector<std::byte> bytes = read_file(command->file);
        try {
            const FileInfo file = read_file_info(bytes);
            const DisplacementField field = read_field(bytes);
            const Json json = info_json(command->file, file, field);
            print_info(command->json, json, kind_lines(field, file));
            write_json_report(command->json, json);
        } catch (const FormatError& error) {
            throw InputError(command->file + ": " + error.what());
        }
    });
}

}  // namespace dfield::cli
