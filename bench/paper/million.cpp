// The cost of a lookup against the triangle count: the same surface with many more triangles.
#include <algorithm>
#include <limits>

#include "bench/paper/figures.hpp"
#include "bench/paper/subdivide.hpp"

namespace dfield::paper {
namespace {

constexpr std::size_t kManyTriangles = 1000000;
constexpr int kRounds = 15;

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
