#include "scene.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "status.hpp"

namespace dfield::runtime {
namespace {

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
}

Instance& find(dfield_scene* scene, dfield_instance id) {
    require(scene, "the scene is null");
    require(id < scene->instances.size() && scene->instances[id].field,
            "no instance of this id is in the scene");
    return scene->instances[id];
}

}  // namespace
}  // namespace dfield::runtime

dfield_scene::~dfield_scene() {
    for (const dfield_instance id : active) instances[id].field->release();
}

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
        const auto slot = std::find_if(scene->instances.begin(), scene->instances.end(),
                                       [](const Instance& candidate) { return !candidate.field; });
        const auto id = static_cast<dfield_instance>(slot - scene->instances.begin());
        scene->active.reserve(scene->active.size() + 1);
        if (slot == scene->instances.end())
            scene->instances.push_back(added);
        else
            *slot = added;
        scene->active.insert(std::lower_bound(scene->active.begin(), scene->active.end(), id), id);
        field->retain();
        *instance = id;
    });
}

dfield_status dfield_scene_set_transform(dfield_scene* scene, dfield_instance instance,
                                         const float* object_to_world) {
    using namespace dfield::runtime;
    return guarded([&] {
        Instance& target = find(scene, instance);
        Instance moved = target;
        place(moved, object_to_world);
        target = moved;
    });
}

dfield_status dfield_scene_remove_instance(dfield_scene* scene, dfield_instance instance) {
    using namespace dfield::runtime;
    return guarded([&] {
        Instance& removed = find(scene, instance);
        removed.field->release();
        removed = Instance{};
        scene->active.erase(std::lower_bound(scene->active.begin(), scene->active.end(), instance));
    });
}

dfield_status dfield_scene_set_ground(dfield_scene* scene, const float* plane) {
    using namespace dfield::runtime;
    return guarded([&] {
        require(scene, "dfield_scene_set_ground: scene is null");
        if (!plane) {
            scene->ground.reset();
            return;
        }
        const glm::vec3 normal(plane[0], plane[1], plane[2]);
        const float length = glm::length(normal);
        require(std::isfinite(length) && std::isfinite(plane[3]) && length > 0,
                "dfield_scene_set_ground: the plane's normal is zero or not finite");
        scene->ground = Plane{normal / length, plane[3] / length};
    });
}
}
