#include "bench/paper/lab.hpp"

#include <algorithm>
#include <cstdio>

#include "baker/bake.hpp"
#include "baker/cli/corner.hpp"
#include "baker/ray_visibility.hpp"
#include "baker/scene.hpp"
#include "format/hemisphere_map.hpp"
#include "format/writer.hpp"

namespace dfield::paper {
namespace {

constexpr std::uint32_t kRays = 256, kConvergedRays = 4096;
constexpr std::uint32_t kQuickRays = 64, kQuickDivisor = 8;
constexpr double kEnoughSeconds = 1;  // of baking, for a figure that can be believed

float linear_occlusion(const void* reach, float distance) {
    return 1 - distance / *static_cast<const float*>(reach);
}

}  // namespace

Baked Lab::timed_bake(const TriangleMesh& mesh, const FieldParameters& parameters) const {
    BakeOptions options;
    options.parameters = parameters;
    options.threads = 1;
    BakeReport report;
    const DisplacementField field = bake_field(mesh, options, &report);
    Baked result{parameters, write_field(field), report.rays, report.build_seconds, report.trace_seconds};
    for (double spent = result.seconds(); !quick_ && spent < kEnoughSeconds;
         spent += report.build_seconds + report.trace_seconds) {
        bake_field(mesh, options, &report);
        result.build_seconds = std::min(result.build_seconds, report.build_seconds);
        result.trace_seconds = std::min(result.trace_seconds, report.trace_seconds);
    }
    return result;
}

Lab::Lab(const std::filesystem::path& own, const std::filesystem::path& shared, bool quick) : quick_(quick) {
    load("cube with a hole", own / "cube_with_hole.obj");
    load("leafy tree", own / "leafy_tree.obj");
    if (!quick) {
        load("cow", shared / "cow.obj");
        load("spot", shared / "spot.obj");
        load("lemon tree", shared / "lemon_tree.obj");
        load("mountain", shared / "mountain_open.obj");
        load("bunny", shared / "stanford-bunny.obj");
        load("igea", shared / "igea_triangles.ply");
    }
    const std::uint32_t count = quick ? kQuickRays : kRays;
    directions_[Rays::kConcentric].directions = cosine_directions(count);
    Directions& polar = directions_[Rays::kPolar];
    polar.directions = polar_directions(count, polar.weights);
    directions_[Rays::kConverged].directions = cosine_directions(quick ? kRays : kConvergedRays);
}

void Lab::load(const std::string& name, const std::filesystem::path& path) {
    if (std::filesystem::exists(path))
        models_.push_back({name, flatten_scene(import_scene(path))});
    else
        missing_.push_back(name);
}

const Model* Lab::find(const std::string& name) const {
    const auto at =
        std::find_if(models_.begin(), models_.end(), [&](const Model& model) { return model.name == name; });
    return at == models_.end() ? nullptr : &*at;
}

const Model& Lab::subject() const {
    const Model* bunny = find("bunny");
    return bunny ? *bunny : models_.front();
}

FieldParameters Lab::parameters(std::uint32_t subdivision, std::uint32_t map_size, std::uint32_t bits) const {
    const std::uint32_t divisor = quick_ ? kQuickDivisor : 1;
    FieldParameters parameters;
    parameters.subdivision = std::max(1u, subdivision / divisor);
    parameters.map_size = std::max(2u, map_size / divisor);
    parameters.bits = bits;
    return parameters;
}

const Baked& Lab::baked(const Model& model, const FieldParameters& parameters) {
    const FieldKey key{
        &model,         parameters.positions, parameters.subdivision, parameters.mapping, parameters.map_size,
        parameters.bits};
    const auto at = baked_.find(key);
    return at != baked_.end() ? at->second
                              : baked_.emplace(key, timed_bake(model.mesh, parameters)).first->second;
}

const TriangleMesh& Lab::room(const Model& model, Room room) {
    TriangleMesh& mesh = rooms_[{&model, room}];
    if (mesh.positions.empty())
        mesh = cli::corner_room(triangle_bounds(model.mesh), room == Room::kGap ? 0.1f : 0.0f);
    return mesh;
}

const Receivers& Lab::receivers(const Model& model, Room room) {
    Receivers& receivers = receivers_[{&model, room}];
    if (receivers.positions.empty()) receivers = cli::placed_vertices(this->room(model, room), glm::mat4(1));
    return receivers;
}

float Lab::reach(const Model& model) const {
    const glm::vec3 size = triangle_bounds(model.mesh).size();
    return 2 * std::max({size.x, size.y, size.z});
}

const std::vector<float>& Lab::ray_cast(const Model& model, Room room, Rays rays, float reach) {
    std::vector<float>& visibility = ray_cast_[{&model, room, rays, reach}];
    if (visibility.empty()) {
        EmbreeScene scene(EmbreeUse::kFast);
        scene.add_mesh(model.mesh);
        scene.commit();
        RayVisibilityOptions options;
        options.directions = directions(rays).directions;
        options.weights = directions(rays).weights;
        if (reach < kUnbounded) {
            options.max_distance = reach;
            options.occlusion = linear_occlusion;
            options.occlusion_data = &reach;
        }
        const Receivers& points = receivers(model, room);
        visibility = ray_visibility(scene, points.positions, points.normals, options);
    }
    return visibility;
}

const std::vector<float>& Lab::self_visibility(const Model& model) {
    std::vector<float>& visibility = self_[&model];
    if (visibility.empty()) visibility = dfield::self_visibility(model.mesh, quick_ ? kQuickRays : kRays, 0);
    return visibility;
}

}  // namespace dfield::paper
