#include "format/writer.hpp"

#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include "format/bytes.hpp"
#include "format/codec.hpp"
#include "format/contents.hpp"
#include "format/file.hpp"
#include "format/hash.hpp"
#include "format/layout.hpp"
#include "format/sections.hpp"

namespace dfield {
namespace {

void require(bool condition, const std::string& message) {
    if (!condition) throw std::invalid_argument("the field cannot be written: " + message);
}

void require_sizes(const DisplacementField& field) {
    const FieldParameters& p = field.parameters;
    const auto size = [](const char* what, std::uint64_t actual, std::uint64_t expected) {
        require(actual == expected, std::string(what) + " has " + std::to_string(actual) +
                                        " values instead of " + std::to_string(expected));
    };
    size("texels", field.texels.size(), texel_bytes(p));
    size("mean_depth", field.mean_depth.size(), p.bits == 1 ? position_count(p) : 0);
    std::uint64_t direction_bytes = 0;
    for (const DirectionMaps& maps : field.directions) direction_bytes += maps.memory_bytes();
    require(field.directions.size() <= kMaxDirectionLevels && direction_bytes <= kMaxDirectionBytes,
            "direction maps have more than " + std::to_string(kMaxDirectionLevels) + " levels or " +
                std::to_string(kMaxDirectionBytes) + " bytes");
    require(has_maps(p) || field.lines || !field.directions.empty() || field.volume,
            "it has neither displacement maps nor a line table nor direction maps nor an occlusion volume");
    require(field.self_visibility.size() <= kMaxSelfVertices,
            "self_visibility has more than " + std::to_string(kMaxSelfVertices) + " values");
}

// 8 and 16 bit have no invalid values.
void require_texels(const DisplacementField& field) {
    const FieldParameters& p = field.parameters;
    const std::uint64_t bytes = map_bytes(p), maps = position_count(p),
                        texels = std::uint64_t{p.map_size} * p.map_size;
    for (std::uint64_t map = 0; map < maps; ++map) {
        const std::uint8_t* at = field.texels.data() + map * bytes;
        if (p.bits == 32)
            for (std::uint64_t i = 0; i < texels; ++i) {
                const auto value = load_le<std::uint32_t>(at + 4 * i);  // negative zero is above 1 here
                require(
                    value <= std::bit_cast<std::uint32_t>(kMiss32),
                    "texel " + std::to_string(i) + " of map " + std::to_string(map) + " is not within 0..1");
            }
        if (p.bits == 1 && texels % 8 != 0)
            require(at[bytes - 1] >> texels % 8 == 0,
                    "padding bits of map " + std::to_string(map) + " are not 0");
    }
}

void require_good(const std::optional<ContentError>& error) {
    if (error) require(false, error->message);
}

void require_kinds(const DisplacementField& field) {
    if (field.lines) require_good(line_table_error(*field.lines));
    if (field.volume) require_good(volume_error(*field.volume));
    for (std::size_t level = 0; level < field.directions.size(); ++level) {
        require_good(direction_maps_error(field.directions[level]));
        require(
            level == 0 ||
                finer_level(field.directions[level - 1].parameters, field.directions[level].parameters),
            "level " + std::to_string(level) + " of the direction maps is no finer than the one before it");
    }
}

struct Section {
    std::string_view id;
    std::uint32_t flags = 0;
    std::vector<std::byte> raw;
    std::vector<std::size_t>
        ends;  // of coded residuals: where statistics change, and blocks of the frame end
    std::vector<std::byte> frame;
};

std::vector<std::byte> compress(const Section& section, int level) {
    const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), &ZSTD_freeCCtx);
    const auto check = [](std::size_t result) {
        if (ZSTD_isError(result) != 0)
            throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(result));
        return result;
    };
    if (context == nullptr) throw std::bad_alloc();
    check(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, level));
    if (!section.ends.empty()) {
        // Residuals repeat by chance only. Level 19's own, deeper search takes six times as long and makes
        // the frames of 32x32 maps 2% larger (of 64x64 maps 7% smaller).
        check(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_windowLog, 17));
        check(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_hashLog, 14));
        check(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_chainLog, 14));
        check(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_searchLog, 2));
    }
    check(ZSTD_CCtx_setPledgedSrcSize(context.get(),
                                      section.raw.size()));  // puts the content size into the frame
    std::vector<std::byte> frame(ZSTD_CStreamOutSize());
    ZSTD_outBuffer out{frame.data(), frame.size(), 0};
    std::size_t begin = 0;
    const auto feed = [&](std::size_t end, ZSTD_EndDirective directive) {
        ZSTD_inBuffer in{section.raw.data() + begin, end - begin, 0};
        while (check(ZSTD_compressStream2(context.get(), &out, &in, directive)) != 0 || in.pos < in.size) {
            frame.resize(2 * frame.size());
            out.dst = frame.data();
            out.size = frame.size();
        }
        begin = end;
    };
    for (const std::size_t end : section.ends)
        if (end > begin && end < section.raw.size()) feed(end, ZSTD_e_flush);
    feed(section.raw.size(), ZSTD_e_end);
    frame.resize(out.pos);
    return frame;
}

std::vector<Section> raw_sections(const DisplacementField& field, std::span<const std::uint8_t> plane) {
    const FieldParameters& p = field.parameters;
    std::vector<Section> sections;
    const auto prefix = field_section_prefix(field);
    const Digest digest = field_digest(field);
    Section head{layout::kField, 0, {prefix.begin(), prefix.end()}, {}, {}};
    head.raw.insert(head.raw.end(), digest.begin(), digest.end());
    sections.push_back(std::move(head));
    if (has_maps(p)) sections.push_back({layout::kMask, 0, codec::encode_mask(p, plane), {}, {}});
    if (p.bits == 1) {
        sections.push_back({layout::kMeanDepth,
                            0,
                            codec::encode_mean_depth(p, field.mean_depth),
                            {field.mean_depth.size()},
                            {}});
    } else if (has_maps(p)) {
        codec::EncodedDistances coded = codec::encode_distances(p, plane, field.texels);
        sections.push_back({layout::kDistances, 0, std::move(coded.raw), std::move(coded.stream_ends), {}});
    }
    if (field.lines)
        sections.push_back({layout::kLines, layout::kFlagOptional, encode_lines(*field.lines), {}, {}});
    for (std::size_t level = 0; level < field.directions.size(); ++level)
        sections.push_back({layout::kDirectionLevels[level],
                            layout::kFlagOptional,
                            encode_directions(field.directions[level]),
                            {},
                            {}});
    if (field.volume) {
        const std::size_t plane = field.volume->samples();
        Section volume{layout::kVolume, layout::kFlagOptional, encode_volume(*field.volume), {}, {}};
        for (std::size_t octants = kVolumeOctants; octants > 0; --octants)
            volume.ends.push_back(volume.raw.size() - octants * plane);
        sections.push_back(std::move(volume));
    }
    if (!field.self_visibility.empty())
        sections.push_back({layout::kSelfVisibility,
                            layout::kFlagOptional,
                            codec::encode_self_visibility(field.self_visibility),
                            {field.self_visibility.size()},
                            {}});
    if (!field.provenance.empty()) {
        Section provenance{layout::kProvenance, layout::kFlagOptional, {}, {}, {}};
        for (const char c : field.provenance) provenance.raw.push_back(static_cast<std::byte>(c));
        sections.push_back(std::move(provenance));
    }
    return sections;
}

std::vector<std::byte> assemble(const std::vector<Section>& sections) {
    const auto count = static_cast<std::uint32_t>(sections.size());
    std::vector<std::byte> bytes(layout::kHeaderBytes + count * layout::kEntryBytes);
    for (std::size_t i = 0; i < sections.size(); ++i) {
        const Section& section = sections[i];
        bytes.resize(layout::align_section(bytes.size()));
        std::byte* entry = &bytes[layout::kHeaderBytes + i * layout::kEntryBytes];
        for (std::size_t c = 0; c < 4; ++c)
            entry[layout::kEntryIdAt + c] = static_cast<std::byte>(section.id[c]);
        store_le(entry + layout::kEntryFlagsAt, section.flags);
        store_le(entry + layout::kEntryOffsetAt, std::uint64_t{bytes.size()});
        store_le(entry + layout::kEntryStoredAt, std::uint64_t{section.frame.size()});
        store_le(entry + layout::kEntryRawAt, std::uint64_t{section.raw.size()});
        store_le(entry + layout::kEntryChecksumAt, checksum64(section.frame));
        bytes.insert(bytes.end(), section.frame.begin(), section.frame.end());
    }
    for (std::size_t i = 0; i < layout::kMagic.size(); ++i) bytes[i] = std::byte{layout::kMagic[i]};
    store_le(&bytes[layout::kMajorAt], layout::kVersionMajor);
    store_le(&bytes[layout::kMinorAt], layout::kVersionMinor);
    store_le(&bytes[layout::kSectionCountAt], count);
    store_le(&bytes[layout::kFileBytesAt], std::uint64_t{bytes.size()});
    store_le(&bytes[layout::kHeaderChecksumAt], header_checksum(bytes, count));
    return bytes;
}

}  // namespace

std::vector<std::byte> write_field(const DisplacementField& field, const WriteOptions& options) {
    const std::string parameters = parameters_error(field.parameters);
    require(parameters.empty(), parameters);
    require_sizes(field);
    for (const ContentError& error : sphere_errors(field)) require(false, error.message);
    require_kinds(field);
    std::vector<std::uint8_t> plane;
    if (has_maps(field.parameters)) {
        require_texels(field);
        plane = codec::plane_of_texels(field.parameters, field.texels);
        require_good(unused_texel_error(field.parameters, plane));
        require_good(mean_depth_error(field.parameters, plane, field.mean_depth));
    }
    if (!field.provenance.empty()) require_good(provenance_error(field.provenance));

    std::vector<Section> sections = raw_sections(field, plane);
    const int level = std::clamp(options.zstd_level, ZSTD_minCLevel(), ZSTD_maxCLevel());
    const auto policy = options.threads > 1 ? std::launch::async : std::launch::deferred;
    std::vector<std::future<void>> tasks;
    for (Section& section : sections)
        tasks.push_back(std::async(policy, [&section, level] { section.frame = compress(section, level); }));
    for (auto& task : tasks) task.get();
    return assemble(sections);
}

}  // namespace dfield
