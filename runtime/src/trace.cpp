// Batches of rays.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kind.hpp"
#include "rays/kernels.hpp"
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

float ground_hit(const SceneState& scene, const Ray& ray) {
    if (!scene.ground) return kInfinity;
    const float approach = glm::dot(scene.ground->normal, ray.direction);
    if (!(approach < 0)) return kInfinity;
    const float height = glm::dot(scene.ground->normal, ray.origin) - scene.ground->distance;
    return std::max(height, 0.0f) / -approach;
}

// Rays of a batch, an array a component as kernels want them. Unusable ones have no place: nothing can hit
// them.
class BlockOfRays {
  public:
    BlockOfRays(const SceneState& scene, const RayReader& reader, std::size_t begin, std::size_t count)
        : count_(count) {
        for (std::size_t i = 0; i < count; ++i) {
            const Ray ray = reader[begin + i];
            const bool use = usable(ray);
            for (int axis = 0; axis < 3; ++axis) {
                numbers_[axis][i] = use ? ray.origin[axis] : std::numeric_limits<float>::quiet_NaN();
                numbers_[3 + axis][i] = use ? ray.direction[axis] : 1.0f;
            }
            ground_[i] = use ? ground_hit(scene, ray) : kInfinity;
            max_distance_[i] = ray.max_distance;
            bounded_ |= use && ray.max_distance != kInfinity;
        }
    }
    RayBlock view() const {
        return {numbers_[0].data(),
                numbers_[1].data(),
                numbers_[2].data(),
                numbers_[3].data(),
                numbers_[4].data(),
                numbers_[5].data(),
                count_};
    }
    std::size_t size() const { return count_; }
    float ground(std::size_t i) const { return ground_[i]; }
    float max_distance(std::size_t i) const { return max_distance_[i]; }
    bool bounded() const { return bounded_; }

  private:
    std::array<std::array<float, kRayBlock + kRayPadding>, 6> numbers_{};
    std::array<float, kRayBlock> ground_, max_distance_;
    std::size_t count_;
    bool bounded_ = false;
};

// What answers single rays: the maps, or where a field has none the line table.
const RayKernels& kernels_for(const RayLookups& lookups, const dfield_field& field) {
    return has_kind(field, DFIELD_KIND_MAPS) ? lookups.maps : lookups.lines;
}

struct NearestHits {
    std::array<float, kRayBlock> distance;
    std::array<dfield_instance, kRayBlock> instance;
};

// Whatever the rays' maximal distances are.
void find_nearest(const SceneState& scene, const RayLookups& lookups, const BlockOfRays& rays,
                  NearestHits& hits) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
        hits.distance[i] = rays.ground(i);
        hits.instance[i] = DFIELD_NO_INSTANCE;
    }
    for (const dfield_instance id : scene.active) {
        const Instance& instance = scene.instances[id];
        std::array<float, kRayBlock> before = hits.distance;
        kernels_for(lookups, *instance.field).ray_distances(instance, rays.view(), hits.distance.data());
        for (std::size_t i = 0; i < rays.size(); ++i)
            if (hits.distance[i] < before[i]) hits.instance[i] = id;
    }
}

void find_occluded(const SceneState& scene, const RayLookups& lookups, const BlockOfRays& rays,
                   std::uint8_t* result) {
    if (rays.bounded()) {
        NearestHits hits;
        find_nearest(scene, lookups, rays, hits);
        for (std::size_t i = 0; i < rays.size(); ++i)
            result[i] = hits.distance[i] < kInfinity && hits.distance[i] <= rays.max_distance(i);
        return;
    }
    RayBits open = first_bits(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i)
        if (rays.ground(i) < kInfinity) clear_bit(open, i);
    for (const dfield_instance id : scene.active) {
        const Instance& instance = scene.instances[id];
        kernels_for(lookups, *instance.field).ray_any_hits(instance, rays.view(), open);
    }
    for (std::size_t i = 0; i < rays.size(); ++i) result[i] = !has_bit(open, i);
}

void require_rays(const dfield_scene* scene, const dfield_rays* rays, const void* output) {
    require(scene && rays && output, "scene, rays or the output is null");
    require(rays->count == 0 || (rays->origins && rays->directions),
            "the rays' origins or directions are null");
    for (const dfield_instance id : scene->state.active) {
        const dfield_field& field = *scene->state.instances[id].field;
        require(has_kind(field, DFIELD_KIND_MAPS) || has_kind(field, DFIELD_KIND_LINES),
                "an instance's field has neither displacement maps nor a line table: direction maps and "
                "occlusion "
                "volumes know no single rays");
    }
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
        const RayLookups& lookups = ray_lookups(scene->state.context()->simd_targets);
        scene->state.context()->for_ranges(rays->count, [&](std::size_t begin, std::size_t end) {
            for (std::size_t first = begin; first < end; first += kRayBlock) {
                const BlockOfRays block(scene->state, reader, first, std::min(kRayBlock, end - first));
                NearestHits nearest;
                find_nearest(scene->state, lookups, block, nearest);
                for (std::size_t i = 0; i < block.size(); ++i) {
                    const bool hit = nearest.distance[i] <= block.max_distance(i);
                    *distances.at(first + i) = hit ? nearest.distance[i] : kInfinity;
                    if (instances) *instances.at(first + i) = hit ? nearest.instance[i] : DFIELD_NO_INSTANCE;
                }
            }
        });
    });
}

dfield_status dfield_scene_occluded(const dfield_scene* scene, const dfield_rays* rays, uint8_t* result) {
    using namespace dfield::runtime;
    return guarded([&] {
        require_rays(scene, rays, result);
        const RayReader reader(*rays);
        const RayLookups& lookups = ray_lookups(scene->state.context()->simd_targets);
        scene->state.context()->for_ranges(rays->count, [&](std::size_t begin, std::size_t end) {
            for (std::size_t first = begin; first < end; first += kRayBlock) {
                const BlockOfRays block(scene->state, reader, first, std::min(kRayBlock, end - first));
                find_occluded(scene->state, lookups, block, result + first);
            }
        });
    });
}
}
