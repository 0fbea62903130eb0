#include "baker/ray_visibility.hpp"

#include <array>

#include "baker/bounding_sphere.hpp"
#include "baker/error.hpp"
#include "baker/parallel.hpp"
#include "format/frame.hpp"
#include "format/hemisphere_map.hpp"

namespace dfield {
namespace {

constexpr std::size_t kPacket = 16;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float ground_distance(std::span<const float> plane, const glm::vec3& origin, const glm::vec3& direction) {
    if (plane.empty()) return kInfinity;
    const glm::vec3 normal(plane[0], plane[1], plane[2]);
    const float approach = glm::dot(normal, direction);
    if (!(approach < 0)) return kInfinity;
    return std::max(glm::dot(normal, origin) - plane[3], 0.0f) / -approach;
}

// Calls visit(r, cosine, occlusion) for the rays of a receiver in order; shared ones only where it faces
// them.
template<class Visit>
void trace_receiver(const EmbreeScene& scene, const glm::vec3& origin, const glm::vec3& normal,
                    const RayVisibilityOptions& options, const Visit& visit) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    const Frame frame = frame_of_normal(normal);
    const std::size_t count = options.directions.size();
    for (std::size_t next = 0; next < count;) {
        alignas(64) std::array<int, kPacket> valid{};
        alignas(64) RTCRayHit16 packet;
        std::array<std::size_t, kPacket> rays;
        std::size_t lanes = 0;
        for (; next < count && lanes < kPacket; ++next) {
            const glm::vec3& given = options.directions[next];
            if (options.shared && !(glm::dot(normal, given) > 0)) continue;
            set_ray(packet.ray, lanes, origin, options.shared ? given : frame.to_world(given),
                    options.near_distance, options.max_distance);
            clear_hit(packet.hit, lanes);
            valid[lanes] = -1;
            rays[lanes++] = next;
        }
        // Where Embree has no packets this wide it ignores `valid` and takes every ray whose interval is not
        // empty.
        for (std::size_t lane = lanes; lane < kPacket; ++lane) {
            set_ray(packet.ray, lane, origin, normal, 1, 0);
            clear_hit(packet.hit, lane);
        }
        if (options.occlusion)
            rtcIntersect16(valid.data(), scene.get(), &context, &packet);
        else
            rtcOccluded16(valid.data(), scene.get(), &context, &packet.ray);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const glm::vec3 direction(packet.ray.dir_x[lane], packet.ray.dir_y[lane], packet.ray.dir_z[lane]);
            const float ground = ground_distance(options.ground, origin, direction);
            float hit;
            if (options.occlusion) {
                const bool none = packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID;
                const float distance = std::min(ground, none ? kInfinity : packet.ray.tfar[lane]);
                hit = distance < kInfinity ? options.occlusion(options.occlusion_data, distance) : 0.0f;
            } else {  // a negative tfar is Embree's mark of an occluded ray
                const bool under = ground < kInfinity && ground <= options.max_distance;
                hit = packet.ray.tfar[lane] < 0 || under ? 1.0f : 0.0f;
            }
            visit(rays[lane], glm::dot(normal, direction), hit);
        }
    }
}

float receiver_visibility(const EmbreeScene& scene, const glm::vec3& origin, const glm::vec3& normal,
                          const RayVisibilityOptions& options) {
    const float even_weight = 1 / static_cast<float>(options.directions.size());
    double occlusion = 0, whole = 0;
    trace_receiver(scene, origin, normal, options, [&](std::size_t r, float cosine, float hit) {
        const float weight = options.shared            ? cosine
                             : options.weights.empty() ? even_weight
                                                       : options.weights[r];
        occlusion += hit * weight;
        whole += weight;
    });
    if (options.shared) occlusion = whole > 0 ? occlusion / whole : 0;
    return static_cast<float>(std::clamp(1 - occlusion, 0.0, 1.0));
}

// Calls receiver(i) for all receivers, on the options' threads.
template<class Receiver>
void for_receivers(std::size_t count, const RayVisibilityOptions& options, const Receiver& receiver) {
    parallel_ranges(options.threads, count, 64, [&](std::size_t begin, std::size_t end) {
        if (options.cancel && options.cancel->load(std::memory_order_relaxed))
            throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
        for (std::size_t i = begin; i < end; ++i) receiver(i);
    });
}

}  // namespace

std::vector<float> ray_visibility(const EmbreeScene& scene, std::span<const glm::vec3> positions,
                                  std::span<const glm::vec3> normals, const RayVisibilityOptions& options) {
    std::vector<float> visibility(positions.size());
    for_receivers(positions.size(), options, [&](std::size_t i) {
        visibility[i] = receiver_visibility(scene, positions[i], normals[i], options);
    });
    return visibility;
}

std::vector<std::uint32_t> ray_masks(const EmbreeScene& scene, std::span<const glm::vec3> positions,
                                     std::span<const glm::vec3> normals,
                                     const RayVisibilityOptions& options) {
    const std::size_t words = (options.directions.size() + 31) / 32;
    std::vector<std::uint32_t> masks(positions.size() * words);
    RayVisibilityOptions any_hit = options;
    any_hit.occlusion = nullptr;
    for_receivers(positions.size(), options, [&](std::size_t i) {
        trace_receiver(scene, positions[i], normals[i], any_hit, [&](std::size_t r, float, float hit) {
            if (hit > 0) masks[i * words + r / 32] |= 1u << (r % 32);
        });
    });
    return masks;
}

std::vector<glm::vec3> vertex_ray_origins(const TriangleMesh& mesh) {
    constexpr float kInset = 0.01f, kLift = 1e-4f;
    std::vector<glm::vec3> towards(mesh.positions.size(), glm::vec3(0));
    std::vector<float> triangles(mesh.positions.size(), 0.0f);
    for (const glm::uvec3& triangle : mesh.triangles) {
        const glm::vec3 middle =
            (mesh.positions[triangle.x] + mesh.positions[triangle.y] + mesh.positions[triangle.z]) / 3.0f;
        for (int corner = 0; corner < 3; ++corner) {
            towards[triangle[corner]] += middle;
            ++triangles[triangle[corner]];
        }
    }
    const float lift = mesh.triangles.empty() ? 0 : kLift * smallest_enclosing_ball(mesh).radius;
    for (std::size_t i = 0; i < towards.size(); ++i) {
        glm::vec3 inset =
            triangles[i] > 0 ? kInset * (towards[i] / triangles[i] - mesh.positions[i]) : glm::vec3(0);
        // The middle of the triangles around a convex vertex lies inside the object.
        inset -= std::min(glm::dot(inset, mesh.normals[i]), 0.0f) * mesh.normals[i];
        towards[i] = mesh.positions[i] + inset + lift * mesh.normals[i];
    }
    return towards;
}

std::vector<float> self_visibility(const TriangleMesh& mesh, std::uint32_t rays, int threads,
                                   const std::atomic<bool>* cancel) {
    TriangleMesh with_normals;
    const TriangleMesh* source = &mesh;
    if (mesh.normals.size() != mesh.positions.size()) {
        with_normals = mesh;
        compute_normals(with_normals);
        source = &with_normals;
    }
    EmbreeScene scene(EmbreeUse::kBake);  // the result is part of a payload
    scene.add_mesh(mesh);
    scene.commit(threads);
    const std::vector<glm::vec3> directions = cosine_directions(rays);
    RayVisibilityOptions options;
    options.directions = directions;
    options.threads = threads;
    options.cancel = cancel;
    return ray_visibility(scene, vertex_ray_origins(*source), source->normals, options);
}

}  // namespace dfield
