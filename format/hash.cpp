#include "format/hash.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "format/bytes.hpp"
#include "format/layout.hpp"

namespace dfield {
namespace {

class Hash {
  public:
    Hash() { XXH3_128bits_reset(&state_); }
    void add(const void* bytes, std::size_t size) { XXH3_128bits_update(&state_, bytes, size); }
    template<class Bytes>
    void add_bytes(const Bytes& bytes) {
        static_assert(sizeof(bytes[0]) == 1);
        add(bytes.data(), bytes.size());
    }
    // Words are hashed as they are stored, in chunks so that nothing is allocated.
    template<class Word>
    void add_words(const std::pmr::vector<Word>& words) {
        std::array<std::uint8_t, 4096> chunk;
        for (std::size_t i = 0; i < words.size();) {
            std::size_t used = 0;
            for (; used < chunk.size() && i < words.size(); used += sizeof(Word), ++i)
                store_le(&chunk[used], words[i]);
            add(chunk.data(), used);
        }
    }
    Digest digest() const {
        XXH128_canonical_t canonical;
        XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(&state_));
        Digest digest;
        for (std::size_t i = 0; i < digest.size(); ++i) digest[i] = std::byte{canonical.digest[i]};
        return digest;
    }

  private:
    XXH3_state_t state_;
};

}  // namespace

std::uint64_t checksum64(std::span<const std::byte> bytes, std::uint64_t seed) {
    return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::uint64_t header_checksum(std::span<const std::byte> bytes, std::uint32_t section_count) {
    return checksum64(bytes.subspan(layout::kHeaderBytes, section_count * layout::kEntryBytes),
                      checksum64(bytes.first(layout::kHeaderChecksumAt)));
}

std::array<std::byte, 56> field_section_prefix(const DisplacementField& field) {
    static_assert(layout::kPayloadHashAt == 56);
    const FieldParameters& p = field.parameters;
    std::array<std::byte, layout::kPayloadHashAt> bytes{};
    store_le(&bytes[layout::kPositionsAt], static_cast<std::uint8_t>(p.positions));
    store_le(&bytes[layout::kMappingAt], static_cast<std::uint8_t>(p.mapping));
    store_le(&bytes[layout::kBitsAt], static_cast<std::uint8_t>(p.bits));
    store_le(&bytes[layout::kSubdivisionAt], p.subdivision);
    store_le(&bytes[layout::kMapSizeAt], p.map_size);
    store_float(&bytes[layout::kRadiusAt], field.radius);
    for (int axis = 0; axis < 3; ++axis) {
        store_float(&bytes[layout::kCentreAt + 4 * axis], field.centre[axis]);
        store_float(&bytes[layout::kBoundsMinAt + 4 * axis], field.bounds_min[axis]);
        store_float(&bytes[layout::kBoundsMaxAt + 4 * axis], field.bounds_max[axis]);
    }
    return bytes;
}

std::array<std::byte, 56> line_section_prefix(const LineTable& table) {
    static_assert(layout::kLineHashedBytes == 56);
    const LineParameters& p = table.parameters;
    std::array<std::byte, layout::kLineHashedBytes> bytes{};
    store_le(&bytes[layout::kLineLatticeAt], static_cast<std::uint16_t>(p.lattice));
    store_le(&bytes[layout::kLineDepthLatticeAt], static_cast<std::uint16_t>(p.depth_lattice));
    bytes[layout::kLineDepthBitsAt] = static_cast<std::byte>(p.depth_bits);
    bytes[layout::kLineFlagsAt] = static_cast<std::byte>((p.pivot ? layout::kLinePivot : 0) |
                                                         (p.ellipsoid ? layout::kLineEllipsoid : 0) |
                                                         (p.filtered ? layout::kLineFiltered : 0));
    for (int i = 0; i < 9; ++i)
        store_float(&bytes[layout::kLineToUnitAt + 4 * i], table.to_unit[i / 3][i % 3]);
    for (int i = 0; i < 3; ++i) store_float(&bytes[layout::kLineCentreAt + 4 * i], table.centre[i]);
    return bytes;
}

std::array<std::byte, 8> direction_section_prefix(const DirectionMaps& maps) {
    static_assert(layout::kDirectionHashedBytes == 8);
    const DirectionParameters& p = maps.parameters;
    std::array<std::byte, layout::kDirectionHashedBytes> bytes{};
    store_le(&bytes[layout::kDirectionSubdivisionAt], static_cast<std::uint16_t>(p.subdivision));
    bytes[layout::kDirectionMapSizeAt] = static_cast<std::byte>(p.map_size);
    bytes[layout::kDirectionDepthSizeAt] = static_cast<std::byte>(p.depth_size);
    return bytes;
}

std::array<std::byte, 32> volume_section_prefix(const OcclusionVolume& volume) {
    static_assert(layout::kVolumeHashedBytes == 32);
    std::array<std::byte, layout::kVolumeHashedBytes> bytes{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        store_le(&bytes[layout::kVolumeDimsAt + 2 * axis], static_cast<std::uint16_t>(volume.dims[axis]));
        store_float(&bytes[layout::kVolumeOriginAt + 4 * axis], volume.origin[static_cast<int>(axis)]);
    }
    store_le(&bytes[layout::kVolumeFarSizeAt], static_cast<std::uint16_t>(volume.far_size));
    store_float(&bytes[layout::kVolumeSpacingAt], volume.spacing);
    store_float(&bytes[layout::kVolumeBlendAt], volume.blend);
    return bytes;
}

Digest field_digest(const DisplacementField& field) {
    Hash hash;
    hash.add_bytes(field_section_prefix(field));
    hash.add_bytes(field.texels);
    hash.add_words(field.mean_depth);
    hash.add_words(field.self_visibility);
    return hash.digest();
}

Digest line_digest(const LineTable& table) {
    Hash hash;
    hash.add_bytes(line_section_prefix(table));
    hash.add_words(table.hits);
    hash.add_words(table.depths);
    return hash.digest();
}

Digest direction_digest(const DirectionMaps& maps) {
    static_assert(sizeof(PackedDirectionFrame) == 8 && sizeof(DirectionDepth) == 2);
    Hash hash;
    hash.add_bytes(direction_section_prefix(maps));
    hash.add(maps.frames.data(), 8 * maps.frames.size());
    hash.add_words(maps.texels);
    hash.add(maps.depths.data(), 2 * maps.depths.size());
    return hash.digest();
}

Digest volume_digest(const OcclusionVolume& volume) {
    Hash hash;
    hash.add_bytes(volume_section_prefix(volume));
    hash.add_words(volume.far);
    hash.add_words(volume.octants);
    return hash.digest();
}

Digest payload_digest(const DisplacementField& field) {
    const Digest of_field = field_digest(field);
    if (!field.lines && field.directions.empty() && !field.volume) return of_field;
    Hash hash;
    hash.add_bytes(of_field);
    const auto add_section = [&](std::string_view id, const Digest& digest) {
        hash.add_bytes(id);
        hash.add_bytes(digest);
    };
    if (field.lines) add_section(layout::kLines, line_digest(*field.lines));
    for (std::size_t level = 0; level < field.directions.size(); ++level)
        add_section(layout::kDirectionLevels.at(level), direction_digest(field.directions[level]));
    if (field.volume) add_section(layout::kVolume, volume_digest(*field.volume));
    return hash.digest();
}

std::string payload_hash(const DisplacementField& field) {
    std::string hex;
    for (const std::byte byte : payload_digest(field)) {
        hex += "0123456789abcdef"[std::to_integer<int>(byte) >> 4];
        hex += "0123456789abcdef"[std::to_integer<int>(byte) & 15];
    }
    return hex;
}

}  // namespace dfield
