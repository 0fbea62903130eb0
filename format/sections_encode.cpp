// The writing half of sections.hpp.
#include <algorithm>

#include "format/bytes.hpp"
#include "format/codec_directions.hpp"
#include "format/codec_lines.hpp"
#include "format/codec_volume.hpp"
#include "format/hash.hpp"
#include "format/layout.hpp"
#include "format/sections.hpp"

namespace dfield {
namespace {

using Bytes = std::vector<std::byte>;

template<class Word>
void append_words(Bytes& bytes, const std::pmr::vector<Word>& words) {
    for (const Word word : words) {
        std::array<std::byte, sizeof(Word)> stored;
        store_le(stored.data(), word);
        bytes.insert(bytes.end(), stored.begin(), stored.end());
    }
}

// Header and content; what models cannot shrink is stored plain.
Bytes section(std::size_t header_bytes, std::span<const std::byte> prefix, std::size_t mode_at,
              std::size_t hash_at, const Digest& digest, const Bytes& modelled, const Bytes& plain) {
    const bool shorter = modelled.size() <= plain.size();
    Bytes raw(header_bytes);
    std::copy(prefix.begin(), prefix.end(), raw.begin());
    raw[mode_at] = std::byte{shorter ? layout::kModelledMode : layout::kPlainMode};
    std::copy(digest.begin(), digest.end(), raw.begin() + static_cast<std::ptrdiff_t>(hash_at));
    const Bytes& content = shorter ? modelled : plain;
    raw.insert(raw.end(), content.begin(), content.end());
    return raw;
}

}  // namespace

std::vector<std::byte> encode_lines(const LineTable& table) {
    LineTable work = table;  // the model takes what it could write to
    codec::RangeEncoder encoder;
    codec::LineModel(table.parameters, work.hits, work.depths, std::pmr::get_default_resource())
        .code(encoder);
    Bytes plain;
    append_words(plain, table.hits);
    append_words(plain, table.depths);
    return section(layout::kLineHeaderBytes, line_section_prefix(table), layout::kLineModeAt,
                   layout::kLineHashAt, line_digest(table), encoder.finish(), plain);
}

std::vector<std::byte> encode_directions(const DirectionMaps& maps) {
    DirectionMaps work = maps;
    codec::RangeEncoder encoder;
    codec::DirectionModel(maps.parameters, work.frames, work.texels, work.depths,
                          std::pmr::get_default_resource())
        .code(encoder);
    Bytes plain;
    for (const PackedDirectionFrame& frame : maps.frames)
        for (const std::uint8_t byte : frame) plain.push_back(std::byte{byte});
    append_words(plain, maps.texels);
    for (const DirectionDepth& depth : maps.depths)
        for (const std::uint8_t byte : {depth.nearest, depth.farthest}) plain.push_back(std::byte{byte});
    return section(layout::kDirectionHeaderBytes, direction_section_prefix(maps), layout::kDirectionModeAt,
                   layout::kDirectionHashAt, direction_digest(maps), encoder.finish(), plain);
}

std::vector<std::byte> encode_volume(const OcclusionVolume& volume) {
    const auto prefix = volume_section_prefix(volume);
    const Digest digest = volume_digest(volume);
    Bytes raw(layout::kVolumeHeaderBytes);
    std::copy(prefix.begin(), prefix.end(), raw.begin());
    std::copy(digest.begin(), digest.end(), raw.begin() + static_cast<std::ptrdiff_t>(layout::kVolumeHashAt));
    append_words(raw, volume.far);
    codec::for_octants(volume, [&](std::size_t octant, std::size_t sample, int expected) {
        raw.push_back(std::byte{codec::fold_residual(volume.octant(sample, octant), expected)});
    });
    return raw;
}

}  // namespace dfield
