// Rules for what is in a field, the same for reader and writer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/field.hpp"
#include "format/layout.hpp"

namespace dfield {

struct ContentError {
    FormatErrorCode code;
    std::uint64_t offset;  // into the section's raw bytes
    std::string message;   // what is wrong, without what to do
};

// Centre, radius and bounds: finite, radius positive and normal, box ordered and within the sphere's box.
std::vector<ContentError> sphere_errors(const DisplacementField& field);

// The rejection mapping's corners hold no direction, so no hit. `plane` as in codec.hpp.
std::optional<ContentError> unused_texel_error(const FieldParameters& parameters,
                                               std::span<const std::uint8_t> plane);

// A map without a hit has mean depth 0.
std::optional<ContentError> mean_depth_error(const FieldParameters& parameters,
                                             std::span<const std::uint8_t> plane,
                                             std::span<const std::uint16_t> mean_depth);

// Parameters, sizes, padding and the map to the unit sphere. Offsets are into section LINE.
std::optional<ContentError> line_table_error(const LineTable& table);

// Parameters, sizes and depths. Offsets are into the section.
std::optional<ContentError> direction_maps_error(const DirectionMaps& maps);

// From coarse to fine: neither subdivision nor map size falls, and one of them or the depth size rises.
bool finer_level(const DirectionParameters& coarse, const DirectionParameters& fine);

// Dimensions, sizes, origin, spacing and blend. Offsets are into section VOLU.
std::optional<ContentError> volume_error(const OcclusionVolume& volume);

// UTF-8 without control characters but white space, from { to }, 2..kMaxProvenanceBytes. Not parsed.
std::optional<ContentError> provenance_error(std::string_view text);

}  // namespace dfield
