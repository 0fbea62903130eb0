#include "format/sections.hpp"

#include <algorithm>

#include "format/bytes.hpp"
#include "format/codec_directions.hpp"
#include "format/codec_lines.hpp"
#include "format/codec_volume.hpp"
#include "format/hash.hpp"
#include "format/layout.hpp"

namespace dfield {
namespace {

using Code = FormatErrorCode;
using Bytes = std::span<const std::byte>;

ContentError content_error(Code code, std::size_t at, const std::string& message) {
    return {code, at, message};
}

std::optional<ContentError> reserved_error(Bytes raw, std::size_t at, std::size_t size) {
    const Bytes bytes = raw.subspan(at, size);
    if (std::all_of(bytes.begin(), bytes.end(), [](std::byte byte) { return byte == std::byte{0}; }))
        return std::nullopt;
    return content_error(Code::kReserved, at, "a reserved byte is not 0");
}

std::optional<ContentError> memory_error(std::uint64_t bytes, std::uint64_t max_bytes, const char* what) {
    if (bytes <= max_bytes) return std::nullopt;
    return content_error(Code::kMemoryLimit, 0,
                         std::string(what) + " would take " + std::to_string(bytes) +
                             " bytes, the reader's limit is " + std::to_string(max_bytes));
}

// Takes plain content off the front of `raw`; false where it is too short.
template<class Word>
bool take_words(Bytes& raw, std::pmr::vector<Word>& words) {
    if (raw.size() < words.size() * sizeof(Word)) return false;
    for (std::size_t i = 0; i < words.size(); ++i) words[i] = load_le<Word>(&raw[i * sizeof(Word)]);
    raw = raw.subspan(words.size() * sizeof(Word));
    return true;
}

bool states(Bytes raw, std::size_t at, const Digest& digest) {
    return std::equal(digest.begin(), digest.end(), raw.begin() + static_cast<std::ptrdiff_t>(at));
}

const char* const kOtherHash = "decoded, but not what was written";

bool decode_content(Bytes raw, std::uint8_t mode, LineTable& table, std::pmr::memory_resource* memory) {
    if (mode == layout::kPlainMode)
        return take_words(raw, table.hits) && take_words(raw, table.depths) && raw.empty();
    codec::RangeDecoder decoder(raw);
    codec::LineModel model(table.parameters, table.hits, table.depths, memory);
    return mode == layout::kModelledMode && model.code(decoder) && decoder.complete();
}

bool decode_content(Bytes raw, std::uint8_t mode, DirectionMaps& maps, std::pmr::memory_resource* memory) {
    if (mode == layout::kPlainMode) {
        const std::uint64_t frame_bytes = 8 * maps.frames.size(), depth_bytes = 2 * maps.depths.size();
        if (raw.size() != frame_bytes + 4 * maps.texels.size() + depth_bytes) return false;
        for (std::size_t i = 0; i < frame_bytes; ++i)
            maps.frames[i / 8][i % 8] = std::to_integer<std::uint8_t>(raw[i]);
        raw = raw.subspan(frame_bytes);
        if (!take_words(raw, maps.texels)) return false;
        for (std::size_t i = 0; i < maps.depths.size(); ++i)
            maps.depths[i] = {std::to_integer<std::uint8_t>(raw[2 * i]),
                              std::to_integer<std::uint8_t>(raw[2 * i + 1])};
        return true;
    }
    codec::RangeDecoder decoder(raw);
    codec::DirectionModel model(maps.parameters, maps.frames, maps.texels, maps.depths, memory);
    return mode == layout::kModelledMode && model.code(decoder) && decoder.complete();
}

}  // namespace

std::optional<ContentError> decode_lines(Bytes raw, std::uint64_t max_bytes, LineTable& table,
                                         std::pmr::memory_resource* memory) {
    LineParameters& p = table.parameters;
    p.lattice = load_le<std::uint16_t>(&raw[layout::kLineLatticeAt]);
    p.depth_lattice = load_le<std::uint16_t>(&raw[layout::kLineDepthLatticeAt]);
    p.depth_bits = std::to_integer<std::uint32_t>(raw[layout::kLineDepthBitsAt]);
    const auto flags = std::to_integer<std::uint8_t>(raw[layout::kLineFlagsAt]);
    p.pivot = (flags & layout::kLinePivot) != 0;
    p.filtered = (flags & layout::kLineFiltered) != 0;
    p.ellipsoid = (flags & layout::kLineEllipsoid) != 0;
    p.filtered = (flags & layout::kLineFiltered) != 0;
    for (int i = 0; i < 9; ++i) table.to_unit[i / 3][i % 3] = load_float(&raw[layout::kLineToUnitAt + 4 * i]);
    for (int i = 0; i < 3; ++i) table.centre[i] = load_float(&raw[layout::kLineCentreAt + 4 * i]);

    if (auto error = reserved_error(raw, layout::kLineReserved16At, 2)) return error;
    if (auto error = reserved_error(raw, layout::kLineReservedAt, 7)) return error;
    if ((flags & ~(layout::kLinePivot | layout::kLineEllipsoid | layout::kLineFiltered)) != 0)
        return content_error(Code::kReserved, layout::kLineFlagsAt, "a reserved flag is set");
    if (const std::string wrong = line_parameters_error(p); !wrong.empty())
        return content_error(Code::kParameters, layout::kLineLatticeAt, wrong);
    const std::uint64_t words = line_hit_words(p) + line_depth_words(p);
    if (auto error = memory_error(4 * words, max_bytes, "the line table")) return error;
    table.hits.resize(line_hit_words(p));
    table.depths.resize(line_depth_words(p));
    if (!decode_content(raw.subspan(layout::kLineHeaderBytes),
                        std::to_integer<std::uint8_t>(raw[layout::kLineModeAt]), table, memory))
        return content_error(Code::kLineTable, layout::kLineHeaderBytes, "the line table cannot be decoded");
    if (auto error = line_table_error(table)) return error;
    if (!states(raw, layout::kLineHashAt, line_digest(table)))
        return content_error(Code::kPayloadHash, layout::kLineHashAt, kOtherHash);
    return std::nullopt;
}

std::optional<ContentError> decode_directions(Bytes raw, std::uint64_t max_bytes, DirectionMaps& maps,
                                              std::pmr::memory_resource* memory) {
    DirectionParameters& p = maps.parameters;
    p.subdivision = load_le<std::uint16_t>(&raw[layout::kDirectionSubdivisionAt]);
    p.map_size = std::to_integer<std::uint32_t>(raw[layout::kDirectionMapSizeAt]);
    p.depth_size = std::to_integer<std::uint32_t>(raw[layout::kDirectionDepthSizeAt]);

    if (auto error = reserved_error(raw, layout::kDirectionReserved32At, 4)) return error;
    if (auto error = reserved_error(raw, layout::kDirectionReservedAt, 7)) return error;
    if (const std::string wrong = direction_parameters_error(p); !wrong.empty())
        return content_error(Code::kParameters, layout::kDirectionSubdivisionAt, wrong);
    const std::uint64_t directions = stored_direction_count(p.subdivision);
    const std::uint64_t words = directions * direction_map_words(p.map_size),
                        depths = directions * p.depth_size * p.depth_size;
    if (auto error = memory_error(8 * directions + 4 * words + 2 * depths, max_bytes, "the direction maps"))
        return error;
    maps.frames.resize(directions);
    maps.texels.resize(words);
    maps.depths.resize(depths);
    if (!decode_content(raw.subspan(layout::kDirectionHeaderBytes),
                        std::to_integer<std::uint8_t>(raw[layout::kDirectionModeAt]), maps, memory))
        return content_error(Code::kDirectionMaps, layout::kDirectionHeaderBytes,
                             "the direction maps cannot be decoded");
    if (auto error = direction_maps_error(maps)) return error;
    if (!states(raw, layout::kDirectionHashAt, direction_digest(maps)))
        return content_error(Code::kPayloadHash, layout::kDirectionHashAt, kOtherHash);
    return std::nullopt;
}

std::optional<ContentError> decode_volume(Bytes raw, std::uint64_t max_bytes, OcclusionVolume& volume) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        volume.dims[axis] = load_le<std::uint16_t>(&raw[layout::kVolumeDimsAt + 2 * axis]);
        volume.origin[static_cast<int>(axis)] = load_float(&raw[layout::kVolumeOriginAt + 4 * axis]);
    }
    volume.far_size = load_le<std::uint16_t>(&raw[layout::kVolumeFarSizeAt]);
    volume.spacing = load_float(&raw[layout::kVolumeSpacingAt]);
    volume.blend = load_float(&raw[layout::kVolumeBlendAt]);

    if (auto error = reserved_error(raw, layout::kVolumeReserved32At, 4)) return error;
    if (const std::string wrong = volume_dims_error(volume.dims, volume.far_size); !wrong.empty())
        return content_error(Code::kParameters, layout::kVolumeDimsAt, wrong);
    const std::uint64_t far = std::uint64_t{volume.far_size} * volume.far_size, samples = volume.samples();
    if (auto error = memory_error(4 * far + 8 * samples, max_bytes, "the occlusion volume")) return error;
    const Bytes content = raw.subspan(layout::kVolumeHeaderBytes);
    if (content.size() != 4 * far + 8 * samples)
        return content_error(Code::kVolume, layout::kVolumeHeaderBytes,
                             "the occlusion volume has other bytes than its dimensions say");
    volume.far.resize(far);
    for (std::size_t i = 0; i < far; ++i) volume.far[i] = load_le<std::uint32_t>(&content[4 * i]);
    const Bytes residuals = content.subspan(4 * far);
    volume.octants.resize(2 * samples);
    codec::for_octants(volume, [&](std::size_t octant, std::size_t sample, int expected) {
        volume.set_octant(sample, octant,
                          codec::unfold_residual(
                              std::to_integer<std::uint8_t>(residuals[octant * samples + sample]), expected));
    });
    if (auto error = volume_error(volume)) return error;
    if (!states(raw, layout::kVolumeHashAt, volume_digest(volume)))
        return content_error(Code::kPayloadHash, layout::kVolumeHashAt, kOtherHash);
    return std::nullopt;
}

}  // namespace dfield
