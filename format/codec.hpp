// Texels, mean depths and self visibilities to the raw bytes of their sections and back. FORMAT.md, "Codec",
// is normative. Decoding is safe on any bytes; it is linear in the texels, whatever the bytes are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "format/field.hpp"

namespace dfield::codec {

struct RawSize {
    std::uint64_t smallest, largest;
};

// What the raw bytes of a section can be, from the parameters alone. Parameters are within the format's
// limits.
RawSize mask_size(const FieldParameters& parameters);
RawSize distances_size(const FieldParameters& parameters);

// Bytes of the unpacked hit mask.
std::uint64_t plane_bytes(const FieldParameters& parameters);

// Fills `plane` (plane_bytes, zeroed) from a MASK section. False when the bytes are no such section. Scratch
// comes from `memory`: 64 KiB, 12 bytes a positional sample, 12 bytes a texel of one row.
bool decode_mask(const FieldParameters& parameters, std::span<const std::byte> raw,
                 std::span<std::uint8_t> plane, std::pmr::memory_resource* memory);

// Fills `texels` (texel_bytes) from a DIST section. False when the bytes are no such section. 8, 16 and 32
// bit only. Every value that it stores is valid. Scratch: 12 bytes a positional sample, 48 bytes a texel of
// one row.
bool decode_distances(const FieldParameters& parameters, std::span<const std::byte> raw,
                      std::span<const std::uint8_t> plane, std::span<std::uint8_t> texels,
                      std::pmr::memory_resource* memory);

// 1 bit texels: the plane without the padding of its rows.
void pack_plane(const FieldParameters& parameters, std::span<const std::uint8_t> plane,
                std::span<std::uint8_t> texels);

// `raw` holds two bytes a value.
void decode_mean_depth(const FieldParameters& parameters, std::span<const std::byte> raw,
                       std::span<std::uint16_t> values, std::pmr::memory_resource* memory);
void decode_self_visibility(std::span<const std::byte> raw, std::span<std::uint16_t> values);

// The writing half: codec_encode.cpp, library dfield_format_write. Texels must be valid (writer.cpp sees to
// that).
std::vector<std::uint8_t> plane_of_texels(const FieldParameters& parameters,
                                          std::span<const std::uint8_t> texels);
std::vector<std::byte> encode_mask(const FieldParameters& parameters, std::span<const std::uint8_t> plane);

// The section, and where its streams end: streams hold bytes of different statistics.
struct EncodedDistances {
    std::vector<std::byte> raw;
    std::vector<std::size_t> stream_ends;
};
EncodedDistances encode_distances(const FieldParameters& parameters, std::span<const std::uint8_t> plane,
                                  std::span<const std::uint8_t> texels);
std::vector<std::byte> encode_mean_depth(const FieldParameters& parameters,
                                         std::span<const std::uint16_t> values);
std::vector<std::byte> encode_self_visibility(std::span<const std::uint16_t> values);

}  // namespace dfield::codec
