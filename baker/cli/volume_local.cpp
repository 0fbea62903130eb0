#include "baker/cli/volume_local.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <sstream>

#include "baker/cli/arguments.hpp"
#include "baker/cli/options.hpp"
#include "baker/cli/report.hpp"
#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/scene.hpp"

namespace dfield::cli {
namespace {

std::string read_text(const std::string& file) {
    const std::vector<std::byte> bytes = read_file(file);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Numbers out of text, separated by commas or white space.
std::vector<double> parse_numbers(std::string list, const std::string& where) {
    for (char& c : list)
        if (c == ',' || c == '[' || c == ']') c = ' ';
    std::istringstream words(list);
    words.imbue(std::locale::classic());
    std::vector<double> numbers;
    for (double value; words >> value;) numbers.push_back(value);
    if (!words.eof()) throw Error(ExitCode::kUsage, where + " holds something other than numbers");
    return numbers;
}

// `blame`: the exit code where it is none.
glm::dmat4 matrix_of(const std::vector<double>& numbers, const std::string& where, ExitCode blame) {
    if (numbers.size() != 16)
        throw Error(blame, where + text(": a pose is 16 numbers, a 4 x 4 matrix column by column, not %zu",
                                        numbers.size()));
    glm::dmat4 matrix;
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = numbers[static_cast<std::size_t>(i)];
    return matrix;
}

std::vector<double> numbers_at(const Json& json, const char* key, const std::string& where) {
    const Json& list = json[key];
    std::vector<double> numbers;
    for (const Json& number : list) {
        if (!number.is_number()) throw InputError(where + ": '" + key + "' is no list of numbers");
        numbers.push_back(number.get<double>());
    }
    return numbers;
}

}  // namespace

void add_local_options(CLI::App& command, LocalOptions& options) {
    constexpr const char* kGroup = "Local ambient occlusion";
    command
        .add_option("--rays", options.rays,
                    "Rays a voxel: 6, 14, 26 or 54, the sets of neighbours and of a Rubik's cube; any other "
                    "number, or with --fibonacci: spherical Fibonacci")
        ->capture_default_str()
        ->check(CLI::Range(1u, DFIELD_MAX_LOCAL_RAYS))
        ->group(kGroup);
    command
        .add_flag("--fibonacci", options.fibonacci, "Spherical Fibonacci directions whatever their number")
        ->group(kGroup);
    command.add_option("--ray-samples,--M", options.samples, "Samples a ray")
        ->capture_default_str()
        ->check(CLI::Range(1u, DFIELD_MAX_LOCAL_SAMPLES))
        ->group(kGroup);
    command.add_option("--ray-step", options.step, "From a sample to the next, in voxels")
        ->capture_default_str()
        ->check(number_above_zero())
        ->group(kGroup);
    command.add_flag("--world-steps", options.world, "--ray-step is in world units")->group(kGroup);
    command
        .add_option(
            "--opacity-length", options.opacity_length,
            "World units of matter that opacities are of; default: they are a sample's, as in the paper")
        ->check(number_above_zero())
        ->group(kGroup);
    command.add_option("--weights", options.weights_file, "A text file of a weight for each ray")
        ->group(kGroup);
    command.add_option("--jitter", options.jitter, "0 to 1: turns rays at random, at each voxel anew; slow")
        ->check(number_between(0, 1))
        ->group(kGroup);
    command.add_option("--seed", options.seed, "Of --jitter")->group(kGroup);
}

LocalSettings::LocalSettings(const LocalOptions& options, const TransferFunction& transfer)
    : weights_(options.weights), local_(local_defaults()) {
    const bool neighbours =
        options.rays == 6 || options.rays == 14 || options.rays == 26 || options.rays == 54;
    local_.ray_set = neighbours && !options.fibonacci ? DFIELD_RAYS_NEIGHBOURS : DFIELD_RAYS_FIBONACCI;
    local_.ray_count = options.rays;
    local_.samples = options.samples;
    local_.step_unit = options.world ? DFIELD_STEP_WORLD : DFIELD_STEP_VOXELS;
    local_.step = options.step;
    local_.jitter = options.jitter;
    local_.seed = options.seed;
    local_.approximate = options.approximate;
    if (!options.weights_file.empty()) {
        for (const double weight : parse_numbers(read_text(options.weights_file), options.weights_file))
            weights_.push_back(static_cast<float>(weight));
        if (weights_.size() != options.rays)
            throw InputError(options.weights_file +
                             text(": %zu weights for %u rays", weights_.size(), options.rays));
    }
    if (!weights_.empty()) local_.weights = weights_.data();
    for (const TransferFunction::Opacity& point : transfer.points())
        points_.push_back({static_cast<float>(point.value), point.opacity});
    opacity_.struct_size = sizeof opacity_;
    opacity_.points = points_.data();
    opacity_.point_count = points_.size();
    opacity_.unit_length = static_cast<float>(options.opacity_length);
}

void add_clip_options(CLI::App& command, ClipOptions& options) {
    constexpr const char* kGroup = "Clipping";
    command
        .add_option(
            "--clip", options.meshes,
            "A closed mesh (OBJ, PLY, OFF, STL, glTF, GLB); what is inside is clipped away. Several: give "
            "it again")
        ->group(kGroup)
        ->take_all();
    command.add_option("--probe", options.probes, "A closed mesh; what is outside is clipped away")
        ->group(kGroup)
        ->take_all();
    command
        .add_option(
            "--pose", options.poses,
            "Where the mesh lies in the world: 16 numbers, a matrix column by column; one for each mesh, "
            "--clip before --probe. Default: in the volume's middle, a third of its diagonal large")
        ->group(kGroup)
        ->take_all();
    command
        .add_option(
            "--frames", options.frames_file,
            "JSON: a list of frames, each {\"mesh\": 0, \"pose\": [16 numbers]} or {\"mesh\": 0, \"move\": "
            "[x, y, z], \"turn\": [x, y, z, degrees], \"hidden\": true}, from the mesh's first pose; or a "
            "list of such")
        ->group(kGroup);
    command
        .add_option("--clip-samples", options.samples,
                    "Anti-aliasing samples of a voxel that is cut, besides 9; 0: none at all")
        ->capture_default_str()
        ->check(CLI::Range(0u, DFIELD_MAX_CLIP_SAMPLES))
        ->group(kGroup);
    command
        .add_option("--clip-method", options.method,
                    "auto, maps (two depth maps, as in the paper) or exact (inside tests)")
        ->capture_default_str()
        ->transform(CLI::IsMember({"auto", "maps", "exact"}, CLI::ignore_case))
        ->group(kGroup);
    command.add_option("--clip-resolution", options.resolution, "Pixels along the longer side of depth maps")
        ->capture_default_str()
        ->check(CLI::Range(1, 4096))
        ->group(kGroup);
}

ClipScene::ClipScene(const ClipOptions& options, const Context& context, const VolumeGrid& grid)
    : to_frame_(world_to_frame(grid)) {
    std::vector<std::string> files = options.meshes;
    files.insert(files.end(), options.probes.begin(), options.probes.end());
    if (options.poses.size() > files.size())
        throw Error(ExitCode::kUsage, "there are more --pose than meshes to clip with");
    const glm::dvec3 last(static_cast<double>(grid.size[0] - 1), static_cast<double>(grid.size[1] - 1),
                          static_cast<double>(grid.size[2] - 1));
    const glm::dvec3 middle = grid.position(last * 0.5);
    const double diagonal = glm::length(grid.directions * last);
    Poses first;
    for (std::size_t i = 0; i < files.size(); ++i) {
        const ImportedScene scene = import_scene(files[i]);
        warn_of(files[i], scene.report);
        const TriangleMesh mesh = flatten_scene(scene);
        dfield_clip_mesh_desc desc = clip_mesh_defaults();
        desc.positions = &mesh.positions.front().x;
        desc.vertex_count = mesh.positions.size();
        desc.indices = &mesh.triangles.front().x;
        desc.triangle_count = mesh.triangles.size();
        desc.method = options.method == "exact"  ? DFIELD_CLIP_EXACT
                      : options.method == "maps" ? DFIELD_CLIP_DEPTH_MAPS
                                                 : DFIELD_CLIP_AUTO;
        desc.resolution = options.resolution;
        try {
            meshes_.emplace_back(context, desc);
        } catch (const Exception& error) {
            throw InputError(files[i] + ": " + error.what());
        }
        probes_.push_back(i >= options.meshes.size());
        const Bounds bounds = triangle_bounds(mesh);
        centres_.emplace_back(bounds.centre());
        if (i < options.poses.size()) {
            first.emplace_back(
                matrix_of(parse_numbers(options.poses[i], "--pose"), "--pose", ExitCode::kUsage));
        } else {
            const double scale = diagonal / 3 / static_cast<double>(glm::length(bounds.size()));
            first.emplace_back(glm::translate(glm::dmat4(1), middle) *
                               glm::scale(glm::dmat4(1), glm::dvec3(scale)) *
                               glm::translate(glm::dmat4(1), -centres_[i]));
        }
    }
    frames_.push_back(std::move(first));
    if (!options.frames_file.empty()) read_frames(options.frames_file);
}

void ClipScene::read_frames(const std::string& file) {
    const Json json = Json::parse(read_text(file), nullptr, false);
    const Json& list = json.is_object() && json.contains("frames") ? json["frames"] : json;
    if (!list.is_array() || list.empty()) throw InputError(file + ": is no JSON list of frames");
    const Poses start = frames_.front();
    Poses poses = start;
    frames_.clear();
    for (const Json& frame : list) {
        const std::string where = file + text(": frame %zu", frames_.size());
        for (const Json& change : frame.is_array() ? frame : Json::array({frame})) {
            if (!change.is_object()) throw InputError(where + " is no object");
            const Json index = change.value("mesh", Json(0));
            if (!index.is_number_integer() || index < 0 || index >= poses.size())
                throw InputError(where + text(": 'mesh' must be 0..%zu", poses.size() - 1));
            const auto mesh = index.get<std::size_t>();
            if (change.contains("pose")) {
                poses[mesh] = matrix_of(numbers_at(change, "pose", where), where, ExitCode::kInput);
            } else {
                glm::dmat4 pose = *start[mesh];
                const glm::dvec3 centre(pose * glm::dvec4(centres_[mesh], 1));
                if (change.contains("turn")) {
                    const auto n = numbers_at(change, "turn", where);
                    if (n.size() != 4 || glm::dvec3(n[0], n[1], n[2]) == glm::dvec3(0))
                        throw InputError(where +
                                         ": 'turn' is [x, y, z, degrees], around an axis that is not 0");
                    pose = glm::rotate(glm::translate(glm::dmat4(1), centre), glm::radians(n[3]),
                                       glm::dvec3(n[0], n[1], n[2])) *
                           glm::translate(glm::dmat4(1), -centre) * pose;
                }
                if (change.contains("move")) {
                    const auto n = numbers_at(change, "move", where);
                    if (n.size() != 3) throw InputError(where + ": 'move' is [x, y, z]");
                    pose = glm::translate(glm::dmat4(1), glm::dvec3(n[0], n[1], n[2])) * pose;
                }
                poses[mesh] = pose;
            }
            if (change.value("hidden", Json(false)) == Json(true)) poses[mesh].reset();
        }
        frames_.push_back(poses);
    }
}

std::optional<dfield_clip> ClipScene::clip(std::size_t frame, std::size_t mesh) const {
    const std::optional<glm::dmat4>& pose = frames_[frame][mesh];
    if (!pose) return std::nullopt;
    const glm::dmat4 placed = to_frame_ * *pose;
    dfield_clip clip{};
    clip.mesh = meshes_[mesh].get();
    clip.mode = probes_[mesh] ? DFIELD_CLIP_PROBE : DFIELD_CLIP_SUBTRACT;
    for (int i = 0; i < 16; ++i) clip.mesh_to_world[i] = static_cast<float>(placed[i / 4][i % 4]);
    return clip;
}

std::vector<dfield_clip> ClipScene::clips(std::size_t frame) const {
    std::vector<dfield_clip> clips;
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh)
        if (const auto shown = clip(frame, mesh)) clips.push_back(*shown);
    return clips;
}

void show_frame(const ClipScene& scene, std::size_t frame, Contextual& session,
                std::vector<std::optional<std::uint32_t>>& ids) {
    ids.resize(scene.meshes());
    for (std::size_t mesh = 0; mesh < scene.meshes(); ++mesh) {
        const auto clip = scene.clip(frame, mesh);
        if (clip && ids[mesh]) session.move(*ids[mesh], clip->mesh_to_world);
        if (clip && !ids[mesh]) ids[mesh] = session.add(*clip);
        if (!clip && ids[mesh]) {
            session.remove(*ids[mesh]);
            ids[mesh].reset();
        }
    }
}

}  // namespace dfield::cli
