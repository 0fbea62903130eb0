// Reading and validating .dfield bytes. Safe on any input: see FORMAT.md, "Validation order".
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "format/field.hpp"

namespace dfield {

// Why a file was refused; the numbers are those of `dfield validate` and never change meaning.
enum class FormatErrorCode : std::uint32_t;

// Thrown by read_field. what() says what is wrong, where (byte offset) and what to do.
class FormatError : public std::runtime_error {
  public:
    FormatError(FormatErrorCode code, const std::string& message)
        : std::runtime_error(message), code_(code) {}
    FormatErrorCode code() const { return code_; }

  private:
    FormatErrorCode code_;
};

struct ReadLimits {
    // An engine may lower them; kMaxTexelBytes and the like hold in any case.
    std::uint64_t max_texel_bytes = kMaxTexelBytes;
    std::uint64_t max_self_vertices = kMaxSelfVertices;
    std::uint64_t max_line_bytes = kMaxLineTableBytes;       // of the line table, in memory
    std::uint64_t max_direction_bytes = kMaxDirectionBytes;  // of all loaded levels, in memory
    std::uint64_t max_volume_bytes = kMaxVolumeBytes;        // of the occlusion volume, in memory
};

// What of a file is loaded. What is left out is neither decompressed nor checked beyond the section table,
// and the field is as if the file did not hold it.
struct ReadOptions {
    ReadLimits limits = {};
    bool maps = true;   // displacement maps
    bool lines = true;  // the line table
    // Direction maps: at most so many levels of detail, the coarsest ones.
    std::uint32_t direction_levels = kMaxDirectionLevels;
    bool self_visibility = true;
    bool volume = true;  // the occlusion volume
};

// One result of validation. Errors make read_field refuse the file; warnings do not.
struct Finding {
    enum class Severity : std::uint8_t { kWarning, kError };
    FormatErrorCode code;
    Severity severity;
    std::uint64_t offset;  // into the file, where the finding is
    std::string message;
};

// One entry of the section table, as stored.
struct SectionInfo {
    std::string id;  // four characters
    std::uint32_t flags;
    std::uint64_t offset, stored_bytes, raw_bytes, checksum;
};

struct FileInfo {
    std::uint16_t version_major, version_minor;
    std::uint64_t file_bytes;
    std::vector<SectionInfo> sections;
};

// Decodes a file, or what the options name of it. Field storage comes from `memory`. Throws FormatError;
// never reads outside `bytes`, never allocates more than FORMAT.md's stated bound.
DisplacementField read_field(std::span<const std::byte> bytes, const ReadOptions& options = {},
                             std::pmr::memory_resource* memory = std::pmr::get_default_resource());

// Checks header and section table only (size, magic, version, checksum) and returns them. Throws FormatError.
FileInfo read_file_info(std::span<const std::byte> bytes);

// Everything that is wrong with a file, as far as checks can go on after the first error.
std::vector<Finding> validate_file(std::span<const std::byte> bytes, const ReadLimits& limits = {});

// XXH3-128 of all that a field holds but its provenance as 32 hex digits: equal for equal bakes, whatever the
// zstd version. Of displacement maps alone it is the hash that format version 1.0 had.
std::string payload_hash(const DisplacementField& field);

}  // namespace dfield
