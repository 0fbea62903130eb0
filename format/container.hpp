// Header, section table and frames of a .dfield file; what is in the sections is reader.cpp's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "format/file.hpp"
#include "format/report.hpp"

namespace dfield {

// The header and the table, as far as they can be trusted: magic, version, file size, checksum. Nothing after
// an error that makes the rest meaningless.
std::optional<FileInfo> parse_header(std::span<const std::byte> bytes, Report& report);

// Flags, order, placement and padding of the sections. False when their bytes cannot be told.
bool check_sections(std::span<const std::byte> bytes, const FileInfo& info, Report& report);

// Nothing when the file has no such section.
const SectionInfo* find_section(const FileInfo& info, std::string_view id);

// The raw bytes of a section whose placement is checked: its checksum first, then its frame. Allocates
// raw_bytes; the caller has checked that against what the section may hold.
std::optional<std::pmr::vector<std::byte>> decompress_section(std::span<const std::byte> bytes,
                                                              const SectionInfo& section, Report& report,
                                                              std::pmr::memory_resource* memory);

}  // namespace dfield
