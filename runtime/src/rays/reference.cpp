// The ray kernels in plain code, ray by ray: what the vector kernels are held to, and what runs where there
// are none.
#include <algorithm>
#include <limits>

#include "any_hit_batch.hpp"
#include "line_lookup.hpp"
#include "rays/kernels.hpp"

namespace dfield::runtime {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

void maps_any_hits(const RayQuery& query, const GroupedRays& rays, RayBits& open) {
    AnyHitBatch batch;
    Chord chord;
    for (std::size_t i = 0; i < rays.count(); ++i)
        if (has_bit(open, i) && chord_of_query(query, rays.direction(i), chord))
            batch.add(chord, static_cast<std::uint16_t>(i), query.minimum, query.in_front);
    with_bits(*query.field, [&]<int kBits>() {
        batch.look_up<kBits>(*query.field, [&](std::uint16_t i) { clear_bit(open, i); });
    });
}

template<int kBits>
float map_distance(const RayQuery& query, const Chord& chord) {
    if (query.in_front) {
        // Every hit on the line is ahead of the receiver, so the first one is the nearest.
        if (!(chord.t_out() > 0)) return kInfinity;
        const LineHit hit = look_up<kBits>(*query.field, chord, LineEnd::kEntry);
        return hit.hit ? std::max(hit.t, 0.0f) : kInfinity;
    }
    const float t = first_hit<kBits>(*query.field, chord);
    return t >= query.minimum ? t : kInfinity;
}

void maps_distances(const RayQuery& query, const GroupedRays& rays, float* nearest) {
    with_bits(*query.field, [&]<int kBits>() {
        Chord chord;
        for (std::size_t i = 0; i < rays.count(); ++i)
            if (chord_of_query(query, rays.direction(i), chord))
                nearest[i] = std::min(nearest[i], map_distance<kBits>(query, chord));
    });
}

// Calls look_up(i, chord in the maps' sphere) for the rays of a block that can hit the object.
template<class LookUp>
void for_map_rays(const Instance& instance, const RayBlock& rays, const LookUp& look_up) {
    for (std::size_t i = 0; i < rays.count; ++i) {
        const glm::vec3 origin = instance.carry_point({rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]});
        const glm::vec3 direction = instance.carry_direction({rays.x[i], rays.y[i], rays.z[i]});
        Chord chord;
        if (!instance.leaving_box(origin).leaves(direction.x, direction.y, direction.z) &&
            chord_of_line(origin, direction, chord))
            look_up(i, chord);
    }
}

void maps_ray_any_hits(const Instance& instance, const RayBlock& rays, RayBits& open) {
    AnyHitBatch batch;
    for_map_rays(instance, rays, [&](std::size_t i, const Chord& chord) {
        if (has_bit(open, i)) batch.add(chord, static_cast<std::uint16_t>(i), 0, false);
    });
    with_bits(*instance.field, [&]<int kBits>() {
        batch.look_up<kBits>(*instance.field, [&](std::uint16_t i) { clear_bit(open, i); });
    });
}

void maps_ray_distances(const Instance& instance, const RayBlock& rays, float* nearest) {
    with_bits(*instance.field, [&]<int kBits>() {
        for_map_rays(instance, rays, [&](std::size_t i, const Chord& chord) {
            nearest[i] = std::min(nearest[i], first_hit<kBits>(*instance.field, chord));
        });
    });
}

// The same for the line table's sphere.
template<class LookUp>
void for_line_rays(const Instance& instance, const RayBlock& rays, const LookUp& look_up) {
    for (std::size_t i = 0; i < rays.count; ++i) {
        const glm::vec3 origin(rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]);
        const RayQuery query = line_query(instance, origin, glm::mat3(1), 0, false);
        Chord chord;
        if (chord_of_query(query, {rays.x[i], rays.y[i], rays.z[i]}, chord)) look_up(i, chord);
    }
}

void lines_ray_any_hits(const Instance& instance, const RayBlock& rays, RayBits& open) {
    for_line_rays(instance, rays, [&](std::size_t i, const Chord& chord) {
        if (has_bit(open, i) && line_blocked(*instance.field, chord, 0, false)) clear_bit(open, i);
    });
}

void lines_ray_distances(const Instance& instance, const RayBlock& rays, float* nearest) {
    for_line_rays(instance, rays, [&](std::size_t i, const Chord& chord) {
        nearest[i] = std::min(nearest[i], line_distance(*instance.field, chord, 0, false));
    });
}

}  // namespace

const RayLookups kRayLookupsReference{
    {maps_any_hits, maps_distances, maps_ray_any_hits, maps_ray_distances},
    {look_up_lines, look_up_line_distances, lines_ray_any_hits, lines_ray_distances}};

}  // namespace dfield::runtime
