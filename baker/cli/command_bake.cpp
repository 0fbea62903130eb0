#include <chrono>
#include <filesystem>
#include <map>

#include "baker/bake.hpp"
#include "baker/cli/arguments.hpp"
#include "baker/cli/budget.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/field_store.hpp"
#include "baker/cli/kinds_report.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/plan_options.hpp"
#include "baker/cli/report.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/cli/verification.hpp"
#include "baker/file_io.hpp"
#include "baker/parallel.hpp"
#include "baker/provenance.hpp"
#include "baker/scene.hpp"
#include "format/file.hpp"
#include "format/writer.hpp"

namespace dfield::cli {
namespace {

namespace fs = std::filesystem;

struct BakeCommand {
    std::vector<fs::path> models;
    fs::path output;
    std::string mesh_name, node_name;
    float crease_degrees = 180;
    bool force = false;
    bool verify = false;
    std::uint64_t budget = 0;  // 0: `plan` it is
    PlanOptions plan_options;
    FieldPlan plan;
    BakeOptions bake;
    CommonOptions common;
};

Json field_report(const DisplacementField& field, std::span<const std::byte> bytes) {
    Json json;
    if (has_maps(field.parameters)) {
        json["positions"] = position_count(field.parameters);
        json["paper_positions"] = paper_position_count(field.parameters);
        json["layout"] = name_of(field.parameters.positions);
        json["subdivision"] = field.parameters.subdivision;
        json["mapping"] = name_of(field.parameters.mapping);
        json["map_size"] = field.parameters.map_size;
        json["bits"] = field.parameters.bits;
    }
    json["kinds"] = kinds_json(field, read_file_info(bytes));
    json["payload_hash"] = payload_hash(field);
    json["field_bytes"] = kinds_bytes(field);
    json["file_bytes"] = bytes.size();
    return json;
}

Json import_report(const ImportReport& report) {
    Json json;
    json["faces"] = report.faces;
    json["triangles"] = report.triangles;
    json["degenerate"] = report.degenerate;
    json["not_finite"] = report.not_finite;
    json["index_out_of_range"] = report.index_out_of_range;
    json["skipped_primitives"] = report.skipped_primitives;
    json["warnings"] = report.warnings;
    return json;
}

// What `work` throws of the model's contents, with the model's name before it, as a batch needs it.
template<class Work>
auto naming(const fs::path& model, const Work& work) {
    try {
        return work();
    } catch (const InputError& error) {
        throw InputError(model.string() + ": " + error.what());
    }
}

BudgetChoice chosen_plan(const BakeCommand& command, const TriangleMesh& mesh) {
    BudgetOptions options;
    options.budget = command.budget;
    options.kind = command.plan_options.forced_kind();
    if (command.bake.self_visibility) options.reserved = mesh.positions.size() * sizeof(float);
    options.threads = command.common.threads;
    options.quiet = command.common.quiet;
    return choose_within_budget(mesh, options);
}

// Bakes one model. In a batch an up-to-date output is left alone.
Json bake_model(const BakeCommand& command, const fs::path& model, const fs::path& output,
                bool skip_unchanged) {
    const auto start = std::chrono::steady_clock::now();
    const ImportedScene scene = import_scene(model, {.crease_degrees = command.crease_degrees});
    const TriangleMesh mesh =
        naming(model, [&] { return flatten_scene(scene, command.mesh_name, command.node_name); });
    warn_of(model, scene.report);

    Json json;
    json["model"] = model.string();
    json["output"] = output.string();
    json.update(import_report(scene.report));
    json["triangles"] = mesh.triangles.size();  // those traced: fewer than the file's with --mesh or --node

    if (skip_unchanged) {
        const auto present = command.budget != 0
                                 ? matching_field(output, mesh, command.bake, command.verify)
                                 : matching_field(output, mesh, command.plan, command.bake, command.verify);
        if (present) {
            json["status"] = "unchanged";
            json.update(field_report(*present, read_file(output)));
            say(command.common.json, output.string() + ": unchanged");
            return json;
        }
    }

    FieldPlan plan = command.plan;
    if (command.budget != 0) {
        const BudgetChoice choice = naming(model, [&] { return chosen_plan(command, mesh); });
        plan = choice.winner().plan;
        json["budget"] = choice.json();
        for (const std::string& line : choice.lines()) say(command.common.json, line);
    }

    ProgressBar progress(model.filename().string(), "ray", command.common.quiet);
    BakeOptions options = command.bake;
    options.progress = [&](std::uint64_t done, std::uint64_t total) { progress.update(done, total); };
    BakeReport report;
    DisplacementField field = naming(model, [&] { return bake_plan(mesh, plan, options, &report); });
    if (command.verify) {
        const Json verified = verification_json(mesh, field, write_field(field, {.zstd_level = 1}),
                                                thread_count(options.threads));
        field.provenance = with_verification(field.provenance, verified.dump());
        json["verified"] = verified;
    }
    const std::vector<std::byte> bytes = write_field(field, {.threads = thread_count(options.threads)});
    if (interrupted) throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
    write_file_atomic(output, bytes);

    json["status"] = "baked";
    json.update(field_report(field, bytes));
    json["rays"] = report.rays;
    json["mrays_per_s"] = significant(static_cast<double>(report.rays) / report.trace_seconds * 1e-6);
    json["seconds"] =
        significant(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    json["build_seconds"] = significant(report.build_seconds);
    json["trace_seconds"] = significant(report.trace_seconds);
    if (options.self_visibility) json["self_seconds"] = significant(report.self_seconds);
    json["threads"] = thread_count(options.threads);
    json["instruction_set"] = report.instruction_set;
    say(command.common.json,
        text("%s: %zu triangles, %sray in %.2f s (%.1f Mray/s), %s -> %s", output.string().c_str(),
             mesh.triangles.size(), with_prefix(static_cast<double>(report.rays)).c_str(),
             report.trace_seconds, static_cast<double>(report.rays) / report.trace_seconds * 1e-6,
             bytes_text(kinds_bytes(field)).c_str(), bytes_text(bytes.size()).c_str()));
    for (const KindLine& line : kind_lines(field, read_file_info(bytes)))
        say(command.common.json, "  " + line.kind + ": " + line.description);
    if (command.verify)
        for (const std::string& line : verification_lines(json["verified"]))
            say(command.common.json, "  verified " + line);
    return json;
}

void bake_one(const BakeCommand& command) {
    // Any other ending is a mistake, and the model itself the worst one; /dev/null and pipes are none.
    std::error_code error;
    const bool special = fs::exists(command.output, error) && !fs::is_regular_file(command.output, error);
    if (extension_of(command.output) != ".dfield" && !special)
        throw Error(ExitCode::kUsage, "'" + command.output.string() +
                                          "': the output must end in .dfield, or in / for a folder");
    check_output(command.output);
    write_json_report(command.common.json,
                      bake_model(command, command.models.front(), command.output, false));
}

// A farm's one command: every model into a folder, one failure does not stop the rest.
ExitCode bake_folder(const BakeCommand& command) {
    std::error_code error;
    fs::create_directories(command.output, error);
    if (error)
        throw OutputError(command.output.string() + ": the folder cannot be made (" + error.message() + ")");
    std::map<fs::path, fs::path> outputs;  // output -> model
    for (const fs::path& model : command.models) {
        fs::path output = command.output / model.filename().replace_extension(".dfield");
        const auto [entry, added] = outputs.emplace(output, model);
        if (!added)
            throw Error(ExitCode::kUsage, model.string() + " and " + entry->second.string() +
                                              " would both become " + output.string() +
                                              "; bake them into different folders");
    }
    Json models = Json::array();
    std::size_t failed = 0, unchanged = 0;
    for (const fs::path& model : command.models) {
        const fs::path output = command.output / model.filename().replace_extension(".dfield");
        try {
            models.push_back(bake_model(command, model, output, !command.force));
            unchanged += models.back()["status"] == "unchanged";
        } catch (const std::exception& failure) {
            if (interrupted) throw Error(ExitCode::kInterrupted, "interrupted; finished models are kept");
            std::fprintf(stderr, "dfield: %s\n", failure.what());
            models.push_back({{"model", model.string()}, {"status", "failed"}, {"error", failure.what()}});
            ++failed;
        }
    }
    const std::size_t baked = command.models.size() - failed - unchanged;
    say(command.common.json, text("%zu baked, %zu unchanged, %zu failed", baked, unchanged, failed));
    write_json_report(command.common.json,
                      {{"baked", baked}, {"unchanged", unchanged}, {"failed", failed}, {"models", models}});
    return failed ? ExitCode::kPartial : ExitCode::kOk;
}

}  // namespace

void add_bake_command(CLI::App& app, ExitCode& exit_code) {
    auto command = std::make_shared<BakeCommand>();
    CLI::App* bake = app.add_subcommand("bake", "Bake models into displacement fields");
    bake->add_option("MODEL", command->models, "OBJ, PLY, OFF, STL, glTF or GLB files")->required();
    bake->add_option("-o,--output", command->output,
                     "OUT.dfield, or a folder (DIR/) for several models: unchanged ones are skipped there")
        ->required();
    add_plan_options(*bake, command->plan_options);
    add_budget_option(*bake, command->budget);
    bake->add_option("--mesh", command->mesh_name, "glTF: bake only the mesh of this name, in its own space")
        ->group("Model");
    bake->add_option("--node", command->node_name, "glTF: bake only the node of this name and its children")
        ->group("Model")
        ->excludes("--mesh");
    bake->add_option(
            "--crease", command->crease_degrees,
            "Vertex normals for --self: faces that meet at more than this many degrees do not smooth")
        ->capture_default_str()
        ->check(number_between(0, 180))
        ->group("Model");
    bake->add_flag(
            "--self", command->bake.self_visibility,
            "Also bake each vertex's visibility past its own object, for renderers that multiply it in")
        ->group("Model");
    bake->add_option("--self-rays", command->bake.self_rays, "Rays a vertex for --self")
        ->capture_default_str()
        ->check(CLI::Range(1, 65536))
        ->group("Model");
    bake->add_flag(
        "--verify", command->verify,
        "Measure the field's error against ray casting on standard receivers, and keep the figures in "
        "its provenance");
    bake->add_flag("--force", command->force, "Into a folder: bake unchanged models too");
    add_common_options(*bake, command->common, "all cores");
    bake->footer(
        "Every triangle is traced: open, non-manifold, duplicated and inside-out meshes are fine.\n"
        "The payload does not depend on --threads or on the machine; its hash is in the report.");
    bake->callback([command, &exit_code] {
        command->bake.threads = command->common.threads;
        command->bake.cancel = &interrupted;
        command->plan = command->plan_options.plan();
        command->bake.budget = command->budget;
        command->bake.budget_kind = command->plan_options.kind;
        if (command->budget != 0 && command->plan_options.kind == "all")
            throw Error(ExitCode::kUsage,
                        "--budget chooses one kind: --kind auto, maps, lines, directions or volume");
        for (const std::string& note : command->plan_options.notes()) say(command->common.json, note);
        const std::string output = command->output.string();
        const bool folder = command->models.size() > 1 || fs::is_directory(command->output) ||
                            (!output.empty() && (output.back() == '/' || output.back() == '\\'));
        if (folder)
            exit_code = bake_folder(*command);
        else
            bake_one(*command);
    });
}

}  // namespace dfield::cli
