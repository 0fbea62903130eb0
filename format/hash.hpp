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

// payload_hash (file.hpp) in the order of its hex digits.
std::array<std::byte, 16> payload_digest(const DisplacementField& field);

}  // namespace dfield
