#include <filesystem>
#include <map>

#include "baker/bake.hpp"
#include "baker/cli/arguments.hpp"
#include "baker/cli/budget.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/comparison.hpp"
#include "baker/cli/comparison_picture.hpp"
#include "baker/cli/corner.hpp"
#include "baker/cli/field_store.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/plan_options.hpp"
#include "baker/cli/report.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/file_io.hpp"
#include "baker/parallel.hpp"
#include "baker/ray_visibility.hpp"
#include "baker/scene.hpp"
#include "format/file.hpp"
#include "format/hemisphere_map.hpp"

namespace dfield::cli {
namespace {

namespace fs = std::filesystem;

struct CompareCommand {
    fs::path caster, field, image;
    std::string scene = "corner";
    std::string ray_sampling = "concentric";
    std::optional<std::uint32_t> rays;  // by default kHemisphereRays, or kSharedRays for direction maps
    std::uint32_t converged_rays = 4096;
    int repetitions = 5;
    bool no_cache = false;
    std::uint64_t budget = 0;  // 0: the options' plan it is
    fs::path cache;
    PlanOptions options;
    FieldPlan plan;
    CommonOptions common;
};

constexpr std::uint32_t kHemisphereRays = 256, kSharedRays = 512;

// Everything that one comparison is made of, with the meshes it points into.
struct Setting {
    std::map<std::size_t, TriangleMesh> meshes;  // stable addresses
    ComparisonInput input;
    std::vector<PictureObject> objects;    // one a group, then objects that only cast
    std::vector<std::vector<float>> self;  // a group's visibility past its own object; empty: open
    Camera camera;
};

BakeOptions bake_options(ProgressBar& progress) {
    BakeOptions options;
    options.cancel = &interrupted;
    options.progress = [&progress](std::uint64_t done, std::uint64_t total) { progress.update(done, total); };
    return options;
}

std::vector<std::byte> field_bytes(const CompareCommand& command, const TriangleMesh& mesh,
                                   const std::string& label) {
    ProgressBar progress("baking " + label, "ray", command.common.quiet);
    return cached_field(mesh, command.plan, bake_options(progress),
                        command.no_cache ? fs::path() : command.cache)
        .bytes;
}

// --field: the file's own bytes, after a look at whether they belong to the caster.
std::vector<std::byte> given_field(const CompareCommand& command, const TriangleMesh& mesh) {
    std::vector<std::byte> bytes = read_file(command.field);
    try {
        const Json provenance = Json::parse(read_field(bytes).provenance, nullptr, false);
        if (!provenance.is_discarded() && provenance.contains("mesh") &&
            provenance["mesh"].value("hash", "") != mesh_hash(mesh))
            std::fprintf(stderr, "dfield: warning: %s was baked from another mesh than %s\n",
                         command.field.string().c_str(), command.caster.string().c_str());
    } catch (const FormatError& error) {
        throw InputError(command.field.string() + ": " + error.what());
    }
    return bytes;
}

// The first kind that a file has, in the order in which single rays are answered.
std::string kind_of_file(const fs::path& path) {
    try {
        const DisplacementField field = read_field(read_file(path));
        return has_maps(field.parameters)  ? "maps"
               : field.lines               ? "lines"
               : !field.directions.empty() ? "directions"
                                           : "volume";
    } catch (const FormatError& error) {
        throw InputError(path.string() + ": " + error.what());
    }
}

void add_group(Setting& setting, const TriangleMesh& mesh, const glm::mat4& transform, std::size_t owner,
               bool room) {
    setting.input.groups.push_back({placed_vertices(mesh, transform), owner});
    setting.objects.push_back({&mesh, transform, {}, {}, room});
    setting.self.emplace_back();
}

ImportedScene imported(const fs::path& path) {
    ImportedScene scene = import_scene(path);
    note_flat_nodes(scene);
    warn_of(path, scene.report);
    return scene;
}

void set_corner(const CompareCommand& command, Setting& setting, float gap) {
    const ImportedScene scene = imported(command.caster);
    const TriangleMesh& caster = setting.meshes[0] = flatten_scene(scene);
    const TriangleMesh& room = setting.meshes[1] = corner_room(triangle_bounds(caster), gap);
    setting.input.fields.push_back(command.field.empty()
                                       ? field_bytes(command, caster, command.caster.filename().string())
                                       : given_field(command, caster));
    setting.input.casters.push_back({&caster, 0, glm::mat4(1)});
    add_group(setting, room, glm::mat4(1), ReceiverGroup::kNoOwner, true);
    if (command.image.empty()) return;
    PictureObject object{&caster, glm::mat4(1), {}, {}, false};
    object.reference = object.lookup = self_visibility(caster, 256, 0, &interrupted);
    setting.objects.push_back(object);
    setting.camera = frame_bounds(triangle_bounds(room), {1, 0.8f, 1.1f}, {0, 1, 0}, 30, 560.0f / 480);
}

// A scene file: every instance is a caster and a receiver, or with --caster a receiver only.
void set_scene(const CompareCommand& command, Setting& setting) {
    const ImportedScene scene = imported(command.scene);
    const bool receivers_only = !command.caster.empty();
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) setting.meshes[i] = scene.meshes[i].mesh;
    std::map<std::uint32_t, std::size_t> fields;  // of the meshes that cast
    if (receivers_only) {
        const std::size_t index = scene.meshes.size();
        setting.meshes[index] = flatten_scene(imported(command.caster));
        setting.input.fields.push_back(command.field.empty()
                                           ? field_bytes(command, setting.meshes[index], "caster")
                                           : given_field(command, setting.meshes[index]));
        setting.input.casters.push_back({&setting.meshes[index], 0, glm::mat4(1)});
    }
    Bounds bounds{glm::vec3(std::numeric_limits<float>::max()),
                  glm::vec3(std::numeric_limits<float>::lowest())};
    std::map<std::uint32_t, std::vector<float>> self;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const SceneInstance& instance = scene.instances[i];
        const TriangleMesh& mesh = setting.meshes[instance.mesh];
        std::size_t owner = ReceiverGroup::kNoOwner;
        if (!receivers_only && casts(mesh, instance.transform)) {
            const auto [field, added] = fields.emplace(instance.mesh, setting.input.fields.size());
            if (added)
                setting.input.fields.push_back(field_bytes(command, mesh, scene.meshes[instance.mesh].name));
            owner = setting.input.casters.size();
            setting.input.casters.push_back({&mesh, field->second, instance.transform});
        }
        add_group(setting, mesh, instance.transform, owner, false);
        if (command.image.empty() || mesh.triangles.empty()) continue;
        for (const glm::vec3& position : setting.input.groups.back().receivers.positions) {
            bounds.min = glm::min(bounds.min, position);
            bounds.max = glm::max(bounds.max, position);
        }
        auto& values = self[instance.mesh];
        if (values.empty()) values = self_visibility(mesh, 256, 0, &interrupted);
        setting.self.back() = values;
    }
    if (!receivers_only && setting.input.casters.size() < 2)
        throw InputError(command.scene +
                         ": has fewer than two objects, so that none occludes another; give the "
                         "occluder with --caster");
    setting.camera = frame_bounds(bounds, {1, 0.8f, 1.1f}, {0, 1, 0}, 30, 560.0f / 480);
}

void save_picture(const CompareCommand& command, Setting& setting, const Comparison& result) {
    std::size_t first = 0;
    for (std::size_t g = 0; g < setting.input.groups.size(); ++g) {
        const std::size_t count = setting.input.groups[g].receivers.size();
        const auto values = [&](const std::vector<float>& all) {
            std::vector<float> own(all.begin() + first, all.begin() + first + count);
            for (std::size_t i = 0; i < setting.self[g].size(); ++i) own[i] *= setting.self[g][i];
            return own;
        };
        setting.objects[g].reference = values(result.reference);
        setting.objects[g].lookup = values(result.lookup);
        first += count;
    }
    write_png(command.image,
              comparison_picture(setting.objects, setting.camera, result, command.common.threads));
}

void print_comparison(const CompareCommand& command, const Comparison& result) {
    const auto& target = command.common.json;
    say(target,
        text("%zu receivers, %srays, %.0f%% of them meet a bounding sphere", result.receivers,
             with_prefix(static_cast<double>(result.rays)).c_str(), 100 * result.sphere_hit_fraction));
    say(target,
        text("lookup   %8.1f Mray/s, %.1f ns a receiver (%s)", result.lookup_mrays_per_s,
             result.lookup_seconds * 1e9 / static_cast<double>(result.receivers), result.kind.c_str()));
    say(target, text("Embree   %8.1f Mray/s (%s, its fastest mode here)", result.embree_mrays_per_s,
                     result.embree_mode.c_str()));
    say(target, text("speedup  %8.2f x", result.speedup) +
                    (result.speedup_sphere_hits > 0
                         ? text("; %.2f x on rays that meet a sphere", result.speedup_sphere_hits)
                         : std::string()));
    say(target, text("error    %8.2f grey RMS of 255, bias %+.2f, 95%% below %.1f, max %.1f", result.rms_grey,
                     result.bias_grey, result.percentile_95, result.max_grey));
    say(target,
        text("         %8.2f grey RMS against %u rays", result.rms_grey_converged, command.converged_rays) +
            (result.knows_rays ? text("; %.2f%% of the rays disagree", 100 * result.disagree_fraction)
                               : std::string()));
    say(target, text("memory   %s loaded, %s on disk", bytes_text(result.field_bytes).c_str(),
                     bytes_text(result.file_bytes).c_str()));
}

// --budget: the command with the plan that was chosen for the caster, which is baked in memory.
BudgetChoice choose_plan(CompareCommand& command) {
    if (command.caster.empty())
        throw Error(ExitCode::kUsage, "--budget needs a model to choose for: --caster MODEL");
    BudgetOptions options;
    options.budget = command.budget;
    options.kind = command.options.forced_kind();
    options.quiet = command.common.quiet;
    BudgetChoice choice = choose_within_budget(flatten_scene(import_scene(command.caster)), options);
    command.plan = choice.winner().plan;
    command.options.kind = name_of(choice.winner().kind);
    command.no_cache = true;
    for (const std::string& line : choice.lines()) say(command.common.json, line);
    return choice;
}

void run(CompareCommand& command) {
    check_picture(command.image);
    std::optional<BudgetChoice> choice;
    if (command.budget != 0) choice = choose_plan(command);
    Setting setting;
    ComparisonInput& input = setting.input;
    input.threads = command.common.threads;
    input.repetitions = command.repetitions;
    input.converged_rays = command.converged_rays;
    input.kind = command.options.forced_kind();
    input.shared = input.kind == DFIELD_KIND_DIRECTIONS;
    const std::uint32_t rays = command.rays.value_or(input.shared ? kSharedRays : kHemisphereRays);
    input.directions = input.shared                      ? fibonacci_sphere(rays)
                       : command.ray_sampling == "polar" ? polar_directions(rays, input.weights)
                                                         : cosine_directions(rays);
    if (command.scene == "corner" || command.scene == "corner-contact") {
        if (command.caster.empty())
            throw Error(ExitCode::kUsage, "scene " + command.scene + " needs a model in it: --caster MODEL");
        set_corner(command, setting, command.scene == "corner" ? 0.1f : 0.0f);
    } else {
        set_scene(command, setting);
    }
    const Comparison result = compare(input);
    if (!command.image.empty()) save_picture(command, setting, result);
    print_comparison(command, result);
    Json json;
    json["scene"] = command.scene;
    json["caster"] = command.caster.string();
    json.update(result.json());
    if (choice) json["budget"] = choice->json();
    json["threads"] = input.threads;
    write_json_report(command.common.json, json);
}

}  // namespace

void add_compare_command(CLI::App& app, ExitCode&) {
    auto command = std::make_shared<CompareCommand>();
    command->cache = default_cache_folder();
    command->common.threads = 1;
    CLI::App* compare = app.add_subcommand("compare", "Lookup against ray casting: error, speed, pictures");
    compare->add_option("--caster", command->caster, "The model that occludes")->check(CLI::ExistingFile);
    compare
        ->add_option("--scene", command->scene,
                     "corner: the paper's three planes, a gap of 0.1 longest sides away; corner-contact: "
                     "touching; or a "
                     "scene file, whose objects occlude each other (with --caster: are receivers only)")
        ->capture_default_str();
    compare->add_option("--field", command->field, "The caster's .dfield; otherwise it is baked")
        ->check(CLI::ExistingFile)
        ->needs("--caster");
    compare
        ->add_option("--rays", command->rays,
                     "Rays a vertex; with --kind directions the directions that all vertices share, over the "
                     "whole sphere")
        ->default_str("256; 512 with --kind directions")
        ->check(CLI::Range(1, 65536));
    compare
        ->add_option(
            "--ray-sampling", command->ray_sampling,
            "Rays of a vertex: concentric (cosine-weighted) or polar (the paper's uniform; weighted)")
        ->capture_default_str()
        ->check(CLI::IsMember({"concentric", "polar"}));
    compare->add_option("--converged-rays", command->converged_rays, "Rays of rms_grey_converged's reference")
        ->capture_default_str()
        ->check(CLI::Range(1, 65536));
    compare->add_option("--repetitions", command->repetitions, "Timed runs of each side; the fastest counts")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    compare->add_option("--image", command->image, "PNG of reference, lookup and their difference x5");
    compare->add_option("--cache", command->cache, "Folder of baked fields")->capture_default_str();
    compare->add_flag("--no-cache", command->no_cache, "Neither read nor write the cache");
    add_plan_options(*compare, command->options);
    compare->get_option("--kind")->description(
        "What is looked up: maps (displacement maps), lines (a line table), directions (direction maps) or "
        "volume (an occlusion volume); auto: maps, or with --budget the best");
    add_budget_option(*compare, command->budget);
    compare->get_option("--budget")->excludes("--field");
    add_common_options(*compare, command->common, "1");
    compare->footer(
        "Errors are of visibility in grey levels, 0..255, over all receivers. Embree's side is its best: "
        "any-hit\n"
        "queries on the casters alone, packets prepared beforehand, the fastest of seven modes. The lookup's "
        "side is\n"
        "the whole call, rays made from vertices included. --kind auto compares displacement maps, with "
        "--field "
        "what the\nfile has, with --budget what it chooses.");
    compare->callback([command, compare] {
        for (const char* flag :
             {"--subdivision", "--map-size", "--mapping", "--positions", "--bits", "--volume-size"})
            if (!command->field.empty() && compare->count(flag) > 0)
                std::fprintf(stderr, "dfield: warning: %s is ignored: %s has its own (see dfield info)\n",
                             flag, command->field.string().c_str());
        if (command->options.kind == "auto" && command->budget == 0)
            command->options.kind = command->field.empty() ? "maps" : kind_of_file(command->field);
        if (command->options.kind == "all")
            throw Error(ExitCode::kUsage,
                        "--kind: compare one kind at a time: maps, lines, directions or volume");
        if ((command->options.kind == "directions" || command->options.kind == "auto") &&
            command->ray_sampling == "polar")
            throw Error(ExitCode::kUsage,
                        "--ray-sampling is for rays around a normal; direction maps share theirs");
        command->plan = command->options.plan();
        for (const std::string& note : command->options.notes())
            std::fprintf(stderr, "dfield: %s\n", note.c_str());
        run(*command);
    });
}

}  // namespace dfield::cli
