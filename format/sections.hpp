// Line tables, direction maps and occlusion volumes to the raw bytes of their sections and back. FORMAT.md,
// "LINE", "DM00 to DM07" and "VOLU", is normative.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

#include "format/contents.hpp"
#include "format/field.hpp"

namespace dfield {

// What is wrong with a section's raw bytes, or nothing. Safe on any bytes; takes no memory but for the table
// and its model (at most kSectionScratchBytes), and that only after its size is held against `max_bytes`.
inline constexpr std::uint64_t kSectionScratchBytes = std::uint64_t{192} << 10;
std::optional<ContentError> decode_lines(std::span<const std::byte> raw, std::uint64_t max_bytes,
                                         LineTable& table, std::pmr::memory_resource* memory);
std::optional<ContentError> decode_directions(std::span<const std::byte> raw, std::uint64_t max_bytes,
                                              DirectionMaps& maps, std::pmr::memory_resource* memory);
std::optional<ContentError> decode_volume(std::span<const std::byte> raw, std::uint64_t max_bytes,
                                          OcclusionVolume& volume);

// The writing half: sections_encode.cpp, library dfield_format_write. The tables keep the format's rules
// (contents.hpp).
std::vector<std::byte> encode_lines(const LineTable& table);
std::vector<std::byte> encode_directions(const DirectionMaps& maps);
std::vector<std::byte> encode_volume(const OcclusionVolume& volume);

}  // namespace dfield
