// The cost of a lookup against the triangle count: the same surface with many more triangles.
#include <algorithm>
#include <limits>
#include <unordered_map>

#include "bench/paper/figures.hpp"

namespace dfield::paper {
namespace {

constexpr std::size_t kManyTriangles = 1000000;
constexpr int kRounds = 15;

// Every triangle into four by the midpoints of its edges, which neighbours share.
TriangleMesh subdivided(const TriangleMesh& mesh) {
    TriangleMesh result{mesh.positions, {}, {}};
    std::unordered_map<std::uint64_t, std::uint32_t> midpoints;
    const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
        const std::uint64_t edge = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
        const auto [at, added] = midpoints.emplace(edge, static_cast<std::uint32_t>(result.positions.size()));
        if (added) result.positions.push_back(0.5f * (mesh.positions[a] + mesh.positions[b]));
        return at->second;
    };
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::uvec3 m{midpoint(t.y, t.z), midpoint(t.z, t.x), midpoint(t.x, t.y)};
        for (const glm::uvec3& part : {glm::uvec3(t.x, m.z, m.y), glm::uvec3(m.z, t.y, m.x),
                                       glm::uvec3(m.y, m.x, t.z), glm::uvec3(m.x, m.y, m.z)})
            result.triangles.push_back(part);
    }
    return result;
}

}  // namespace

Million measure_million(Lab& lab) {
    Million result;
    result.model = lab.find("igea");
    if (!result.model) result.model = lab.find("leafy tree");
    const Model& model = *result.model;
    TriangleMesh mesh = subdivided(model.mesh);
    while (!lab.quick() && mesh.triangles.size() < kManyTriangles) mesh = subdivided(mesh);
    result.triangles = mesh.triangles.size();

    const Baked &original = lab.baked(model, lab.parameters()), many = lab.timed_bake(mesh, lab.parameters());
    result.original_bake_seconds = original.seconds();
    result.bake_seconds = many.seconds();

    // The original's room for both: midpoints do not move its box but by rounding.
    const Receivers& receivers = lab.receivers(model, Room::kGap);
    const Directions& rays = lab.directions(Rays::kConcentric);
    Lookup original_lookup(original.bytes, receivers, rays), lookup(many.bytes, receivers, rays);
    result.original_lookup_seconds = result.lookup_seconds = std::numeric_limits<double>::infinity();
    for (int round = 0; round < lab.rounds(kRounds); ++round) {
        result.original_lookup_seconds = std::min(result.original_lookup_seconds, original_lookup.run());
        result.lookup_seconds = std::min(result.lookup_seconds, lookup.run());
    }
    result.rms = errors_of(lookup.visibility(), lab.ray_cast(model, Room::kGap, Rays::kConcentric)).rms;
    result.duel = duel(mesh, many.bytes, receivers, rays, lab.rounds(3));
    return result;
}

}  // namespace dfield::paper
