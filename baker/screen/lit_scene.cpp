#include "baker/screen/lit_scene.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "baker/error.hpp"
#include "baker/parallel.hpp"

namespace dfield {
namespace {

// With several, which of two equally near triangles is hit would depend on timing.
constexpr int kBuildThreads = 1;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

void grow(Bounds& bounds, bool& first, const glm::vec3& point) {
    bounds.min = first ? point : glm::min(bounds.min, point);
    bounds.max = first ? point : glm::max(bounds.max, point);
    first = false;
}

}  // namespace

LitScene::LitScene(const ImportedScene& scene) : scene_(scene) {
    meshes_.resize(scene.meshes.size());
    bool first = true;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const SceneInstance& instance = scene.instances[i];
        const TriangleMesh& mesh = scene.meshes[instance.mesh].mesh;
        const glm::mat3 to_object = glm::inverse(glm::mat3(instance.transform));
        // Flat nodes (glTF hides by a scale of 0) have nothing to show.
        if (mesh.triangles.empty() || !std::isfinite(glm::determinant(to_object))) continue;
        auto& object = meshes_[instance.mesh];
        if (!object) {
            object = std::make_unique<EmbreeScene>(EmbreeUse::kBake);
            object->add_mesh(mesh);
            object->commit(kBuildThreads);
        }
        whole_.add_instance(*object, instance.transform);
        drawn_.push_back(static_cast<std::uint32_t>(i));
        normals_to_world_.push_back(glm::transpose(to_object));
        for (const glm::uvec3& triangle : mesh.triangles)
            for (int corner = 0; corner < 3; ++corner)
                grow(bounds_, first,
                     glm::vec3(instance.transform * glm::vec4(mesh.positions[triangle[corner]], 1)));
    }
    if (drawn_.empty()) throw InputError("the scene has no usable triangle");
    whole_.commit(kBuildThreads);
}

float LitScene::longest_side() const {
    const glm::vec3 size = bounds_.size();
    return std::max({size.x, size.y, size.z});
}

std::optional<SurfaceHit> LitScene::nearest(const glm::vec3& origin, const glm::vec3& direction, float near,
                                            float far) const {
    RTCRayHit query{};
    query.ray.org_x = origin.x, query.ray.org_y = origin.y, query.ray.org_z = origin.z;
    query.ray.dir_x = direction.x, query.ray.dir_y = direction.y, query.ray.dir_z = direction.z;
    query.ray.tnear = near;
    query.ray.tfar = far;
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect1(whole_.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

    const std::uint32_t drawn = query.hit.instID[0];
    const SceneInstance& instance = scene_.instances[drawn_[drawn]];
    const SceneMesh& source = scene_.meshes[instance.mesh];
    const TriangleMesh& mesh = source.mesh;
    const glm::uvec3 triangle = mesh.triangles[query.hit.primID];
    const auto interpolate = [&](const std::vector<glm::vec3>& values) {
        return (1 - query.hit.u - query.hit.v) * values[triangle.x] + query.hit.u * values[triangle.y] +
               query.hit.v * values[triangle.z];
    };
    const glm::vec3& corner = mesh.positions[triangle.x];
    glm::vec3 facet = glm::cross(mesh.positions[triangle.y] - corner, mesh.positions[triangle.z] - corner);
    glm::vec3 normal = interpolate(mesh.normals);
    if (!(glm::dot(normal, normal) > 1e-12f)) normal = facet;
    facet = normals_to_world_[drawn] * facet;
    normal = normals_to_world_[drawn] * normal;
    if (glm::dot(facet, direction) > 0) facet = -facet;
    if (glm::dot(normal, facet) < 0) normal = -normal;
    normal = glm::normalize(normal);
    // An interpolated normal may turn away from the eye at silhouettes: a surface that is seen faces it.
    const glm::vec3 view = glm::normalize(direction);
    const float away = glm::dot(normal, view);
    if (away > 0) normal = glm::normalize(normal - 1.001f * away * view);
    return SurfaceHit{query.ray.tfar, origin + query.ray.tfar * direction, normal,
                      source.albedo.empty() ? glm::vec3(kAlbedo) : interpolate(source.albedo), drawn_[drawn]};
}

glm::vec3 LitScene::direct_light(const SurfaceHit& hit) const {
    const glm::vec3 towards = glm::normalize(sun_.direction);
    const float cosine = glm::dot(hit.normal, towards);
    if (!(cosine > 0)) return glm::vec3(0);
    const glm::vec3 origin = hit.position + 10 * lift() * hit.normal;
    RTCRay ray{};
    ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
    ray.dir_x = towards.x, ray.dir_y = towards.y, ray.dir_z = towards.z;
    ray.tfar = kInfinity;
    ray.mask = ~0u;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(whole_.get(), &context, &ray);
    return ray.tfar < 0 ? glm::vec3(0) : cosine * hit.albedo * sun_.colour;
}

GBuffer trace_gbuffer(const LitScene& scene, const ScreenCamera& camera, std::uint32_t width,
                      std::uint32_t height, const glm::vec3& background, int threads,
                      std::vector<std::uint32_t>* instances, const std::atomic<bool>* cancel) {
    GBuffer buffer;
    buffer.width = width;
    buffer.height = height;
    buffer.camera = camera;
    buffer.depth.assign(buffer.pixels(), kInfinity);
    buffer.normals.assign(buffer.pixels(), glm::vec3(0));
    buffer.albedo = buffer.normals;
    buffer.radiance.assign(buffer.pixels(), background);
    if (instances) instances->assign(buffer.pixels(), ~0u);
    const glm::mat3 turn(camera.to_world), back = glm::transpose(turn);
    parallel_ranges(threads, height, 4, [&](std::size_t begin, std::size_t end) {
        if (cancel && cancel->load(std::memory_order_relaxed))
            throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
        for (std::size_t y = begin; y < end; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const CameraRay ray = camera_ray(camera, static_cast<float>(x) + 0.5f,
                                                 static_cast<float>(y) + 0.5f, width, height);
                const glm::vec3 origin(camera.to_world * glm::vec4(ray.origin, 1));
                const auto hit =
                    scene.nearest(origin, turn * ray.direction, std::min(camera.near, camera.far),
                                  std::max(camera.near, camera.far));
                if (!hit || !(hit->distance > 0)) continue;
                const std::size_t pixel = y * width + x;
                buffer.depth[pixel] = hit->distance;
                buffer.normals[pixel] = back * hit->normal;
                buffer.albedo[pixel] = hit->albedo;
                buffer.radiance[pixel] = scene.direct_light(*hit);
                if (instances) (*instances)[pixel] = hit->instance;
            }
    });
    return buffer;
}

}  // namespace dfield
