#include "baker/mesh_distance.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "baker/error.hpp"
#include "baker/exact_distance.hpp"
#include "baker/parallel.hpp"

namespace dfield {
namespace {

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

struct Search {
    const TriangleMesh* mesh;
    NearestPoint nearest;
};

bool visit_triangle(RTCPointQueryFunctionArguments* arguments) {
    auto& search = *static_cast<Search*>(arguments->userPtr);
    const glm::uvec3& t = search.mesh->triangles[arguments->primID];
    const auto& positions = search.mesh->positions;
    const glm::vec3 point(arguments->query->x, arguments->query->y, arguments->query->z);
    const glm::vec3 on_mesh = closest_point(point, positions[t.x], positions[t.y], positions[t.z]);
    const float distance = glm::distance(point, on_mesh);
    if (!(distance < search.nearest.distance)) return false;
    search.nearest = {on_mesh, distance};
    arguments->query->radius = distance;
    return true;
}

// Every surface on a line. Embree may report a triangle twice, which spatial splits have put into two leaves.
struct Crossing {
    float at;
    int step;  // 1 entered, -1 left
    std::uint32_t triangle;
};
struct LineContext {
    RTCIntersectContext base;
    std::vector<Crossing>* crossings;
};

void collect(const RTCFilterFunctionNArguments* arguments) {
    // Single rays.
    const auto* ray = reinterpret_cast<const RTCRay*>(arguments->ray);
    const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
    const float facing = ray->dir_x * hit->Ng_x + ray->dir_y * hit->Ng_y + ray->dir_z * hit->Ng_z;
    reinterpret_cast<LineContext*>(arguments->context)
        ->crossings->push_back({ray->tfar, facing < 0 ? 1 : -1, hit->primID});
    arguments->valid[0] = 0;  // on to the next
}

// Calls hold(k) for the samples k of [0, count) on a line that lie inside; sample k is at distance k *
// spacing
// + start from the line's origin.
template<class Hold>
void for_inside(const EmbreeScene& scene, const TriangleMesh& mesh, const glm::vec3& origin, int axis,
                float start, float spacing, std::uint32_t count, std::vector<Crossing>& crossings,
                const Hold& hold) {
    LineContext context{};
    rtcInitIntersectContext(&context.base);
    context.base.filter = collect;
    context.crossings = &crossings;
    crossings.clear();
    glm::vec3 direction(0);
    direction[axis] = 1;
    RTCRayHit query{};
    query.ray = {origin.x,    origin.y,    origin.z,
                 0,           direction.x, direction.y,
                 direction.z, 0,           std::numeric_limits<float>::infinity(),
                 ~0u,         0,           0};
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene.get(), &context.base, &query);

    for (Crossing& crossing : crossings) {
        const double exact = exact_distance(mesh, crossing.triangle, origin, direction);
        if (std::isfinite(exact)) crossing.at = static_cast<float>(exact);
    }
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
        return std::tie(a.at, a.step, a.triangle) < std::tie(b.at, b.step, b.triangle);
    });
    // One triangle is crossed once, and so is the edge between two, or a triangle that is there twice.
    const float together = 1e-5f * spacing;
    crossings.erase(std::unique(crossings.begin(), crossings.end(),
                                [&](const Crossing& a, const Crossing& b) {
                                    return a.step == b.step && b.at - a.at <= together;
                                }),
                    crossings.end());
    int depth = 0;
    for (const Crossing& crossing : crossings) depth += crossing.step;
    if (depth != 0) return;
    auto next = crossings.begin();
    for (std::uint32_t k = 0; k < count; ++k) {
        const float at = start + spacing * static_cast<float>(k);
        for (; next != crossings.end() && next->at <= at; ++next) depth += next->step;
        if (depth != 0) hold(k);
    }
}

}  // namespace

NearestPoint nearest_point(const EmbreeScene& scene, const TriangleMesh& mesh, const glm::vec3& point,
                           float range) {
    Search search{&mesh, {point, range}};
    RTCPointQuery query{point.x, point.y, point.z, 0, range};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene.get(), &query, &context, visit_triangle, &search);
    return search.nearest;
}

std::vector<std::uint8_t> samples_inside(const EmbreeScene& scene, const TriangleMesh& mesh,
                                         const SampleGrid& grid, int threads,
                                         const std::atomic<bool>* cancel) {
    const Bounds box = triangle_bounds(mesh);
    std::vector<std::uint8_t> lines(grid.size());  // along which a sample is inside
    const std::size_t strides[3] = {1, grid.dims[0], std::size_t{grid.dims[0]} * grid.dims[1]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        const int along = static_cast<int>(axis);
        const std::size_t count = std::size_t{grid.dims[u]} * grid.dims[v];
        parallel_ranges(threads, count, 16, [&](std::size_t begin, std::size_t end) {
            if (cancel && cancel->load(std::memory_order_relaxed))
                throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
            std::vector<Crossing> crossings;
            for (std::size_t line = begin; line < end; ++line) {
                const std::size_t first = line % grid.dims[u] * strides[u] + line / grid.dims[u] * strides[v];
                // A little beside the samples: models like to have edges where grids have lines.
                glm::vec3 origin = grid.point(first);
                origin[static_cast<int>(u)] += 0.00137f * grid.spacing;
                origin[static_cast<int>(v)] += 0.00291f * grid.spacing;
                origin[along] = box.min[along] - grid.spacing;
                for_inside(scene, mesh, origin, along, grid.origin[along] - origin[along], grid.spacing,
                           grid.dims[axis], crossings,
                           [&](std::uint32_t k) { ++lines[first + k * strides[axis]]; });
            }
        });
    }
    for (std::uint8_t& value : lines) value = value == 3 ? 1 : 0;
    return lines;
}

}  // namespace dfield
