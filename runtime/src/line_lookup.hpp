// Lookups in a line table, in the table's own space, where the bounding sphere or ellipsoid is the unit
// sphere: what is on a line, and whether it is ahead of a ray's origin. The scalar reference that kernels are
// held to. FORMAT.md, "Line tables", is normative for the lookup rule.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <limits>

#include "format/line_table.hpp"
#include "lookup.hpp"
#include "rays/ray_query.hpp"
#include "scene.hpp"

namespace dfield::runtime {

// The lattice points that stand for the ends of a chord.
struct LatticeChord {
    std::uint32_t entry, exit;
};

inline LatticeChord nearest_chord(std::uint32_t lattice, const Chord& chord) {
    return {nearest_lattice_point(lattice, chord.middle - chord.half * chord.direction),
            nearest_lattice_point(lattice, chord.middle + chord.half * chord.direction)};
}

// The same, but with a pivot: the second line is aimed from the entry's lattice point at the middle of the
// chord, so that there, where objects are, the first end's rounding does no harm.
inline LatticeChord pivoted_chord(std::uint32_t lattice, const glm::vec4* points, const Chord& chord) {
    const std::uint32_t entry = nearest_lattice_point(lattice, chord.middle - chord.half * chord.direction);
    const glm::vec3 p(points[entry]);
    const glm::vec3 aim = chord.middle - p;
    // |p + r aim| = 1 for r = 0 and for
    const float r = -2 * glm::dot(p, aim) / std::max(glm::dot(aim, aim), 1e-12f);
    return {entry, nearest_lattice_point(lattice, p + r * aim)};
}

// The share of the 16 chords between the lattice points around either end that have something on them, each
// by its part in the line.
inline float share_on_line(const LineTable& table, const Chord& chord) {
    const std::uint32_t lattice = table.parameters.lattice;
    const LatticeNeighbours entry = lattice_neighbours(lattice, chord.middle - chord.half * chord.direction),
                            exit = lattice_neighbours(lattice, chord.middle + chord.half * chord.direction);
    float share = 0;
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b)
            if (stored_hit(table, entry.points[a], exit.points[b])) share += entry.shares[a] * exit.shares[b];
    return share;
}

// Whether anything is on the chord, on either side of a ray's origin.
inline bool anything_on_line(const dfield_field& field, const Chord& chord) {
    const LineTable& table = *field.maps.lines;
    const std::uint32_t lattice = table.parameters.lattice;
    if (table.parameters.filtered) return share_on_line(table, chord) > 0.5f;
    const LatticeChord ends = table.parameters.pivot ? pivoted_chord(lattice, field.line_points.data(), chord)
                                                     : nearest_chord(lattice, chord);
    return stored_hit(table, ends.entry, ends.exit);
}

// t of the first and the last hit on a chord that has something on it. Where no depth is known, because none
// are stored or because the coarser lattice's chord misses the object, the middle of the chord stands in for
// both.
struct HitRange {
    float first, last;
};

inline HitRange hits_on_line(const dfield_field& field, const Chord& chord) {
    const LineTable& table = *field.maps.lines;
    const LineParameters& parameters = table.parameters;
    if (parameters.depth_bits == 0) return {chord.t_middle, chord.t_middle};
    const LatticeChord ends = nearest_chord(parameters.depth_lattice, chord);
    const std::uint32_t last = stored_depth(table, ends.entry, ends.exit),
                        first = stored_depth(table, ends.exit, ends.entry);  // the last one, looking back
    // From the middle of the chord, -1 .. 1 of its half.
    const float step = 2 / static_cast<float>((1u << parameters.depth_bits) - 2);
    const float to_last = last == 0 ? 0 : static_cast<float>(last - 1) * step - 1;
    const float to_first = first == 0 ? 0 : 1 - static_cast<float>(first - 1) * step;
    return {chord.t_middle + to_first * chord.half, chord.t_middle + to_last * chord.half};
}

// Whether something lies on the line ahead of t = minimum. in_front: the object lies wholly in front of the
// receiver's tangent plane, so whatever is on the line is ahead; the same holds outside the sphere. There one
// bit is exact; otherwise the last hit decides.
inline bool line_blocked(const dfield_field& field, const Chord& chord, float minimum, bool in_front) {
    if (!(chord.t_out() > minimum) || !anything_on_line(field, chord)) return false;
    return in_front || chord.t_in() >= minimum || hits_on_line(field, chord).last > minimum;
}

// t of the first hit ahead of t = minimum, +infinity for none; never before `minimum`.
inline float line_distance(const dfield_field& field, const Chord& chord, float minimum, bool in_front) {
    constexpr float kNone = std::numeric_limits<float>::infinity();
    if (!(chord.t_out() > minimum) || !anything_on_line(field, chord)) return kNone;
    const HitRange hits = hits_on_line(field, chord);
    if (in_front || chord.t_in() >= minimum) return std::max(hits.first, minimum);
    if (hits.first >= minimum) return hits.first;
    return hits.last > minimum ? hits.last : kNone;
}

// `frame` carries directions to the world. The instance's field has a line table.
inline RayQuery line_query(const Instance& instance, const glm::vec3& origin, const glm::mat3& frame,
                           float minimum, bool in_front) {
    RayQuery query{
        instance.field, instance.lines.carry_point(origin), instance.lines.to_unit * frame, {}, minimum,
        in_front};
    // From outside the sphere a chord has nothing behind the origin that could be taken for something ahead.
    if (glm::dot(query.origin, query.origin) < 1)
        query.leaving =
            LeavingDirections(instance.leaving_box(instance.carry_point(origin)), instance.to_unit * frame);
    return query;
}

// Clears the bit of each open ray that something blocks.
inline void look_up_lines(const RayQuery& query, const GroupedRays& rays, RayBits& open) {
    Chord chord;
    for (std::size_t i = 0; i < rays.count(); ++i)
        if (has_bit(open, i) && chord_of_query(query, rays.direction(i), chord) &&
            line_blocked(*query.field, chord, query.minimum, query.in_front))
            clear_bit(open, i);
}

// The same with distances: nearest[i] becomes the hit's t where that is smaller.
inline void look_up_line_distances(const RayQuery& query, const GroupedRays& rays, float* nearest) {
    Chord chord;
    for (std::size_t i = 0; i < rays.count(); ++i)
        if (chord_of_query(query, rays.direction(i), chord))
            nearest[i] =
                std::min(nearest[i], line_distance(*query.field, chord, query.minimum, query.in_front));
}

}  // namespace dfield::runtime
