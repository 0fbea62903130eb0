#include "baker/bake_lines.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "baker/bounding_ellipsoid.hpp"
#include "baker/embree_scene.hpp"
#include "baker/error.hpp"
#include "baker/exact_distance.hpp"
#include "baker/parallel.hpp"

namespace dfield {
namespace {

constexpr std::uint32_t kPacket = 8;

// Chords tried for a depth: the one between the lattice points and, where it misses the object, these between
// other points of the two cells, since a finer lattice may know of a hit there.
constexpr std::uint32_t kChordsInCells = 8;

TriangleMesh carried(const TriangleMesh& mesh, const UnitMap& map) {
    TriangleMesh unit;
    unit.triangles = mesh.triangles;
    unit.positions.reserve(mesh.positions.size());
    for (const glm::vec3& position : mesh.positions)
        unit.positions.emplace_back(glm::dmat3(map.to_unit) *
                                    (glm::dvec3(position) - glm::dvec3(map.centre)));
    return unit;
}

// Packs of unit-interval segments from one point.
class Segments {
  public:
    explicit Segments(const EmbreeScene& scene) : scene_(scene) {
        rtcInitIntersectContext(&context_);
        context_.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    }

    // Calls hit(i) for each of the `count` points to which something is on the way; count <= kPacket.
    template<class Hit>
    void occluded(const glm::vec3& from, const glm::vec3* to, std::uint32_t count, const Hit& hit) {
        alignas(32) RTCRay8 rays;
        alignas(32) std::array<int, kPacket> valid;
        fill(rays, valid, from, to, count);
        rtcOccluded8(valid.data(), scene_.get(), &context_, &rays);
        for (std::uint32_t i = 0; i < count; ++i)
            if (valid[i] != 0 && rays.tfar[i] < 0) hit(i);  // Embree's mark of an occluded ray
    }

    // Calls hit(i, fraction) with the fraction of the way at which the first thing lies.
    template<class Hit>
    void nearest(const TriangleMesh& mesh, const glm::vec3& from, const glm::vec3* to, std::uint32_t count,
                 const Hit& hit) {
        alignas(32) RTCRayHit8 rays;
        alignas(32) std::array<int, kPacket> valid;
        fill(rays.ray, valid, from, to, count);
        for (std::uint32_t i = 0; i < kPacket; ++i) clear_hit(rays.hit, i);
        rtcIntersect8(valid.data(), scene_.get(), &context_, &rays);
        for (std::uint32_t i = 0; i < count; ++i) {
            if (valid[i] == 0 || rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
            const double exact =
                std::clamp(exact_distance(mesh, rays.hit.primID[i], from, to[i] - from), 0.0, 1.0);
            hit(i, exact >= 0 ? exact : static_cast<double>(rays.ray.tfar[i]));
        }
    }

  private:
    // A chord from a point to itself has no inside: its lane stays unused.
    static void fill(RTCRay8& rays, std::array<int, kPacket>& valid, const glm::vec3& from,
                     const glm::vec3* to, std::uint32_t count) {
        for (std::uint32_t i = 0; i < kPacket; ++i) {
            const glm::vec3 way = i < count ? to[i] - from : glm::vec3(0);
            const bool used = glm::dot(way, way) > 0;
            valid[i] = used ? -1 : 0;
            // Where Embree has no packets this wide it takes every ray whose interval is not empty.
            set_ray(rays, i, from, used ? way : glm::vec3(1, 0, 0), used ? 0.0f : 1.0f, used ? 1.0f : 0.0f);
        }
    }

    const EmbreeScene& scene_;
    RTCIntersectContext context_;
};

// Words are shared between rows of a table, so between threads.
void set_bits(std::uint32_t& word, std::uint32_t bits) {
    std::atomic_ref(word).fetch_or(bits, std::memory_order_relaxed);
}

void bake_hits(const EmbreeScene& scene, const std::vector<glm::vec3>& points, std::uint32_t high,
               LineTable& table) {
    Segments segments(scene);
    for (std::uint32_t low = 0; low <= high; low += kPacket)
        segments.occluded(points[high], &points[low], std::min(kPacket, high + 1 - low),
                          [&](std::uint32_t i) {
                              const std::uint32_t index = hit_index(low + i, high);
                              set_bits(table.hits[index / 32], 1u << index % 32);
                          });
}

// The depths of all chords that end in a point: from there, looking back, the last hit is the first.
// points_in_cells[k * n + a]: chord k's point in the cell of a; k = 0: the lattice's point.
void bake_depths(const EmbreeScene& scene, const TriangleMesh& unit,
                 const std::vector<glm::vec3>& points_in_cells, std::uint32_t exit, LineTable& table) {
    const std::uint32_t bits = table.parameters.depth_bits;
    const std::uint32_t n = lattice_point_count(table.parameters.depth_lattice);
    Segments segments(scene);
    for (std::uint32_t first = 0; first < n; first += kPacket) {
        const std::uint32_t count = std::min(kPacket, n - first);
        std::array<double, kPacket> sum{};
        std::array<std::uint32_t, kPacket> hits{};
        const auto trace = [&](std::uint32_t chord) {
            // The two cells' points are paired in opposite orders, so that they do not move together.
            const glm::vec3& from = points_in_cells[(chord == 0 ? 0 : kChordsInCells - chord) * n + exit];
            segments.nearest(unit, from, &points_in_cells[chord * n + first], count,
                             [&](std::uint32_t i, double fraction) {
                                 sum[i] += fraction;
                                 ++hits[i];
                             });
        };
        trace(0);
        std::array<bool, kPacket> known{};
        for (std::uint32_t i = 0; i < count; ++i) known[i] = hits[i] != 0;
        const std::array<double, kPacket> exact = sum;
        if (!std::all_of(known.begin(), known.begin() + count, [](bool k) { return k; }))
            for (std::uint32_t chord = 1; chord < kChordsInCells; ++chord) trace(chord);
        for (std::uint32_t i = 0; i < count; ++i) {
            if (hits[i] == 0) continue;
            const double from_entry = 1 - (known[i] ? exact[i] : sum[i] / hits[i]);
            const auto value = static_cast<std::uint32_t>(1 + std::lround(from_entry * ((1 << bits) - 2)));
            const std::uint32_t at = depth_index(first + i, exit, n) * bits;
            set_bits(table.depths[at / 32], value << at % 32);
        }
    }
}

// Points in the cells for the further chords: a Kronecker sequence of the plastic number, even in the square.
std::vector<glm::vec3> points_in_cells(std::uint32_t lattice) {
    std::vector<glm::vec3> points = lattice_points(lattice);
    for (std::uint32_t chord = 1; chord < kChordsInCells; ++chord) {
        const glm::dvec2 place(std::fmod(0.5 + 0.7548776662466927 * chord, 1.0),
                               std::fmod(0.5 + 0.5698402909980532 * chord, 1.0));
        for (std::uint32_t i = 0; i < lattice_point_count(lattice); ++i)
            points.push_back(lattice_point(lattice, i, place));
    }
    return points;
}

}  // namespace

LineTable bake_lines(const TriangleMesh& mesh, const BoundingSphere& sphere, const LineBakeOptions& options,
                     LineBakeReport* report) {
    const LineParameters& parameters = options.parameters;
    if (const std::string error = line_parameters_error(parameters); !error.empty()) throw InputError(error);
    const auto seconds_since = [](std::chrono::steady_clock::time_point start) {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };

    auto start = std::chrono::steady_clock::now();
    const UnitMap map = parameters.ellipsoid ? bounding_ellipsoid(mesh) : unit_map(sphere);
    const TriangleMesh unit = carried(mesh, map);
    EmbreeScene scene(EmbreeUse::kBake);
    scene.add_mesh(unit);
    scene.commit(options.threads);
    LineBakeReport result;
    result.build_seconds = seconds_since(start);

    LineTable table;
    table.parameters = parameters;
    table.to_unit = map.to_unit;
    table.centre = map.centre;
    table.hits.resize(line_hit_words(parameters));
    table.depths.resize(line_depth_words(parameters));
    const auto for_points = [&](std::size_t count, const auto& body) {
        parallel_ranges(options.threads, count, 4, [&](std::size_t begin, std::size_t end) {
            if (options.cancel && options.cancel->load(std::memory_order_relaxed))
                throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
            for (std::size_t i = begin; i < end; ++i) body(static_cast<std::uint32_t>(i));
        });
    };

    start = std::chrono::steady_clock::now();
    const std::vector<glm::vec3> points = lattice_points(parameters.lattice);
    for_points(points.size(), [&](std::uint32_t high) { bake_hits(scene, points, high, table); });
    if (parameters.depth_bits != 0) {
        const std::vector<glm::vec3> in_cells = points_in_cells(parameters.depth_lattice);
        for_points(lattice_point_count(parameters.depth_lattice),
                   [&](std::uint32_t exit) { bake_depths(scene, unit, in_cells, exit, table); });
    }
    result.trace_seconds = seconds_since(start);
    result.rays = line_hit_count(parameters) + line_depth_count(parameters);
    if (report) *report = result;
    return table;
}

}  // namespace dfield
