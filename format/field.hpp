// A displacement field in memory: what a .dfield holds once decoded. The contract between baker and runtime;
// FORMAT.md is normative for every rule stated here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <optional>
#include <string>
#include <vector>

#include "format/direction_maps.hpp"
#include "format/line_table.hpp"
#include "format/occlusion_volume.hpp"

namespace dfield {

// How positional samples lie on the unit sphere (format/sphere_points.hpp).
enum class Positions : std::uint8_t { kSlater = 0, kLatlong = 1 };

// How the texels of a displacement map cover the hemisphere of directions (format/hemisphere_map.hpp).
enum class Mapping : std::uint8_t { kConcentric = 0, kPolar = 1, kRejection = 2 };

// Limits of the format; a file or a bake beyond them is refused.
inline constexpr std::uint32_t kMaxSubdivision = 256;
inline constexpr std::uint32_t kMaxMapSize = 1024;
inline constexpr std::uint64_t kMaxTexelBytes = std::uint64_t{1} << 30;
inline constexpr std::uint64_t kMaxProvenanceBytes = std::uint64_t{1} << 20;
inline constexpr std::uint64_t kMaxSelfVertices = std::uint64_t{1} << 28;
inline constexpr std::uint32_t kMaxDirectionLevels = 8;
inline constexpr std::uint64_t kMaxDirectionBytes = std::uint64_t{1} << 28;  // of all levels, in memory

struct FieldParameters {
    Positions positions = Positions::kSlater;
    std::uint32_t subdivision = 32;  // n, 1..kMaxSubdivision
    Mapping mapping = Mapping::kConcentric;
    std::uint32_t map_size = 32;  // m: a map has m*m texels, 1..kMaxMapSize
    std::uint32_t bits = 8;       // 1, 8, 16 or 32 (float); 0 = no displacement maps

    bool operator==(const FieldParameters&) const = default;
};

// The parameters of a field without displacement maps. All counts and sizes below are then 0.
inline constexpr FieldParameters kNoMaps{Positions::kSlater, 0, Mapping::kConcentric, 0, 0};
constexpr bool has_maps(const FieldParameters& parameters) {
    return parameters.bits != 0;
}

// Stored positional samples: shared equator points count once. 4n^2+2 (Slater), (2n+1)(2n+2) (latlong).
std::uint64_t position_count(const FieldParameters& parameters);

// The count as the paper states it: two hemispheres, the equator counted twice, 2(2n^2+2n+1) for Slater.
std::uint64_t paper_position_count(const FieldParameters& parameters);

// Bytes of one map: ceil(m*m*bits/8). Every map starts on a byte.
std::uint64_t map_bytes(const FieldParameters& parameters);

// position_count * map_bytes.
std::uint64_t texel_bytes(const FieldParameters& parameters);

// Empty when the parameters are within the format's limits, otherwise what is wrong and what is allowed.
std::string parameters_error(const FieldParameters& parameters);

// Values of texels. A distance d from the positional sample along the texel's direction is stored divided by
// the diameter 2R. 8 bit: round(254 d/2R), 255 = miss. 16 bit: round(65534 d/2R), 65535 = miss. 32 bit: the
// float d/2R below 1, 1 = miss. 1 bit: 1 = hit, least significant bit first.
inline constexpr std::uint8_t kMiss8 = 255;
inline constexpr std::uint16_t kMiss16 = 65535;
inline constexpr float kMiss32 = 1.0f;

// What a .dfield holds: up to four kinds of precomputed visibility of one object. The sphere and the box are
// always there, each kind may be absent.
struct DisplacementField {
    explicit DisplacementField(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
        : texels(memory), mean_depth(memory), self_visibility(memory), directions(memory) {}

    FieldParameters parameters;  // of the displacement maps; kNoMaps where there are none
    glm::vec3 centre{0};         // of the bounding sphere, object space
    float radius = 0;            // R > 0, object space
    glm::vec3 bounds_min{0};     // axis-aligned box of the traced triangles, object space
    glm::vec3 bounds_max{0};

    // Maps in order of positional samples; in a map rows (t) of m texels (s). 16 and 32 bit little-endian.
    std::pmr::vector<std::uint8_t> texels;

    // 1 bit only, one per positional sample: the mean depth along the inward normal of the hits of its map,
    // divided by 2R, times 65535, rounded. 0 where the map has no hit. Empty at other bit depths.
    std::pmr::vector<std::uint16_t> mean_depth;

    // Optional: visibility of the object's own vertices past the object itself (1 = open), times 65535, in
    // the order of the imported mesh's vertices. Empty when not baked.
    std::pmr::vector<std::uint16_t> self_visibility;

    // Optional: whether the object is met by the chords of its bounding sphere or ellipsoid.
    std::optional<LineTable> lines;

    // Direction maps, coarse levels of detail first: subdivision and map size never fall from a level to the
    // next, and no two levels have the same parameters. At most kMaxDirectionLevels.
    std::pmr::vector<DirectionMaps> directions;

    // Optional: how much of each octant of the sky the object leaves open around it.
    std::optional<OcclusionVolume> volume;

    // JSON text: mesh hash, parameters, versions of the tools. No times, no paths. May be empty.
    std::string provenance;
};

}  // namespace dfield
