#include "bench/kinds/distance_field.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "baker/embree_scene.hpp"
#include "baker/mesh_distance.hpp"
#include "baker/parallel.hpp"
#include "format/hemisphere_map.hpp"

namespace dfield::kinds {
namespace {

constexpr std::uint32_t kVotes = 32;
constexpr float kRange = 0.2f;      // of the longest side: what lies farther is as far as this
constexpr float kLeastStep = 0.5f;  // of a voxel
constexpr float kSurface = 0.08f;   // of a voxel: how near a signed field's ray must come
constexpr float kThick = 0.5f;
constexpr float kThickness = 0.3f;  // of a voxel: the same without a sign

bool is_inside(const EmbreeScene& scene, const glm::vec3& point, const std::vector<glm::vec3>& directions) {
    std::size_t backs = 0;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (const glm::vec3& d : directions) {
        RTCRayHit query{};
        query.ray = {point.x, point.y, point.z, 0, d.x, d.y, d.z, 0, std::numeric_limits<float>::infinity(),
                     ~0u,     0,       0};
        query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene.get(), &context, &query);
        backs += query.hit.geomID != RTC_INVALID_GEOMETRY_ID &&
                 glm::dot(glm::vec3(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z), d) > 0;
    }
    return 2 * backs > directions.size();
}

}  // namespace

DistanceField::DistanceField(const TriangleMesh& mesh, const DistanceFieldParameters& parameters)
    : size_(parameters.size), inside_(parameters.inside) {
    const Bounds box = triangle_bounds(mesh);
    // Flat boxes get the voxels of the longest side across.
    const glm::vec3 extent = box.size();
    const float longest = std::max({extent.x, extent.y, extent.z});
    const auto cells = static_cast<float>(size_ - 3);
    spacing_ = glm::max(extent, glm::vec3(0.05f * longest)) / cells;
    origin_ = box.centre() - 0.5f * static_cast<float>(size_ - 1) * spacing_;
    range_ = kRange * longest;

    EmbreeScene scene(EmbreeUse::kFast);
    scene.add_mesh(mesh);
    scene.commit();
    const std::vector<glm::vec3> directions = fibonacci_sphere(kVotes);
    const std::size_t count = std::size_t{size_} * size_ * size_;
    nodes_.assign(count + 4, 0);
    parallel_ranges(0, count, 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const glm::vec3 node(i % size_, i / size_ % size_, i / size_ / size_);
            const glm::vec3 point = origin_ + node * spacing_;
            float distance = nearest_point(scene, mesh, point, range_).distance;
            if (inside_ == Inside::kVotes && is_inside(scene, point, directions)) distance = -distance;
            nodes_[i] = static_cast<std::uint8_t>(std::lround((distance / range_ * 0.5f + 0.5f) * 255));
        }
    });
}

float DistanceField::voxel_edge() const {
    return std::max({spacing_.x, spacing_.y, spacing_.z});
}

DistanceField::View DistanceField::view() const {
    const float voxel = voxel_edge();
    return {nodes_.data(),
            static_cast<std::int32_t>(size_),
            origin_,
            1.0f / spacing_,
            2 * range_ / 255,
            -range_,
            voxel * (inside_ == Inside::kVotes     ? kSurface
                     : inside_ == Inside::kNowhere ? kThickness
                                                   : kThick),
            voxel * kLeastStep};
}

}  // namespace dfield::kinds
