#include "baker/bake_directions.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <limits>

#include "baker/embree_scene.hpp"
#include "baker/error.hpp"
#include "baker/parallel.hpp"
#include "baker/unit_mesh.hpp"
#include "format/frame.hpp"
#include "format/sphere_points.hpp"

namespace dfield {
namespace {

constexpr std::uint32_t kPacket = 8;
constexpr int kAngles = 32;  // tried for the tight rectangle

// Vertices that are farthest in some direction: all that bounding rectangles need. A vertex of the convex
// hull that is farthest between the probed directions only is left out; it lies less than 2e-4 radii beyond
// the others.
std::vector<glm::vec3> extreme_points(const TriangleMesh& unit, int threads) {
    const std::vector<glm::vec3> probes = sphere_points(Positions::kSlater, 32);
    std::vector<std::uint32_t> farthest(probes.size());
    parallel_ranges(threads, probes.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            float best = -std::numeric_limits<float>::infinity();
            for (std::size_t v = 0; v < unit.positions.size(); ++v) {
                const float height = glm::dot(unit.positions[v], probes[i]);
                if (height > best) best = height, farthest[i] = static_cast<std::uint32_t>(v);
            }
        }
    });
    std::sort(farthest.begin(), farthest.end());
    farthest.erase(std::unique(farthest.begin(), farthest.end()), farthest.end());
    std::vector<glm::vec3> points;
    for (const std::uint32_t v : farthest) points.push_back(unit.positions[v]);
    return points;
}

struct Interval {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    void add(float value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    float length() const { return high - low; }
};

std::array<Interval, 2> extent(const std::vector<glm::vec3>& points, const glm::vec3& u, const glm::vec3& v) {
    std::array<Interval, 2> result;
    for (const glm::vec3& p : points) {
        result[0].add(glm::dot(p, u));
        result[1].add(glm::dot(p, v));
    }
    return result;
}

std::uint8_t byte_of(double value) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0l, 255l));
}

// The smallest rectangle round the object's silhouette, of those at kAngles angles, rounded outwards. The
// plane is still flat and in the middle.
PackedDirectionFrame tight_frame(const std::vector<glm::vec3>& points, const glm::vec3& direction) {
    PackedDirectionFrame best{};
    float best_area = std::numeric_limits<float>::infinity();
    for (int i = 0; i < kAngles; ++i) {
        PackedDirectionFrame packed{
            byte_of(256 * std::tan(i * (3.14159265358979 / 4 / kAngles))), 128, 128, 255, 255, 128, 128, 128};
        const DirectionFrame frame = unpack_direction_frame(packed, direction);
        const auto extents = extent(points, frame.axis_u, frame.axis_v);
        for (int axis = 0; axis < 2; ++axis) {
            const Interval& range = extents[axis];
            packed[1 + axis] = byte_of(64.0 * (range.low + range.high) + 128);
            const float centre = (static_cast<float>(packed[1 + axis]) - 128.0f) / 128;
            const float half = std::max(range.high - centre, centre - range.low);
            packed[3 + axis] = byte_of(std::ceil(256.0 * half) - 1);
        }
        const DirectionFrame fitted = unpack_direction_frame(packed, direction);
        if (fitted.half_u * fitted.half_v < best_area) {
            best_area = fitted.half_u * fitted.half_v;
            best = packed;
        }
    }
    return best;
}

// Nearest and farthest hit along +direction of the line through each texel's centre; nearest > farthest
// where nothing is hit.
struct Span {
    float nearest = 2, farthest = -2;
    bool hit() const { return nearest <= farthest; }
};

void trace_map(const EmbreeScene& scene, const DirectionFrame& frame, std::uint32_t m,
               std::vector<Span>& spans) {
    constexpr float kOutside = 2;  // origins lie this far before the sphere's centre plane
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    const glm::vec3 middle = frame.centre_u * frame.axis_u + frame.centre_v * frame.axis_v;
    const auto trace = [&](const std::vector<std::uint32_t>& texels, float sense) {
        for (std::size_t first = 0; first < texels.size(); first += kPacket) {
            const std::size_t count = std::min<std::size_t>(kPacket, texels.size() - first);
            alignas(32) RTCRayHit8 packet;
            alignas(32) std::array<int, kPacket> valid{};
            for (std::size_t i = 0; i < count; ++i) {
                const std::uint32_t texel = texels[first + i];
                const float u = (2 * static_cast<float>(texel % m) + 1) / static_cast<float>(m) - 1;
                const float v = (2 * static_cast<float>(texel / m) + 1) / static_cast<float>(m) - 1;
                const glm::vec3 origin = middle + u * frame.half_u * frame.axis_u +
                                         v * frame.half_v * frame.axis_v - sense * kOutside * frame.direction;
                valid[i] = -1;
                set_ray(packet.ray, i, origin, sense * frame.direction, 0, 2 * kOutside);
                clear_hit(packet.hit, i);
            }
            rtcIntersect8(valid.data(), scene.get(), &context, &packet);
            for (std::size_t i = 0; i < count; ++i) {
                if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
                const float depth = sense * (packet.ray.tfar[i] - kOutside);
                Span& span = spans[texels[first + i]];
                span.nearest = std::min(span.nearest, depth);
                span.farthest = std::max(span.farthest, depth);
            }
        }
    };
    std::vector<std::uint32_t> texels(m * m);
    for (std::uint32_t i = 0; i < m * m; ++i) texels[i] = i;
    spans.assign(m * m, Span{});
    trace(texels, 1);
    std::erase_if(texels, [&](std::uint32_t i) { return !spans[i].hit(); });
    trace(texels, -1);
}

// The plane nearest to the depths at which silhouettes lie: what a ray that is not quite parallel to the
// direction sees shifts in proportion to the distance from the plane, and only at silhouettes does a shift
// change a bit. Least squares over the hits that have a miss beside them.
void fit_pivot(const std::vector<Span>& spans, std::uint32_t m, const glm::vec3& direction,
               PackedDirectionFrame& packed) {
    const DirectionFrame frame = unpack_direction_frame(packed, direction);
    const auto missed = [&](std::uint32_t s, std::uint32_t t) {
        return s >= m || t >= m || !spans[t * m + s].hit();
    };
    glm::dmat3 normal(0);
    glm::dvec3 right(0);
    for (std::uint32_t t = 0; t < m; ++t)
        for (std::uint32_t s = 0; s < m; ++s) {
            const Span& span = spans[t * m + s];
            if (!span.hit()) continue;
            const double weight = missed(s - 1, t) + missed(s + 1, t) + missed(s, t - 1) + missed(s, t + 1);
            if (weight == 0) continue;
            const glm::dvec3 basis(1, ((2.0 * s + 1) / m - 1) * frame.half_u,
                                   ((2.0 * t + 1) / m - 1) * frame.half_v);
            normal += weight * glm::outerProduct(basis, basis);
            right += weight * 0.5 * (static_cast<double>(span.nearest) + span.farthest) * basis;
        }
    if (normal[0][0] == 0) return;
    // Slopes are held back a little, so that thin or tiny silhouettes do not tilt their plane wildly.
    for (int axis = 1; axis < 3; ++axis) normal[axis][axis] += 1e-3 * normal[0][0];
    const glm::dvec3 plane = glm::inverse(normal) * right;
    packed[5] = byte_of(128 * plane.x + 128);
    packed[6] = byte_of(64 * plane.y + 128);
    packed[7] = byte_of(64 * plane.z + 128);
}

std::uint8_t depth_byte(float depth, bool up) {
    const float scaled = 127.5f * depth + 127.5f;
    return byte_of(up ? std::ceil(scaled) : std::floor(scaled));
}

void store_map(const std::vector<Span>& spans, const DirectionParameters& p, std::uint32_t* words,
               DirectionDepth* depths) {
    const std::uint32_t m = p.map_size;
    for (std::uint32_t i = 0; i < m * m; ++i)
        if (spans[i].hit()) words[i / 32] |= 1u << (i % 32);
    if (p.depth_size == 0) return;
    const std::uint32_t side = m / p.depth_size;
    for (std::uint32_t i = 0; i < m * m; ++i) {
        if (!spans[i].hit()) continue;
        DirectionDepth& depth = depths[i / m / side * p.depth_size + i % m / side];
        depth.nearest = std::min(depth.nearest, depth_byte(spans[i].nearest, false));
        depth.farthest = std::max(depth.farthest, depth_byte(spans[i].farthest, true));
    }
}

}  // namespace

DirectionMaps bake_directions(const TriangleMesh& mesh, const BoundingSphere& sphere,
                              const DirectionBakeOptions& options, DirectionBakeReport* report) {
    const DirectionParameters& p = options.parameters;
    if (const std::string error = direction_parameters_error(p); !error.empty()) throw InputError(error);
    const auto now = [] { return std::chrono::steady_clock::now(); };
    const auto seconds = [](auto from, auto to) { return std::chrono::duration<double>(to - from).count(); };

    const auto start = now();
    const TriangleMesh unit = unit_mesh(mesh, sphere);
    EmbreeScene scene(EmbreeUse::kBake);
    scene.add_mesh(unit);
    scene.commit(options.threads);
    const std::vector<glm::vec3> points = extreme_points(unit, options.threads);
    const auto built = now();

    DirectionMaps maps;
    maps.parameters = p;
    const std::uint32_t count = stored_direction_count(p.subdivision),
                        words = direction_map_words(p.map_size);
    maps.frames.resize(count);
    maps.texels.resize(std::size_t{count} * words);
    maps.depths.resize(std::size_t{count} * p.depth_size * p.depth_size, DirectionDepth{255, 0});
    const std::vector<glm::vec3> directions = sphere_points(Positions::kSlater, p.subdivision);
    std::atomic<std::uint64_t> rays{0};
    parallel_ranges(options.threads, count, 16, [&](std::size_t begin, std::size_t end) {
        if (options.cancel && options.cancel->load(std::memory_order_relaxed))
            throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
        std::vector<Span> spans;
        for (std::size_t i = begin; i < end; ++i) {
            maps.frames[i] = tight_frame(points, directions[i]);
            trace_map(scene, unpack_direction_frame(maps.frames[i], directions[i]), p.map_size, spans);
            fit_pivot(spans, p.map_size, directions[i], maps.frames[i]);
            store_map(spans, p, maps.texels.data() + i * words,
                      maps.depths.data() + i * p.depth_size * p.depth_size);
            rays += spans.size() + std::count_if(spans.begin(), spans.end(), [](auto& s) { return s.hit(); });
        }
    });
    if (report) *report = {rays.load(), seconds(start, built), seconds(built, now())};
    return maps;
}

}  // namespace dfield
