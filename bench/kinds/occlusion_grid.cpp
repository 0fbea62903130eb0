#include "bench/kinds/occlusion_grid.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <limits>

#include "baker/embree_scene.hpp"
#include "baker/parallel.hpp"
#include "format/hemisphere_map.hpp"

namespace dfield::kinds {
namespace {

constexpr std::size_t kPacket = 16;

// The cosine-weighted share of the hemisphere that a cap hides, for all caps: by summing up directions.
std::vector<float> cap_table() {
    constexpr std::uint32_t kDirections = 8192;
    const std::vector<glm::vec3> directions = fibonacci_sphere(kDirections);
    std::vector<float> table(std::size_t{OcclusionGrid::kCapSizes} * OcclusionGrid::kCapCosines);
    std::vector<std::pair<float, float>> by_angle(kDirections);  // cosine to the cap's middle, weight
    for (std::int32_t c = 0; c < OcclusionGrid::kCapCosines; ++c) {
        const float cosine = 2 * static_cast<float>(c) / (OcclusionGrid::kCapCosines - 1) - 1;
        const glm::vec3 middle(std::sqrt(std::max(0.0f, 1 - cosine * cosine)), 0, cosine);
        for (std::uint32_t i = 0; i < kDirections; ++i)
            by_angle[i] = {glm::dot(middle, directions[i]),
                           4 * std::max(0.0f, directions[i].z) / kDirections};
        std::sort(by_angle.begin(), by_angle.end(), std::greater<>());
        auto at = by_angle.begin();
        double hidden = 0;
        for (std::int32_t s = 0; s < OcclusionGrid::kCapSizes; ++s) {
            const float half_sine = static_cast<float>(s) / (OcclusionGrid::kCapSizes - 1);
            const float rim = 1 - 2 * half_sine * half_sine;  // cosine of the opening angle
            for (; at != by_angle.end() && at->first > rim; ++at) hidden += at->second;
            table[static_cast<std::size_t>(c * OcclusionGrid::kCapSizes + s)] =
                static_cast<float>(std::min(1.0, hidden));
        }
    }
    return table;
}

std::uint32_t packed(const glm::vec3& sum, std::size_t hits, std::size_t rays) {
    const float length = glm::length(sum);
    const glm::vec3 middle = length > 0 ? sum / length : glm::vec3(0);
    std::uint32_t result = 0;
    for (int axis = 0; axis < 3; ++axis)
        result |= static_cast<std::uint32_t>(std::lround(middle[axis] * 127) + 128) << 8 * axis;
    // A cap of opening angle a has the solid angle 4 pi sin^2(a / 2).
    const float half_sine = std::sqrt(static_cast<float>(hits) / static_cast<float>(rays));
    return result | static_cast<std::uint32_t>(std::lround(half_sine * 255)) << 24;
}

std::uint32_t cast_node(const EmbreeScene& scene, const glm::vec3& point,
                        const std::vector<glm::vec3>& directions) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    glm::vec3 sum(0);
    std::size_t hits = 0;
    alignas(64) int valid[kPacket];
    for (std::size_t first = 0; first < directions.size(); first += kPacket) {
        RTCRay16 rays;
        const std::size_t count = std::min(kPacket, directions.size() - first);
        for (std::size_t i = 0; i < kPacket; ++i) {
            valid[i] = i < count ? -1 : 0;
            set_ray(rays, i, point, directions[first + std::min(i, count - 1)], 0,
                    std::numeric_limits<float>::infinity());
        }
        rtcOccluded16(valid, scene.get(), &context, &rays);
        for (std::size_t i = 0; i < count; ++i)
            if (rays.tfar[i] < 0) sum += directions[first + i], ++hits;
    }
    return packed(sum, hits, directions.size());
}

}  // namespace

OcclusionGrid::OcclusionGrid(const TriangleMesh& mesh, const OcclusionGridParameters& parameters)
    : size_(parameters.size) {
    const Bounds box = triangle_bounds(mesh);
    const glm::vec3 extent = box.size();
    const float margin = parameters.margin * std::max({extent.x, extent.y, extent.z});
    middle_ = box.centre();
    origin_ = box.min - glm::vec3(margin);
    spacing_ = (extent + 2 * margin) / static_cast<float>(size_ - 1);

    EmbreeScene scene(EmbreeUse::kFast);
    scene.add_mesh(mesh);
    scene.commit();
    const std::vector<glm::vec3> directions = fibonacci_sphere(parameters.rays);
    nodes_.resize(std::size_t{size_} * size_ * size_);
    parallel_ranges(0, nodes_.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const glm::vec3 node(i % size_, i / size_ % size_, i / size_ / size_);
            nodes_[i] = cast_node(scene, origin_ + node * spacing_, directions);
        }
    });
}

OcclusionGrid::View OcclusionGrid::view() const {
    static const std::vector<float> table = cap_table();
    return {nodes_.data(), static_cast<std::int32_t>(size_), origin_, 1.0f / spacing_, middle_, table.data()};
}

}  // namespace dfield::kinds
