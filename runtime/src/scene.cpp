#include "scene.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "status.hpp"
#include "strided.hpp"

namespace dfield::runtime {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Box of the unit sphere's image under x -> linear x + centre, a little larger: rounding of queries must not
// lead past it.
Box box_of_ball(const glm::dmat3& linear, const glm::dvec3& centre) {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        const double half =
            1.00001 * glm::length(glm::dvec3(linear[0][axis], linear[1][axis], linear[2][axis]));
        box.low[axis] = std::nextafter(static_cast<float>(centre[axis] - half), -kInfinity);
        box.high[axis] = std::nextafter(static_cast<float>(centre[axis] + half), kInfinity);
    }
    return box;
}

// The instance's transforms; inverted in double so that large translations and strong anisotropy keep their
// digits.
void place(Instance& instance, const float* object_to_world) {
    require(object_to_world, "the transform is null");
    const float* m = object_to_world;
    require(std::all_of(m, m + 16, [](float value) { return std::isfinite(value); }),
            "the transform holds a NaN or an infinity");
    require(m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1,
            "the transform's last row is not 0 0 0 1; pass a column-major affine matrix");
    const glm::dmat3 linear(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
    const glm::dvec3 translation(m[12], m[13], m[14]);
    const double volume = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
    // Relative to the box of its columns: scale itself is no reason to refuse, flatness is.
    require(std::fabs(glm::determinant(linear)) > 1e-9 * volume && volume > 0,
            "the transform is singular (zero scale on some axis); it must be invertible");

    const DisplacementField& maps = instance.field->maps;
    const double radius = maps.radius;
    const glm::dvec3 centre(maps.centre);
    const glm::dmat3 inverse = glm::inverse(linear);
    const glm::dmat3 to_unit = inverse / radius;
    const glm::dvec3 offset = (inverse * -translation - centre) / radius;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            require(std::isfinite(static_cast<float>(to_unit[column][row])) &&
                        std::isfinite(static_cast<float>(linear[column][row] * radius)),
                    "the transform's scale is beyond what floats can invert");
    instance.to_unit = to_unit;
    instance.unit_offset = offset;
    instance.to_world = linear * radius;
    instance.box_centre = (glm::dvec3(maps.bounds_min + maps.bounds_max) * 0.5 - centre) / radius;
    instance.box_half = glm::dvec3(maps.bounds_max - maps.bounds_min) * 0.5 / radius;
    if (maps.lines) {
        const glm::dmat3 from_world = glm::dmat3(maps.lines->to_unit) * inverse;
        instance.lines = {from_world, from_world * -translation -
                                          glm::dmat3(maps.lines->to_unit) * glm::dvec3(maps.lines->centre)};
        for (int column = 0; column < 3; ++column)
            require(finite(instance.lines.to_unit[column]) && finite(instance.lines.offset),
                    "the transform's scale is beyond what floats can invert");
    }
    instance.object_to_world =
        glm::mat4x3(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10], m[12], m[13], m[14]);
    instance.bounds = box_of_ball(linear * radius, linear * centre + translation);
    if (maps.lines) {
        const glm::dmat3 table_to_world = linear * glm::inverse(glm::dmat3(maps.lines->to_unit));
        const Box table = box_of_ball(table_to_world, linear * glm::dvec3(maps.lines->centre) + translation);
        instance.bounds = {glm::min(instance.bounds.low, table.low),
                           glm::max(instance.bounds.high, table.high)};
    }
}

void matrix_of(const Instance& instance, float* object_to_world) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            object_to_world[4 * column + row] =
                row < 3 ? instance.object_to_world[column][row] : static_cast<float>(column == 3);
}

Instance& find(dfield_scene* scene, dfield_instance id) {
    require(scene, "the scene is null");
    require(id < scene->state.instances.size() && scene->state.instances[id].field,
            "no instance of this id is in the scene");
    return scene->state.instances[id];
}

// Puts an id into the active ones or takes it out. Inserting may throw, before anything has changed.
void set_active(dfield_scene* scene, dfield_instance id, bool active) {
    auto& ids = scene->state.active;
    const auto at = std::lower_bound(ids.begin(), ids.end(), id);
    const bool was = at != ids.end() && *at == id;
    if (was == active) return;
    if (active)
        ids.insert(at, id);
    else
        ids.erase(at);
    scene->tree_stale = true;
}

std::uint64_t next_revision() {
    static std::atomic<std::uint64_t> last{0};
    return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

}  // namespace

SceneState::SceneState(const SceneState& other)
    : instances(other.instances, other.context_),
      active(other.active, other.context_),
      ground(other.ground),
      ground_revision(other.ground_revision),
      context_(other.context_) {
    for (const Instance& instance : instances)
        if (instance.field) instance.field->retain();
}

SceneState::~SceneState() {
    for (const Instance& instance : instances)
        if (instance.field) instance.field->release();
}

}  // namespace dfield::runtime

extern "C" {

dfield_status dfield_scene_create(dfield_context* context, dfield_scene** scene) {
    return dfield::runtime::guarded([&] {
        dfield::runtime::require(context && scene, "dfield_scene_create: context or scene is null");
        *scene = dfield_scene::make(context);
    });
}

void dfield_scene_release(dfield_scene* scene) {
    if (scene) scene->release();
}

dfield_status dfield_scene_add_instance(dfield_scene* scene, dfield_field* field,
                                        const float* object_to_world, dfield_instance* instance) {
    using namespace dfield::runtime;
    return guarded([&] {
        require(scene && field && instance, "dfield_scene_add_instance: scene, field or instance is null");
        Instance added;
        added.field = field;
        place(added, object_to_world);
        added.revision = next_revision();
        auto& instances = scene->state.instances;
        const auto slot = std::find_if(instances.begin(), instances.end(),
                                       [](const Instance& candidate) { return !candidate.field; });
        const auto id = static_cast<dfield_instance>(slot - instances.begin());
        if (slot == instances.end()) instances.emplace_back();  // a free slot, should the next line throw
        set_active(scene, id, true);
        instances[id] = added;
        field->retain();
        *instance = id;
    });
}

dfield_status dfield_scene_remove_instance(dfield_scene* scene, dfield_instance instance) {
    using namespace dfield::runtime;
    return guarded([&] {
        Instance& removed = find(scene, instance);
        set_active(scene, instance, false);
        removed.field->release();
        removed = Instance{};
    });
}

dfield_status dfield_scene_set_transform(dfield_scene* scene, dfield_instance instance,
                                         const float* object_to_world) {
    return dfield_scene_set_transforms(scene, 1, &instance, object_to_world, 0);
}

dfield_status dfield_scene_set_transforms(dfield_scene* scene, size_t count, const dfield_instance* instances,
                                          const float* object_to_world, size_t stride) {
    using namespace dfield::runtime;
    return guarded([&] {
        require(scene, "the scene is null");
        require(count == 0 || (instances && object_to_world), "the instances or the transforms are null");
        const Strided<const float> matrices(object_to_world, stride, 16);
        // All are tried before the first is kept.
        for (std::size_t i = 0; i < count && count > 1; ++i) {
            Instance moved = find(scene, instances[i]);
            place(moved, matrices.at(i));
        }
        for (std::size_t i = 0; i < count; ++i) {
            Instance moved = find(scene, instances[i]);
            place(moved, matrices.at(i));
            moved.revision = next_revision();
            scene->state.instances[instances[i]] = moved;
        }
    });
}

dfield_status dfield_scene_set_field(dfield_scene* scene, dfield_instance instance, dfield_field* field) {
    using namespace dfield::runtime;
    return guarded([&] {
        require(field, "dfield_scene_set_field: field is null");
        Instance& target = find(scene, instance);
        Instance changed = target;
        changed.field = field;
        float matrix[16];
        matrix_of(target, matrix);
        place(changed, matrix);
        changed.revision = next_revision();
        field->retain();
        target.field->release();
        target = changed;
    });
}

dfield_status dfield_scene_set_hidden(dfield_scene* scene, dfield_instance instance, int hidden) {
    using namespace dfield::runtime;
    return guarded([&] {
        Instance& target = find(scene, instance);
        if (target.hidden == (hidden != 0)) return;
        set_active(scene, instance, hidden == 0);
        target.hidden = hidden != 0;
        target.revision = next_revision();
    });
}

dfield_status dfield_scene_set_ground(dfield_scene* scene, const float* plane) {
    using namespace dfield::runtime;
    return guarded([&] {
        require(scene, "dfield_scene_set_ground: scene is null");
        std::optional<Plane> ground;
        if (plane) {
            const glm::vec3 normal(plane[0], plane[1], plane[2]);
            const float length = glm::length(normal);
            require(std::isfinite(length) && std::isfinite(plane[3]) && length > 0,
                    "dfield_scene_set_ground: the plane's normal is zero or not finite");
            ground = Plane{normal / length, plane[3] / length};
        }
        scene->state.ground = ground;
        scene->state.ground_revision = next_revision();
    });
}
}
