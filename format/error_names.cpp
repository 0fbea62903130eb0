#include "format/layout.hpp"

namespace dfield {

std::string_view format_error_name(FormatErrorCode code) {
    switch (code) {
        case FormatErrorCode::kTooShort:
            return "too-short";
        case FormatErrorCode::kMagic:
            return "magic";
        case FormatErrorCode::kVersion:
            return "version";
        case FormatErrorCode::kFileSize:
            return "file-size";
        case FormatErrorCode::kSectionCount:
            return "section-count";
        case FormatErrorCode::kHeaderChecksum:
            return "header-checksum";
        case FormatErrorCode::kSectionFlags:
            return "section-flags";
        case FormatErrorCode::kSectionOrder:
            return "section-order";
        case FormatErrorCode::kSectionUnknown:
            return "section-unknown";
        case FormatErrorCode::kSectionMissing:
            return "section-missing";
        case FormatErrorCode::kSectionUnexpected:
            return "section-unexpected";
        case FormatErrorCode::kSectionPlacement:
            return "section-placement";
        case FormatErrorCode::kSectionPadding:
            return "section-padding";
        case FormatErrorCode::kSectionRawSize:
            return "section-raw-size";
        case FormatErrorCode::kSectionChecksum:
            return "section-checksum";
        case FormatErrorCode::kSectionFrame:
            return "section-frame";
        case FormatErrorCode::kReserved:
            return "reserved";
        case FormatErrorCode::kParameters:
            return "parameters";
        case FormatErrorCode::kMemoryLimit:
            return "memory-limit";
        case FormatErrorCode::kNotFinite:
            return "not-finite";
        case FormatErrorCode::kRadius:
            return "radius";
        case FormatErrorCode::kBounds:
            return "bounds";
        case FormatErrorCode::kHitMask:
            return "hit-mask";
        case FormatErrorCode::kUnusedTexel:
            return "unused-texel";
        case FormatErrorCode::kDistances:
            return "distances";
        case FormatErrorCode::kMeanDepth:
            return "mean-depth";
        case FormatErrorCode::kProvenance:
            return "provenance";
        case FormatErrorCode::kPayloadHash:
            return "payload-hash";
        case FormatErrorCode::kLineTable:
            return "line-table";
        case FormatErrorCode::kLineTransform:
            return "line-transform";
        case FormatErrorCode::kDirectionMaps:
            return "direction-maps";
        case FormatErrorCode::kDirectionLevels:
            return "direction-levels";
        case FormatErrorCode::kVolume:
            return "volume";
        case FormatErrorCode::kVolumeGrid:
            return "volume-grid";
        case FormatErrorCode::kNewerMinor:
            return "newer-minor";
        case FormatErrorCode::kSkippedSection:
            return "skipped-section";
        case FormatErrorCode::kNoProvenance:
            return "no-provenance";
        case FormatErrorCode::kNoHit:
            return "no-hit";
    }
    return "unknown";
}

}  // namespace dfield
