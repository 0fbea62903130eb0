#include <algorithm>
#include <bit>

#include "format/bytes.hpp"
#include "format/codec.hpp"
#include "format/container.hpp"
#include "format/contents.hpp"
#include "format/file.hpp"
#include "format/hash.hpp"
#include "format/reader.hpp"
#include "format/sections.hpp"

namespace dfield {
namespace {

using Code = FormatErrorCode;

constexpr const char* kBakeAgain = "; bake again";

}  // namespace

void FieldReader::read(DisplacementField& field) {
    if (!read_field_section(field) || !check_section_set(stored_) || !check_raw_sizes(stored_)) return;
    if (options_.maps && has_maps(stored_)) read_texels(field);
    if (options_.lines) read_lines(field);
    read_directions(field);
    if (options_.volume) read_volume(field);
    if (options_.self_visibility) read_self_visibility(field);
    read_provenance(field);
    if (report_.error_count() == 0 && covers_hash() && field_digest(field) != digest_)
        report_.error(Code::kPayloadHash, find_section(info_, layout::kField)->offset,
                      "the decoded field is not what was written" + std::string(kBakeAgain));
}

bool FieldReader::covers_hash() const {
    return (options_.maps || !has_maps(stored_)) &&
           (options_.self_visibility || find_section(info_, layout::kSelfVisibility) == nullptr);
}

// FELD says what the other sections must hold.
bool FieldReader::read_field_section(DisplacementField& field) {
    const SectionInfo* section = find_section(info_, layout::kField);
    if (section == nullptr)
        return report_.error(Code::kSectionMissing, layout::kHeaderBytes,
                             "there is no section FELD" + std::string(kBakeAgain));
    if (section->raw_bytes != layout::kFieldBytes)
        return raw_size_error(*section, layout::kFieldBytes, layout::kFieldBytes);
    const auto raw = decompress_section(bytes_, *section, report_, memory_);
    if (!raw) return false;
    const std::byte* const at = raw->data();

    FieldParameters& p = stored_;
    p.positions = static_cast<Positions>(at[layout::kPositionsAt]);
    p.mapping = static_cast<Mapping>(at[layout::kMappingAt]);
    p.bits = std::to_integer<std::uint32_t>(at[layout::kBitsAt]);
    p.subdivision = load_le<std::uint32_t>(at + layout::kSubdivisionAt);
    p.map_size = load_le<std::uint32_t>(at + layout::kMapSizeAt);
    field.radius = load_float(at + layout::kRadiusAt);
    for (int axis = 0; axis < 3; ++axis) {
        field.centre[axis] = load_float(at + layout::kCentreAt + 4 * axis);
        field.bounds_min[axis] = load_float(at + layout::kBoundsMinAt + 4 * axis);
        field.bounds_max[axis] = load_float(at + layout::kBoundsMaxAt + 4 * axis);
    }
    std::copy_n(at + layout::kPayloadHashAt, digest_.size(), digest_.begin());

    if (at[layout::kReserved8At] != std::byte{0} || load_le<std::uint32_t>(at + layout::kReserved32At) != 0)
        report_.error(Code::kReserved, section->offset,
                      "a reserved byte of section FELD is not 0" + std::string(kBakeAgain));
    for (const ContentError& error : sphere_errors(field))
        report_.error(error.code, section->offset, error.message + kBakeAgain);
    if (const std::string error = parameters_error(p); !error.empty())
        return report_.error(Code::kParameters, section->offset, error);
    field.parameters = options_.maps ? p : kNoMaps;
    if (texel_bytes(field.parameters) > options_.limits.max_texel_bytes)
        return report_.error(
            Code::kMemoryLimit, section->offset,
            "the maps take " + std::to_string(texel_bytes(p)) + " bytes, the reader's limit is " +
                std::to_string(options_.limits.max_texel_bytes) + "; raise it or bake a smaller field");
    return true;
}

bool FieldReader::check_section_set(const FieldParameters& p) {
    bool good = true;
    const auto require = [&](std::string_view id, bool needed) {
        const SectionInfo* section = find_section(info_, id);
        const std::string field = " of a field with " + std::to_string(p.bits) + " bits a texel";
        if (needed && section == nullptr)
            good = report_.error(Code::kSectionMissing, layout::kHeaderBytes,
                                 "section " + std::string(id) + field + " is missing" + kBakeAgain);
        if (!needed && section != nullptr)
            good = report_.error(Code::kSectionUnexpected, section->offset,
                                 "section " + std::string(id) + " is no part" + field + kBakeAgain);
    };
    require(layout::kMask, has_maps(p));
    require(layout::kDistances, has_maps(p) && p.bits != 1);
    require(layout::kMeanDepth, p.bits == 1);
    bool before = true;
    for (const std::string_view id : layout::kDirectionLevels) {
        const SectionInfo* section = find_section(info_, id);
        if (section != nullptr && !before)
            good = report_.error(
                Code::kSectionMissing, section->offset,
                "the level of direction maps before section " + std::string(id) + " is missing" + kBakeAgain);
        before = section != nullptr;
    }
    if (!has_maps(p) && find_section(info_, layout::kLines) == nullptr &&
        find_section(info_, layout::kDirectionLevels[0]) == nullptr &&
        find_section(info_, layout::kVolume) == nullptr)
        good = report_.error(Code::kSectionMissing, layout::kHeaderBytes,
                             "there are neither displacement maps nor a line table nor direction maps nor an "
                             "occlusion volume" +
                                 std::string(kBakeAgain));
    return good;
}

bool FieldReader::check_raw_sizes(const FieldParameters& p) {
    bool good = true;
    const ReadLimits& limits = options_.limits;
    const auto check = [&](std::string_view id, std::uint64_t smallest, std::uint64_t largest,
                           std::uint64_t step) {
        const SectionInfo* section = find_section(info_, id);
        if (section != nullptr &&
            (section->raw_bytes < smallest || section->raw_bytes > largest || section->raw_bytes % step != 0))
            good = raw_size_error(*section, smallest, largest);
    };
    if (options_.maps && has_maps(p)) {
        const codec::RawSize mask = codec::mask_size(p);
        check(layout::kMask, mask.smallest, mask.largest, 1);
        if (p.bits != 1) {
            const codec::RawSize distances = codec::distances_size(p);
            check(layout::kDistances, distances.smallest, distances.largest, 1);
        } else {
            check(layout::kMeanDepth, 2 * position_count(p), 2 * position_count(p), 2);
        }
    }
    if (options_.lines)
        check(layout::kLines, layout::kLineHeaderBytes,
              layout::kLineHeaderBytes + std::min(limits.max_line_bytes, kMaxLineTableBytes), 1);
    for (std::size_t level = 0; level < layout::kDirectionLevels.size(); ++level)
        if (level < options_.direction_levels)
            check(layout::kDirectionLevels[level], layout::kDirectionHeaderBytes,
                  layout::kDirectionHeaderBytes + std::min(limits.max_direction_bytes, kMaxDirectionBytes),
                  1);
    if (options_.volume)
        check(layout::kVolume, layout::kVolumeHeaderBytes,
              layout::kVolumeHeaderBytes + std::min(limits.max_volume_bytes, kMaxVolumeBytes), 1);
    if (options_.self_visibility)
        check(layout::kSelfVisibility, 2, 2 * std::min(limits.max_self_vertices, kMaxSelfVertices), 2);
    check(layout::kProvenance, 2, kMaxProvenanceBytes, 1);
    return good;
}

bool FieldReader::read_texels(DisplacementField& field) {
    const FieldParameters& p = field.parameters;
    std::pmr::vector<std::uint8_t> plane(codec::plane_bytes(p), memory_);
    const SectionInfo& mask = *find_section(info_, layout::kMask);
    {
        const auto raw = decompress_section(bytes_, mask, report_, memory_);
        if (!raw) return false;
        if (!codec::decode_mask(p, *raw, plane, memory_))
            return report_.error(Code::kHitMask, mask.offset,
                                 "the hit mask cannot be decoded" + std::string(kBakeAgain));
    }
    if (const auto error = unused_texel_error(p, plane))
        return report_.error(error->code, mask.offset, error->message + kBakeAgain);
    std::uint64_t hits = 0;
    for (const std::uint8_t byte : plane) hits += static_cast<std::uint64_t>(std::popcount(byte));
    if (hits == 0) report_.warning(Code::kNoHit, mask.offset, "no texel is a hit: the field hides nothing");

    if (p.bits == 1) {
        field.texels.resize(texel_bytes(p));
        codec::pack_plane(p, plane, field.texels);
        const SectionInfo& section = *find_section(info_, layout::kMeanDepth);
        const auto raw = decompress_section(bytes_, section, report_, memory_);
        if (!raw) return false;
        field.mean_depth.resize(position_count(p));
        codec::decode_mean_depth(p, *raw, field.mean_depth, memory_);
        if (const auto error = mean_depth_error(p, plane, field.mean_depth))
            return report_.error(error->code, section.offset, error->message + kBakeAgain);
        return true;
    }
    const SectionInfo& section = *find_section(info_, layout::kDistances);
    const std::uint64_t expected = codec::distances_size(p).smallest + hits * (p.bits / 8);
    if (section.raw_bytes != expected) return raw_size_error(section, expected, expected);
    const auto raw = decompress_section(bytes_, section, report_, memory_);
    if (!raw) return false;
    field.texels.resize(texel_bytes(p));
    if (!codec::decode_distances(p, *raw, plane, field.texels, memory_))
        return report_.error(Code::kDistances, section.offset,
                             "the distances cannot be decoded" + std::string(kBakeAgain));
    return true;
}

template<class Decode>
bool FieldReader::decode_section(const SectionInfo& section, const Decode& decode) {
    const auto raw = decompress_section(bytes_, section, report_, memory_);
    if (!raw) return false;
    const std::optional<ContentError> error = decode(*raw);
    return !error || report_.error(error->code, section.offset,
                                   "section " + section.id + ": " + error->message + kBakeAgain);
}

bool FieldReader::read_lines(DisplacementField& field) {
    const SectionInfo* section = find_section(info_, layout::kLines);
    if (section == nullptr) return true;
    LineTable& table = field.lines.emplace(memory_);
    const std::uint64_t limit = std::min(options_.limits.max_line_bytes, kMaxLineTableBytes);
    return decode_section(*section,
                          [&](const auto& raw) { return decode_lines(raw, limit, table, memory_); });
}

bool FieldReader::read_directions(DisplacementField& field) {
    std::uint64_t left = std::min(options_.limits.max_direction_bytes, kMaxDirectionBytes);
    field.directions.reserve(layout::kDirectionLevels.size());
    for (const std::string_view id : layout::kDirectionLevels) {
        const SectionInfo* section = find_section(info_, id);
        if (section == nullptr || field.directions.size() >= options_.direction_levels) return true;
        DirectionMaps& maps = field.directions.emplace_back(memory_);
        if (!decode_section(*section,
                            [&](const auto& raw) { return decode_directions(raw, left, maps, memory_); }))
            return false;
        left -= maps.memory_bytes();
        const std::size_t level = field.directions.size() - 1;
        if (level > 0 && !finer_level(field.directions[level - 1].parameters, maps.parameters))
            return report_.error(
                Code::kDirectionLevels, section->offset,
                "section " + section->id + " is no finer than the level before it" + kBakeAgain);
    }
    return true;
}

bool FieldReader::read_volume(DisplacementField& field) {
    const SectionInfo* section = find_section(info_, layout::kVolume);
    if (section == nullptr) return true;
    OcclusionVolume& volume = field.volume.emplace(memory_);
    const std::uint64_t limit = std::min(options_.limits.max_volume_bytes, kMaxVolumeBytes);
    return decode_section(*section, [&](const auto& raw) { return decode_volume(raw, limit, volume); });
}

bool FieldReader::read_self_visibility(DisplacementField& field) {
    const SectionInfo* section = find_section(info_, layout::kSelfVisibility);
    if (section == nullptr) return true;
    const auto raw = decompress_section(bytes_, *section, report_, memory_);
    if (!raw) return false;
    field.self_visibility.resize(raw->size() / 2);
    codec::decode_self_visibility(*raw, field.self_visibility);
    return true;
}

bool FieldReader::read_provenance(DisplacementField& field) {
    const SectionInfo* section = find_section(info_, layout::kProvenance);
    if (section == nullptr) {
        report_.warning(Code::kNoProvenance, layout::kHeaderBytes,
                        "there is no provenance: what was baked, and how, is not known");
        return true;
    }
    const auto raw = decompress_section(bytes_, *section, report_, memory_);
    if (!raw) return false;
    field.provenance.resize(raw->size());
    std::transform(raw->begin(), raw->end(), field.provenance.begin(),
                   [](std::byte b) { return static_cast<char>(b); });
    if (const auto error = provenance_error(field.provenance))
        return report_.error(error->code, section->offset, error->message + kBakeAgain);
    return true;
}

bool FieldReader::raw_size_error(const SectionInfo& section, std::uint64_t smallest, std::uint64_t largest) {
    return report_.error(Code::kSectionRawSize, section.offset,
                         "section " + section.id + " says " + std::to_string(section.raw_bytes) +
                             " raw bytes, it can have " + std::to_string(smallest) +
                             (smallest != largest ? " to " + std::to_string(largest) : std::string()) +
                             kBakeAgain);
}

DisplacementField read_field(std::span<const std::byte> bytes, const ReadOptions& options,
                             std::pmr::memory_resource* memory) {
    Report report;
    const FileInfo info = read_file_info(bytes);
    DisplacementField field(memory);
    FieldReader(bytes, info, options, report, memory).read(field);
    return field;
}

}  // namespace dfield
