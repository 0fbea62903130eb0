// Where things lie in a .dfield file, and the numbers of its errors. FORMAT.md, "Container", is normative.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "format/file.hpp"

namespace dfield {

// Findings of `dfield validate`. Numbers never change meaning and are never reused. 1xx header, 2xx section
// table and frames, 3xx contents, 9xx warnings.
enum class FormatErrorCode : std::uint32_t {
    kTooShort = 101,           // fewer bytes than a header
    kMagic = 102,              // another kind of file, or damaged in transfer
    kVersion = 103,            // a major version that this reader does not know
    kFileSize = 104,           // truncated or extended
    kSectionCount = 105,       // none, more than kMaxSections, or a table past the end
    kHeaderChecksum = 106,     // header or table damaged
    kSectionFlags = 201,       // reserved flag set, or the wrong flags for the section
    kSectionOrder = 202,       // known sections out of order, or an id twice
    kSectionUnknown = 203,     // a required section that this reader does not know
    kSectionMissing = 204,     // a section that the field needs is not there
    kSectionUnexpected = 205,  // a section that the field must not have
    kSectionPlacement = 206,   // gap, overlap, misaligned or past the end
    kSectionPadding = 207,     // padding between sections not zero
    kSectionRawSize = 208,     // stated size impossible for the section
    kSectionChecksum = 209,    // section damaged
    kSectionFrame = 210,       // not exactly one zstd frame of the stated size
    kReserved = 301,           // reserved byte of the field section not zero
    kParameters = 302,         // parameters outside the format's limits
    kMemoryLimit = 303,        // more memory than the caller allows
    kNotFinite = 304,          // NaN or infinity
    kRadius = 305,             // radius not positive and normal
    kBounds = 306,             // box inverted or outside the sphere
    kHitMask = 307,            // hit mask cannot be decoded
    kUnusedTexel = 308,        // hit in a texel that holds no direction
    kDistances = 309,          // distances cannot be decoded
    kMeanDepth = 310,          // mean depth of a map without a hit is not 0
    kProvenance = 311,         // provenance is not JSON text
    kPayloadHash = 312,        // decoded, but not what was written
    kLineTable = 313,          // line table cannot be decoded
    kLineTransform = 314,      // map to the line table's unit sphere not invertible
    kDirectionMaps = 315,      // direction maps cannot be decoded
    kDirectionLevels = 316,    // levels of direction maps not from coarse to fine
    kVolume = 317,             // occlusion volume cannot be decoded
    kVolumeGrid = 318,         // an occlusion volume's spacing or blend that cannot be
    kNewerMinor = 901,         // warning: newer minor version
    kSkippedSection = 902,     // warning: unknown optional section
    kNoProvenance = 903,       // warning: no provenance
    kNoHit = 904,              // warning: every texel is a miss
};

// "section-checksum" and the like, for reports. "unknown" for numbers that are not listed.
std::string_view format_error_name(FormatErrorCode code);

namespace layout {

inline constexpr std::uint16_t kVersionMajor = 1;
inline constexpr std::uint16_t kVersionMinor = 2;

// As PNG's: a high bit for 7-bit channels, both line ends for those who convert them, Ctrl-Z for `type`.
inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'D', 'F', 'L', '\r', '\n', 0x1a, '\n'};

// Header.
inline constexpr std::size_t kMajorAt = 8;            // u16
inline constexpr std::size_t kMinorAt = 10;           // u16
inline constexpr std::size_t kSectionCountAt = 12;    // u32
inline constexpr std::size_t kFileBytesAt = 16;       // u64
inline constexpr std::size_t kHeaderChecksumAt = 24;  // u64
inline constexpr std::size_t kHeaderBytes = 32;
static_assert(kMagic.size() == kMajorAt && kHeaderChecksumAt + 8 == kHeaderBytes);

// Entry of the section table.
inline constexpr std::size_t kEntryIdAt = 0;         // 4 characters
inline constexpr std::size_t kEntryFlagsAt = 4;      // u32
inline constexpr std::size_t kEntryOffsetAt = 8;     // u64
inline constexpr std::size_t kEntryStoredAt = 16;    // u64
inline constexpr std::size_t kEntryRawAt = 24;       // u64
inline constexpr std::size_t kEntryChecksumAt = 32;  // u64
inline constexpr std::size_t kEntryBytes = 40;
static_assert(kEntryChecksumAt + 8 == kEntryBytes);

inline constexpr std::uint32_t kMaxSections = 64;
inline constexpr std::uint64_t kSectionAlignment = 8;
static_assert(kHeaderBytes % kSectionAlignment == 0 && kEntryBytes % kSectionAlignment == 0);
inline constexpr std::uint32_t kFlagOptional = 1;  // readers that do not know the section skip it

constexpr std::uint64_t align_section(std::uint64_t offset) {
    return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

// Sections, in the order in which they must come.
inline constexpr std::string_view kField = "FELD", kMask = "MASK", kDistances = "DIST", kMeanDepth = "MEAN",
                                  kLines = "LINE", kVolume = "VOLU", kSelfVisibility = "SELF",
                                  kProvenance = "PROV";
inline constexpr std::array<std::string_view, 8> kDirectionLevels = {"DM00", "DM01", "DM02", "DM03",
                                                                     "DM04", "DM05", "DM06", "DM07"};

// Section FELD.
inline constexpr std::size_t kPositionsAt = 0;     // u8
inline constexpr std::size_t kMappingAt = 1;       // u8
inline constexpr std::size_t kBitsAt = 2;          // u8
inline constexpr std::size_t kReserved8At = 3;     // u8, zero
inline constexpr std::size_t kSubdivisionAt = 4;   // u32
inline constexpr std::size_t kMapSizeAt = 8;       // u32
inline constexpr std::size_t kRadiusAt = 12;       // f32
inline constexpr std::size_t kCentreAt = 16;       // 3 f32
inline constexpr std::size_t kBoundsMinAt = 28;    // 3 f32
inline constexpr std::size_t kBoundsMaxAt = 40;    // 3 f32
inline constexpr std::size_t kReserved32At = 52;   // u32, zero
inline constexpr std::size_t kPayloadHashAt = 56;  // 16 bytes, big-endian as the hex digits
inline constexpr std::size_t kFieldBytes = 72;
static_assert(kBoundsMaxAt + 12 == kReserved32At && kPayloadHashAt + 16 == kFieldBytes);

// Section LINE: this header, then the coded table.
inline constexpr std::size_t kLineLatticeAt = 0;       // u16
inline constexpr std::size_t kLineDepthLatticeAt = 2;  // u16
inline constexpr std::size_t kLineDepthBitsAt = 4;     // u8
inline constexpr std::size_t kLineFlagsAt = 5;         // u8
inline constexpr std::size_t kLineReserved16At = 6;    // u16, zero
inline constexpr std::size_t kLineToUnitAt = 8;        // 9 f32, column after column
inline constexpr std::size_t kLineCentreAt = 44;       // 3 f32
inline constexpr std::size_t kLineHashedBytes = 56;    // the content hash begins with these
inline constexpr std::size_t kLineModeAt = 56;         // u8
inline constexpr std::size_t kLineReservedAt = 57;     // 7 bytes, zero
inline constexpr std::size_t kLineHashAt = 64;         // 16 bytes
inline constexpr std::size_t kLineHeaderBytes = 80;
inline constexpr std::uint8_t kLinePivot = 1, kLineEllipsoid = 2, kLineFiltered = 4;  // flags
static_assert(kLineCentreAt + 12 == kLineHashedBytes && kLineHashAt + 16 == kLineHeaderBytes);

// Sections DM00 to DM07: this header, then the coded maps.
inline constexpr std::size_t kDirectionSubdivisionAt = 0;  // u16
inline constexpr std::size_t kDirectionMapSizeAt = 2;      // u8
inline constexpr std::size_t kDirectionDepthSizeAt = 3;    // u8
inline constexpr std::size_t kDirectionReserved32At = 4;   // u32, zero
inline constexpr std::size_t kDirectionHashedBytes = 8;    // the content hash begins with these
inline constexpr std::size_t kDirectionModeAt = 8;         // u8
inline constexpr std::size_t kDirectionReservedAt = 9;     // 7 bytes, zero
inline constexpr std::size_t kDirectionHashAt = 16;        // 16 bytes
inline constexpr std::size_t kDirectionHeaderBytes = 32;
static_assert(kDirectionHashAt + 16 == kDirectionHeaderBytes);

// Section VOLU: this header, the far balls, the coded octants.
inline constexpr std::size_t kVolumeDimsAt = 0;         // 3 u16
inline constexpr std::size_t kVolumeFarSizeAt = 6;      // u16
inline constexpr std::size_t kVolumeOriginAt = 8;       // 3 f32
inline constexpr std::size_t kVolumeSpacingAt = 20;     // f32
inline constexpr std::size_t kVolumeBlendAt = 24;       // f32
inline constexpr std::size_t kVolumeReserved32At = 28;  // u32, zero
inline constexpr std::size_t kVolumeHashedBytes = 32;   // the content hash begins with these
inline constexpr std::size_t kVolumeHashAt = 32;        // 16 bytes
inline constexpr std::size_t kVolumeHeaderBytes = 48;
static_assert(kVolumeReserved32At + 4 == kVolumeHashedBytes && kVolumeHashAt + 16 == kVolumeHeaderBytes);

// How the content of LINE and DM00 to DM07 is stored.
inline constexpr std::uint8_t kPlainMode = 0, kModelledMode = 1;

}  // namespace layout
}  // namespace dfield
