#include "format/hash.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "format/bytes.hpp"
#include "format/layout.hpp"

namespace dfield {
namespace {

// Words are hashed as they are stored, in chunks so that nothing is allocated.
void update_words(XXH3_state_t& state, const std::pmr::vector<std::uint16_t>& words) {
    std::array<std::uint8_t, 4096> chunk;
    for (std::size_t i = 0; i < words.size();) {
        std::size_t used = 0;
        for (; used < chunk.size() && i < words.size(); used += 2, ++i) store_le(&chunk[used], words[i]);
        XXH3_128bits_update(&state, chunk.data(), used);
    }
}

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

std::array<std::byte, 16> payload_digest(const DisplacementField& field) {
    XXH3_state_t state;
    XXH3_128bits_reset(&state);
    const auto prefix = field_section_prefix(field);
    XXH3_128bits_update(&state, prefix.data(), prefix.size());
    XXH3_128bits_update(&state, field.texels.data(), field.texels.size());
    update_words(state, field.mean_depth);
    update_words(state, field.self_visibility);
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(&state));
    std::array<std::byte, 16> digest;
    for (std::size_t i = 0; i < digest.size(); ++i) digest[i] = std::byte{canonical.digest[i]};
    return digest;
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
