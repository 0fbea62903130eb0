#include "baker/bake.hpp"

#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <mutex>

#include "baker/bounding_sphere.hpp"
#include "baker/embree_scene.hpp"
#include "baker/error.hpp"
#include "baker/exact_distance.hpp"
#include "baker/parallel.hpp"
#include "baker/plan.hpp"
#include "baker/provenance.hpp"
#include "baker/ray_visibility.hpp"
#include "baker/unit_mesh.hpp"
#include "format/frame.hpp"
#include "format/hemisphere_map.hpp"
#include "format/sphere_points.hpp"

namespace dfield {
namespace {

constexpr std::uint32_t kPacket = 8;
constexpr float kMiss = -1;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Texels that hold a direction, in tiles of 4 x 4, so that a packet's rays lie close together.
std::vector<std::uint32_t> traced_texels(const std::vector<glm::vec3>& directions, std::uint32_t m) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t tile_t = 0; tile_t < m; tile_t += 4)
        for (std::uint32_t tile_s = 0; tile_s < m; tile_s += 4)
            for (std::uint32_t t = tile_t; t < std::min(tile_t + 4, m); ++t)
                for (std::uint32_t s = tile_s; s < std::min(tile_s + 4, m); ++s)
                    if (directions[t * m + s].z >= 0) order.push_back(t * m + s);
    return order;
}

// Distances of one map in unit-sphere space, kMiss where nothing is hit. `distances` has m * m entries, all
// kMiss. With the incoherent flag Embree follows single rays; packets of eight measured fastest.
void trace_map(const EmbreeScene& scene, const TriangleMesh& mesh, const glm::vec3& point,
               const std::vector<glm::vec3>& directions, const std::vector<std::uint32_t>& order,
               std::vector<float>& distances) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    const Frame frame = frame_of_normal(-point);
    for (std::size_t first = 0; first < order.size(); first += kPacket) {
        const std::size_t count = std::min<std::size_t>(kPacket, order.size() - first);
        alignas(32) RTCRayHit8 packet;
        alignas(32) std::array<int, kPacket> valid{};
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec3 direction = frame.to_world(directions[order[first + i]]);
            valid[i] = -1;
            set_ray(packet.ray, i, point, direction, 0, std::numeric_limits<float>::infinity());
            clear_hit(packet.hit, i);
        }
        rtcIntersect8(valid.data(), scene.get(), &context, &packet);
        for (std::size_t i = 0; i < count; ++i) {
            if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
            const glm::vec3 direction(packet.ray.dir_x[i], packet.ray.dir_y[i], packet.ray.dir_z[i]);
            const double exact =
                std::clamp(exact_distance(mesh, packet.hit.primID[i], point, direction), 0.0, 2.0);
            distances[order[first + i]] = exact >= 0 ? static_cast<float>(exact) : packet.ray.tfar[i];
        }
    }
}

// round() for values of 0 and above, without the library call.
std::uint32_t rounded(float value) {
    return static_cast<std::uint32_t>(value + 0.5f);
}

// Stores distances (unit-sphere space, 0..2, negative = miss) as the texels of one map. The diameter is 2
// there, so the normalised distance is half of them.
void store_map(const FieldParameters& parameters, const std::vector<float>& distances, std::uint8_t* texels) {
    switch (parameters.bits) {
        case 1:
            for (std::size_t i = 0; i < distances.size(); ++i)
                if (distances[i] >= 0) texels[i >> 3] |= static_cast<std::uint8_t>(1u << (i & 7));
            break;
        case 8:
            for (std::size_t i = 0; i < distances.size(); ++i)
                texels[i] =
                    distances[i] < 0 ? kMiss8 : static_cast<std::uint8_t>(rounded(distances[i] * 127.0f));
            break;
        case 16:
            for (std::size_t i = 0; i < distances.size(); ++i) {
                const auto value =
                    distances[i] < 0 ? std::uint32_t{kMiss16} : rounded(distances[i] * 32767.0f);
                texels[2 * i] = static_cast<std::uint8_t>(value & 255);
                texels[2 * i + 1] = static_cast<std::uint8_t>(value >> 8);
            }
            break;
        default:
            for (std::size_t i = 0; i < distances.size(); ++i) {
                const float value =
                    distances[i] < 0 ? kMiss32 : std::min(0.5f * distances[i], std::nextafter(kMiss32, 0.0f));
                const auto bits = std::bit_cast<std::uint32_t>(value);
                for (int byte = 0; byte < 4; ++byte)
                    texels[4 * i + byte] = static_cast<std::uint8_t>(bits >> (8 * byte) & 255);
            }
    }
}

// Mean depth of a map's hits along the normal, as DisplacementField::mean_depth states it.
std::uint16_t mean_depth_of(const std::vector<float>& distances, const std::vector<glm::vec3>& directions) {
    double sum = 0;
    std::size_t hits = 0;
    for (std::size_t i = 0; i < distances.size(); ++i)
        if (distances[i] >= 0) {
            sum += static_cast<double>(distances[i]) * directions[i].z;
            ++hits;
        }
    return hits ? static_cast<std::uint16_t>(std::lround(sum / (2.0 * hits) * 65535)) : 0;
}

class Progress {
  public:
    Progress(const BakeOptions& options, std::uint64_t total) : options_(options), total_(total) {}

    void add(std::uint64_t rays) {
        const std::uint64_t done = done_.fetch_add(rays) + rays;
        if (options_.cancel && options_.cancel->load(std::memory_order_relaxed))
            throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
        if (!options_.progress) return;
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (lock) options_.progress(done, total_);
    }

  private:
    const BakeOptions& options_;
    std::uint64_t total_;
    std::atomic<std::uint64_t> done_{0};
    std::mutex mutex_;
};

void bake_maps(const TriangleMesh& mesh, const BoundingSphere& sphere, const BakeOptions& options,
               DisplacementField& field, BakeReport& result) {
    const FieldParameters& parameters = options.parameters;
    field.texels.resize(texel_bytes(parameters));
    if (parameters.bits == 1) field.mean_depth.resize(position_count(parameters));

    auto start = std::chrono::steady_clock::now();
    const TriangleMesh unit = unit_mesh(mesh, sphere);
    EmbreeScene scene(EmbreeUse::kBake);
    scene.add_mesh(unit);
    scene.commit(options.threads);
    result.build_seconds = seconds_since(start);

    start = std::chrono::steady_clock::now();
    const std::vector<glm::vec3> points = sphere_points(parameters.positions, parameters.subdivision);
    const std::vector<glm::vec3> directions = map_directions(parameters.mapping, parameters.map_size);
    const std::vector<std::uint32_t> order = traced_texels(directions, parameters.map_size);
    const std::size_t stride = map_bytes(parameters);
    result.rays = std::uint64_t{points.size()} * order.size();
    Progress progress(options, result.rays);
    const std::size_t grain = std::max<std::size_t>(1, 16384 / directions.size());
    parallel_ranges(options.threads, points.size(), grain, [&](std::size_t begin, std::size_t end) {
        std::vector<float> distances(directions.size());
        for (std::size_t map = begin; map < end; ++map) {
            distances.assign(directions.size(), kMiss);
            trace_map(scene, unit, points[map], directions, order, distances);
            store_map(parameters, distances, field.texels.data() + map * stride);
            if (parameters.bits == 1) field.mean_depth[map] = mean_depth_of(distances, directions);
        }
        progress.add(std::uint64_t{end - begin} * order.size());
    });
    result.trace_seconds = seconds_since(start);
}

}  // namespace

DisplacementField bake_field(const TriangleMesh& mesh, const BakeOptions& options, BakeReport* report) {
    const FieldParameters& parameters = options.parameters;
    if (const std::string error = parameters_error(parameters); !error.empty()) throw InputError(error);
    if (mesh.triangles.empty()) throw InputError("the mesh has no usable triangle");

    const BoundingSphere sphere = smallest_enclosing_ball(mesh);
    if (!(sphere.radius > 0) || !std::isfinite(sphere.radius))
        throw InputError("the mesh has no extent that floats can hold (radius " +
                         std::to_string(sphere.radius) + ")");
    DisplacementField field;
    field.parameters = parameters;
    field.centre = sphere.centre;
    field.radius = sphere.radius;
    const Bounds bounds = triangle_bounds(mesh);
    field.bounds_min = bounds.min;
    field.bounds_max = bounds.max;
    BakeReport result;
    result.instruction_set = bake_instruction_set();
    if (has_maps(parameters)) bake_maps(mesh, sphere, options, field, result);

    if (options.self_visibility) {
        const auto start = std::chrono::steady_clock::now();
        for (const float visibility :
             self_visibility(mesh, options.self_rays, options.threads, options.cancel))
            field.self_visibility.push_back(static_cast<std::uint16_t>(std::lround(visibility * 65535.0f)));
        result.self_seconds = seconds_since(start);
    }
    field.provenance = provenance_json(mesh, {.maps = parameters}, options, result.instruction_set);
    if (report) *report = result;
    return field;
}

}  // namespace dfield
