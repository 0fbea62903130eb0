#include "bench/kinds/distance_field.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "baker/embree_scene.hpp"
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

// Ericson, "Real-Time Collision Detection", 5.1.5.
glm::vec3 closest_point(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 ab = b - a, ac = c - a, ap = p - a;
    const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const glm::vec3 bp = p - b;
    const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    const glm::vec3 cp = p - c;
    const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    const float all = 1 / (va + vb + vc);
    return a + vb * all * ab + vc * all * ac;
}

struct Closest {
    const TriangleMesh* mesh;
    float distance;
};

bool visit_triangle(RTCPointQueryFunctionArguments* arguments) {
    auto& closest = *static_cast<Closest*>(arguments->userPtr);
    const glm::uvec3& t = closest.mesh->triangles[arguments->primID];
    const auto& positions = closest.mesh->positions;
    const glm::vec3 point(arguments->query->x, arguments->query->y, arguments->query->z);
    const float distance =
        glm::distance(point, closest_point(point, positions[t.x], positions[t.y], positions[t.z]));
    if (distance >= closest.distance) return false;
    closest.distance = arguments->query->radius = distance;
    return true;
}

float distance_to(const EmbreeScene& scene, const TriangleMesh& mesh, const glm::vec3& point, float range) {
    Closest closest{&mesh, range};
    RTCPointQuery query{point.x, point.y, point.z, 0, range};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene.get(), &query, &context, visit_triangle, &closest);
    return closest.distance;
}

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
            float distance = distance_to(scene, mesh, point, range_);
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
