// XXH3 checksums and the payload hash.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "format/field.hpp"

namespace dfield {

std::uint64_t checksum64(std::span<const std::byte> bytes, std::uint64_t seed = 0);

// The header's checksum: XXH3-64 of the section table, seeded with that of the header's bytes before the
// checksum. `bytes` begins with the header and holds the whole table.
std::uint64_t header_checksum(std::span<const std::byte> bytes, std::uint32_t section_count);

// Bytes of section FELD before the hash; payload_hash begins with them.
std::array<std::byte, 56> field_section_prefix(const DisplacementField& field);

// XXH3-128 in the order of its hex digits.
using Digest = std::array<std::byte, 16>;

// What FELD states: sphere, displacement maps, mean depths and self visibilities.
Digest field_digest(const DisplacementField& field);

// What LINE, each of DM00 to DM07 and VOLU state: the header's first bytes (layout.hpp) and the content.
std::array<std::byte, 56> line_section_prefix(const LineTable& table);
std::array<std::byte, 8> direction_section_prefix(const DirectionMaps& maps);
std::array<std::byte, 32> volume_section_prefix(const OcclusionVolume& volume);
Digest line_digest(const LineTable& table);
Digest direction_digest(const DirectionMaps& maps);
Digest volume_digest(const OcclusionVolume& volume);

// payload_hash (file.hpp).
Digest payload_digest(const DisplacementField& field);

}  // namespace dfield
