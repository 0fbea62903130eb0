// Batches of rays.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "any_hit_batch.hpp"
#include "lookup.hpp"
#include "scene.hpp"
#include "status.hpp"
#include "strided.hpp"

namespace dfield::runtime {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Ray {
    glm::vec3 origin, direction;
    float max_distance;
};

struct RayReader {
    explicit RayReader(const dfield_rays& rays)
        : origins(rays.origins, rays.origin_stride, 3),
          directions(rays.directions, rays.direction_stride, 3),
          max_distances(rays.max_distances, rays.max_distance_stride, 1) {}

    Ray operator[](std::size_t i) const {
        return {origins.vec3(i), directions.vec3(i), max_distances ? max_distances.at(i)[0] : kInfinity};
    }

    Strided<const float> origins, directions, max_distances;
};

bool usable(const Ray& ray) {
    const float square = glm::dot(ray.direction, ray.direction);
    return finite(ray.origin) && std::isfinite(square) && square > 0;
}

float ground_hit(const dfield_scene& scene, const Ray& ray) {
    if (!scene.ground) return kInfinity;
    const float approach = glm::dot(scene.ground->normal, ray.direction);
    if (!(approach < 0)) return kInfinity;
    const float height = glm::dot(scene.ground->normal, ray.origin) - scene.ground->distance;
    return std::max(height, 0.0f) / -approach;
}

// The chord of a ray in an instance's sphere; false where the ray cannot hit the object.
bool chord_of_ray(const Instance& instance, const Ray& ray, Chord& chord) {
    const glm::vec3 origin = instance.carry_point(ray.origin),
                    direction = instance.carry_direction(ray.direction);
    return !instance.leaving_box(origin).leaves(direction.x, direction.y, direction.z) &&
           chord_of_line(origin, direction, chord);
}

float instance_hit(const Instance& instance, const Ray& ray) {
    Chord chord;
    if (!chord_of_ray(instance, ray, chord)) return kInfinity;
    return with_bits(*instance.field, [&]<int kBits>() { return first_hit<kBits>(*instance.field, chord); });
}

struct NearestHit {
    float distance = kInfinity;
    dfield_instance instance = DFIELD_NO_INSTANCE;
};

NearestHit nearest(const dfield_scene& scene, const Ray& ray) {
    NearestHit best;
    if (!usable(ray)) return best;
    best.distance = ground_hit(scene, ray);
    for (const dfield_instance id : scene.active) {
        const float t = instance_hit(scene.instances[id], ray);
        if (t < best.distance) best = {t, id};
    }
    return best.distance <= ray.max_distance ? best : NearestHit{};
}

// Rays [begin, end), at most a batch, instance by instance. Rays that one instance blocks are not asked
// again.
void occluded_block(const dfield_scene& scene, const RayReader& reader, std::size_t begin, std::size_t end,
                    std::uint8_t* result) {
    std::array<bool, AnyHitBatch::kCapacity> open;  // usable, and not blocked so far
    for (std::size_t i = begin; i < end; ++i) {
        const Ray ray = reader[i];
        const bool use = usable(ray);
        const float ground = use ? ground_hit(scene, ray) : kInfinity;
        result[i] = ground < kInfinity && ground <= ray.max_distance;
        open[i - begin] = use && !result[i];
    }
    AnyHitBatch batch;
    for (const dfield_instance id : scene.active) {
        const Instance& instance = scene.instances[id];
        const auto block = [&](std::size_t k) {
            result[begin + k] = 1;
            open[k] = false;
        };
        with_bits(*instance.field, [&]<int kBits>() {
            for (std::size_t k = 0; k < end - begin; ++k) {
                Chord chord;
                if (!open[k]) continue;
                const Ray ray = reader[begin + k];
                if (!chord_of_ray(instance, ray, chord)) continue;
                if (ray.max_distance == kInfinity)
                    batch.add(chord, static_cast<std::uint16_t>(k), 0, false);
                else if (first_hit<kBits>(*instance.field, chord) <= ray.max_distance)
                    block(k);
            }
            batch.look_up<kBits>(*instance.field, block);
        });
    }
}

void require_rays(const dfield_scene* scene, const dfield_rays* rays, const void* output) {
    require(scene && rays && output, "scene, rays or the output is null");
    require(rays->count == 0 || (rays->origins && rays->directions),
            "the rays' origins or directions are null");
}

}  // namespace
}  // namespace dfield::runtime

extern "C" {

dfield_status dfield_scene_trace(const dfield_scene* scene, const dfield_rays* rays,
                                 const dfield_hits* hits) {
    using namespace dfield::runtime;
    return guarded([&] {
        require(hits, "dfield_scene_trace: hits is null");
        require_rays(scene, rays, hits->distances);
        const RayReader reader(*rays);
        const Strided<float> distances(hits->distances, hits->distance_stride, 1);
        const Strided<dfield_instance> instances(hits->instances, hits->instance_stride, 1);
        scene->context()->for_ranges(rays->count, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const NearestHit hit = nearest(*scene, reader[i]);
                *distances.at(i) = hit.distance;
                if (instances) *instances.at(i) = hit.instance;
            }
        });
    });
}

dfield_status dfield_scene_occluded(const dfield_scene* scene, const dfield_rays* rays, uint8_t* result) {
    using namespace dfield::runtime;
    return guarded([&] {
        require_rays(scene, rays, result);
        const RayReader reader(*rays);
        scene->context()->for_ranges(rays->count, [&](std::size_t begin, std::size_t end) {
            for (std::size_t first = begin; first < end; first += AnyHitBatch::kCapacity)
                occluded_block(*scene, reader, first, std::min(first + AnyHitBatch::kCapacity, end), result);
        });
    });
}
}
