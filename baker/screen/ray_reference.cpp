#include "baker/screen/ray_reference.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "baker/error.hpp"
#include "baker/parallel.hpp"
#include "format/frame.hpp"
#include "format/hemisphere_map.hpp"

namespace dfield {
namespace {

// Well mixed bits of an index: Wellons' lowbias32.
std::uint32_t mixed(std::uint32_t x) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

double unit_of(std::uint32_t index) {
    return mixed(index + 0x9e3779b9u) * 0x1p-32;
}

}  // namespace

ScreenPoint world_point(const GBuffer& buffer, std::uint32_t pixel) {
    const CameraRay ray =
        camera_ray(buffer.camera, static_cast<float>(pixel % buffer.width) + 0.5f,
                   static_cast<float>(pixel / buffer.width) + 0.5f, buffer.width, buffer.height);
    const glm::vec3 seen = ray.origin + buffer.depth[pixel] * ray.direction;
    return {glm::vec3(buffer.camera.to_world * glm::vec4(seen, 1)),
            glm::normalize(glm::mat3(buffer.camera.to_world) * buffer.normals[pixel])};
}

RayReference trace_reference(const LitScene& scene, const GBuffer& buffer,
                             std::span<const std::uint32_t> pixels, const RayReferenceOptions& options) {
    const std::vector<glm::vec3> directions = cosine_directions(options.rays);
    const auto share = 1 / static_cast<double>(options.rays);
    const float reach = options.unbounded ? std::numeric_limits<float>::infinity()
                                          : static_cast<float>(options.measure.radius);
    RayReference reference;
    reference.visibility.assign(pixels.size(), 1.0f);
    if (options.indirect) reference.indirect.assign(pixels.size(), glm::vec3(0));
    if (options.unbounded) reference.sky.assign(pixels.size(), 1.0f);
    const auto trace = [&](std::size_t i) {
        if (!is_surface(buffer.depth[pixels[i]])) return;
        const ScreenPoint point = world_point(buffer, pixels[i]);
        const glm::vec3 origin = point.position + scene.lift() * point.normal;
        const Frame frame = frame_of_normal(point.normal);
        const double turn = glm::two_pi<double>() * unit_of(pixels[i]);
        const auto c = static_cast<float>(std::cos(turn)), s = static_cast<float>(std::sin(turn));
        double near = 0, far = 0;
        glm::dvec3 light(0);
        for (const glm::vec3& w : directions) {
            const glm::vec3 turned(c * w.x - s * w.y, s * w.x + c * w.y, w.z);
            const auto hit = scene.nearest(origin, frame.to_world(turned), 0, reach);
            if (!hit) continue;
            const double occluded = 1 - options.measure(static_cast<double>(hit->distance));
            near += occluded;
            far += 1;
            if (options.indirect && occluded > 0) light += occluded * glm::dvec3(scene.direct_light(*hit));
        }
        reference.visibility[i] = static_cast<float>(1 - near * share);
        if (options.unbounded) reference.sky[i] = static_cast<float>(1 - far * share);
        if (options.indirect) reference.indirect[i] = glm::vec3(light * share);
    };
    parallel_ranges(options.threads, pixels.size(), 64, [&](std::size_t begin, std::size_t end) {
        if (options.cancel && options.cancel->load(std::memory_order_relaxed))
            throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
        for (std::size_t i = begin; i < end; ++i) trace(i);
    });
    return reference;
}

std::vector<std::uint32_t> surface_pixels(const GBuffer& buffer, std::size_t count) {
    std::vector<std::uint32_t> all;
    for (std::size_t i = 0; i < buffer.pixels(); ++i)
        if (is_surface(buffer.depth[i])) all.push_back(static_cast<std::uint32_t>(i));
    if (all.size() <= count) return all;
    std::vector<std::uint32_t> some(count);
    const double step = static_cast<double>(all.size()) / static_cast<double>(count);
    for (std::size_t k = 0; k < count; ++k) {
        const double at = (static_cast<double>(k) + unit_of(static_cast<std::uint32_t>(k))) * step;
        some[k] = all[std::min(static_cast<std::size_t>(at), all.size() - 1)];
    }
    return some;
}

}  // namespace dfield
