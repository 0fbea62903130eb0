#include <algorithm>
#include <cmath>
#include <filesystem>

#include "baker/cli/arguments.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/field_store.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/plan_options.hpp"
#include "baker/cli/report.hpp"
#include "baker/cli/runtime_scene.hpp"
#include "baker/cli/scene_visibility.hpp"
#include "baker/cli/terminal.hpp"
#include "baker/file_io.hpp"
#include "baker/output/gltf_output.hpp"
#include "baker/picture/render.hpp"
#include "baker/scene.hpp"

namespace dfield::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kSharedRays = 512;  // over the whole sphere: half of them face a vertex

struct AoCommand {
    fs::path scene, output, image, cache;
    bool no_cache = false, no_self = false, color = false, rays = false;
    float crease_degrees = 180;
    std::string method = "lookup", up = "y";
    std::vector<float> ground_plane;
    float ground = 0;
    bool has_ground = false;
    PlanOptions plan_options;
    FieldPlan plan;
    AoOptions ao;
    CommonOptions common;
};

bool is_gltf(const fs::path& path) {
    return extension_of(path) == ".glb" || extension_of(path) == ".gltf";
}

// What is wrong with outputs and ground is known before the work begins.
void check_command(const AoCommand& command) {
    const std::string extension = extension_of(command.output);
    if (extension != ".ply" && extension != ".glb" && extension != ".gltf")
        throw Error(ExitCode::kUsage,
                    command.output.string() + ": the output must end in .glb, .gltf or .ply");
    if (extension == ".gltf" && !is_gltf(command.scene))
        throw Error(ExitCode::kUsage, command.output.string() +
                                          ": .gltf output needs a glTF scene; write .glb or .ply from " +
                                          extension_of(command.scene));
    if (command.color && extension == ".ply")
        throw Error(ExitCode::kUsage, "--color is for glTF; PLY always has greys beside `quality`");
    // A glTF file comes through whole, a PLY keeps no more than positions, normals and faces.
    std::error_code error;
    if (extension == ".ply" && fs::equivalent(command.scene, command.output, error))
        throw Error(ExitCode::kUsage, command.output.string() + ": is the scene itself; choose another name");
    check_output(command.output);
    check_picture(command.image);
    const std::vector<float>& plane = command.ground_plane;
    if (!plane.empty() && plane[0] == 0 && plane[1] == 0 && plane[2] == 0)
        throw Error(ExitCode::kUsage, "--ground-plane: the normal is zero; expected n.x n.y n.z d");
}

void write_output(const AoCommand& command, const ImportedScene& scene,
                  const std::vector<std::vector<float>>& values) {
    if (extension_of(command.output) == ".ply")
        write_ply_occlusion(command.output, scene, values);
    else if (is_gltf(command.scene))
        write_gltf_occlusion(command.scene, command.output, scene, values, {.color = command.color});
    else
        write_new_glb_occlusion(command.output, scene, values, {.color = command.color});
}

void save_picture(const AoCommand& command, const ImportedScene& scene,
                  const std::vector<std::vector<float>>& values) {
    std::vector<RenderObject> objects;
    Bounds bounds{glm::vec3(std::numeric_limits<float>::max()),
                  glm::vec3(std::numeric_limits<float>::lowest())};
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const TriangleMesh& mesh = scene.meshes[scene.instances[i].mesh].mesh;
        if (!casts(mesh, scene.instances[i].transform)) continue;
        objects.push_back({&mesh, scene.instances[i].transform, values[i]});
        for (const glm::vec3& position : mesh.positions) {
            const glm::vec3 placed(scene.instances[i].transform * glm::vec4(position, 1));
            bounds.min = glm::min(bounds.min, placed);
            bounds.max = glm::max(bounds.max, placed);
        }
    }
    RenderOptions options;
    options.width = 960;
    options.height = 720;
    options.threads = command.common.threads;
    const glm::vec3 up = command.up == "z" ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    const glm::vec3 towards_eye = command.up == "z" ? glm::vec3(1, -1.1f, 0.7f) : glm::vec3(1, 0.7f, 1.1f);
    write_png(command.image,
              render(objects, frame_bounds(bounds, towards_eye, up, 30, 960.0f / 720), options));
}

// --kind auto, what is baked, and how rays are sampled.
void choose_kind(AoCommand& command, const CLI::App& ao) {
    dfield_ao_desc& desc = command.ao.desc;
    std::string& kind = command.plan_options.kind;
    if (kind == "all")
        throw Error(ExitCode::kUsage, "--kind: ao needs one kind: auto, maps, lines, directions or volume");
    const bool distances = std::isfinite(desc.max_distance) || desc.bias > 0;
    if (kind == "auto") {
        bool map_flags = false;
        for (const char* flag : {"--subdivision", "--map-size", "--mapping", "--positions", "--bits"})
            map_flags = map_flags || ao.count(flag) > 0;
        kind = distances || map_flags || desc.ray_count > DFIELD_MAX_SHARED_RAYS ? "maps" : "directions";
    }
    desc.kind = command.plan_options.forced_kind();
    if (kind == "directions") {
        if (ao.count("--rays") == 0) desc.ray_count = kSharedRays;
        desc.sampling = DFIELD_SAMPLING_SHARED;
        if (desc.ray_count > DFIELD_MAX_SHARED_RAYS)
            throw Error(ExitCode::kUsage, text("--rays %u: direction maps share at most %u directions; take "
                                               "--kind maps or lines",
                                               desc.ray_count, DFIELD_MAX_SHARED_RAYS));
    }
    command.plan = command.plan_options.plan();
    if (!distances) return;
    const bool known = kind == "maps" || (kind == "lines" && command.plan.lines->depth_bits != 0) ||
                       (kind == "directions" && command.plan.directions.back().depth_size != 0);
    if (kind == "volume")
        throw Error(
            ExitCode::kUsage,
            "--max-distance, --falloff and --bias ask for distances, which occlusion volumes do not know; "
            "take --kind maps");
    if (!known)
        throw Error(ExitCode::kUsage,
                    "--max-distance and --bias ask for distances: " +
                        (kind == "lines" ? std::string("give --line-bits 4 or 8")
                                         : std::string("give --direction-depth 16 or more")) +
                        ", or take --kind maps");
}

void run(AoCommand& command) {
    finish_ao_options(command.ao);
    check_command(command);
    ImportedScene scene = import_scene(command.scene, {.crease_degrees = command.crease_degrees});
    note_flat_nodes(scene);
    warn_of(command.scene, scene.report);

    SceneVisibilityOptions options;
    options.method = command.method == "rays" ? Method::kRays : Method::kLookup;
    options.self = !command.no_self;
    options.ao = command.ao.desc;
    options.plan = command.plan;
    options.threads = command.common.threads;
    options.quiet = command.common.quiet;
    if (!command.no_cache) options.cache = command.cache;
    if (!command.ground_plane.empty())
        options.ground = command.ground_plane;
    else if (command.has_ground)
        options.ground = command.up == "z" ? std::vector<float>{0, 0, 1, command.ground}
                                           : std::vector<float>{0, 1, 0, command.ground};
    const SceneVisibility visibility = scene_visibility(scene, options);
    if (interrupted) throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
    write_output(command, scene, visibility.values);
    if (!command.image.empty()) save_picture(command, scene, visibility.values);

    double mean = 0;
    for (const auto& values : visibility.values)
        for (const float value : values) mean += value;
    mean /= static_cast<double>(std::max<std::size_t>(visibility.vertices, 1));
    const auto& target = command.common.json;
    const std::string answered = command.method == "rays" ? "rays" : "lookup (" + visibility.kind + ")";
    say(target, text("%s: %zu vertices of %zu instances of %zu meshes by %s, mean visibility %.3f",
                     command.output.string().c_str(), visibility.vertices, scene.instances.size(),
                     scene.meshes.size(), answered.c_str(), mean));
    say(target,
        text("%zu fields baked, %zu from the cache (%.2f s); self-occlusion %.2f s; visibility %.3f s",
             visibility.baked, visibility.from_cache, visibility.bake_seconds, visibility.self_seconds,
             visibility.visibility_seconds));
    write_json_report(target,
                      {{"scene", command.scene.string()},
                       {"output", command.output.string()},
                       {"method", command.method},
                       {"kind", visibility.kind},
                       {"sampling", options.ao.sampling == DFIELD_SAMPLING_SHARED ? "shared" : "hemisphere"},
                       {"meshes", scene.meshes.size()},
                       {"instances", scene.instances.size()},
                       {"vertices", visibility.vertices},
                       {"rays_per_vertex", command.ao.desc.ray_count},
                       {"self", options.self},
                       {"mean_visibility", significant(mean)},
                       {"fields_baked", visibility.baked},
                       {"fields_from_cache", visibility.from_cache},
                       {"field_bytes", visibility.field_bytes},
                       {"bake_seconds", significant(visibility.bake_seconds)},
                       {"self_seconds", significant(visibility.self_seconds)},
                       {"visibility_seconds", significant(visibility.visibility_seconds)},
                       {"degenerate", scene.report.degenerate},
                       {"not_finite", scene.report.not_finite},
                       {"index_out_of_range", scene.report.index_out_of_range},
                       {"warnings", scene.report.warnings}});
}

}  // namespace

void add_ao_command(CLI::App& app, ExitCode&) {
    auto command = std::make_shared<AoCommand>();
    command->cache = default_cache_folder();
    CLI::App* ao =
        app.add_subcommand("ao", "Ambient occlusion at every vertex of a scene, written into the scene");
    ao->add_option("SCENE", command->scene, "GLB, glTF, OBJ, PLY, OFF or STL")->required();
    ao->add_option(
          "-o,--output", command->output,
          "OUT.glb or .gltf: the scene with a float attribute _OCCLUSION (1 = open) on every primitive; "
          "OUT.ply: all vertices with `quality` and greys")
        ->required();
    ao->add_flag("--color", command->color,
                 "glTF: visibility as COLOR_0 too; it multiplies base colour in viewers");
    ao->add_option("--image", command->image, "Also a PNG of the scene, shaded by its visibility");
    ao->add_flag("--no-self", command->no_self, "Objects do not occlude themselves");
    ao->add_option("--method", command->method, "lookup, or rays: the same by ray casting, the reference")
        ->capture_default_str()
        ->check(CLI::IsMember({"lookup", "rays"}));
    auto* ground = ao->add_option("--ground", command->ground, "Solid ground at this height along --up")
                       ->check(finite_number());
    ao->add_option("--ground-plane", command->ground_plane,
                   "Solid ground below the plane n.p = d: n.x n.y n.z d")
        ->expected(4)
        ->check(finite_number())
        ->excludes("--ground");
    ao->add_option("--up", command->up,
                   "The axis that points up, for --ground and --image: y (as in glTF) or z")
        ->capture_default_str()
        ->check(CLI::IsMember({"y", "z"}));
    ao->add_option(
          "--crease", command->crease_degrees,
          "Where the file has no normals: faces that meet at more than this many degrees do not smooth")
        ->capture_default_str()
        ->check(number_between(0, 180));
    add_ao_options(*ao, command->ao);
    // Vertices of a scene stand among its objects: tangent planes cut them. Depths coarser than the maps hide
    // too much there.
    command->plan_options.depths_by_default = true;
    add_plan_options(*ao, command->plan_options);
    ao->get_option("--kind")->description(
        "What is baked and looked up: maps (displacement maps), lines (a line table), directions (direction "
        "maps, with directions that all vertices share), volume (an occlusion volume), or auto: directions, "
        "the most accurate and the fastest "
        "here; maps "
        "where --max-distance, --falloff or --bias ask for distances, where more rays are wanted than "
        "vertices can "
        "share (4096), or where a flag of the displacement maps is given");
    ao->get_option("--rays")
        ->default_str("256; 512 with direction maps")
        ->description(
            "Rays a vertex, cosine-weighted; a square number gives a grid. With direction maps: the "
            "directions over the whole sphere that all vertices share");
    ao->add_option("--cache", command->cache, "Folder of baked fields")->capture_default_str();
    ao->add_flag("--no-cache", command->no_cache, "Neither read nor write the cache");
    add_common_options(*ao, command->common, "all cores");
    ao->footer(
        "Each distinct mesh is baked once, however many nodes use it. Occlusion by other objects is looked "
        "up; an\n"
        "object's own is ray cast. With direction maps the two are united ray by ray, otherwise multiplied.");
    ao->callback([command, ao, ground] {
        command->has_ground = ground->count() > 0;
        choose_kind(*command, *ao);
        run(*command);
    });
}

}  // namespace dfield::cli
