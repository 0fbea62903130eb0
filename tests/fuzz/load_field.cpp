// libFuzzer: .dfield files behind right checksums, and the raw bytes of line tables, direction maps and
// occlusion volumes.
// Whatever is accepted must be a field that the writer accepts, and come back the same.
#include <cstring>
#include <vector>

#include "format/file.hpp"
#include "format/layout.hpp"
#include "format/sections.hpp"
#include "format/writer.hpp"
#include "tests/format/seal.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace dfield;
using fuzz::require, test::Bytes;

constexpr ReadLimits kLimits{.max_texel_bytes = 1 << 14,
                             .max_self_vertices = 1 << 10,
                             .max_line_bytes = 1 << 12,
                             .max_direction_bytes = 1 << 13,
                             .max_volume_bytes = 1 << 13};

void try_file(Bytes bytes) {
    if (bytes.size() >= layout::kHeaderBytes)
        store_le(&bytes[layout::kFileBytesAt], std::uint64_t{bytes.size()});
    test::seal(bytes);  // or no mutation would get far
    bool valid = true;
    for (const Finding& finding : validate_file(bytes, kLimits))
        valid = valid && finding.severity == Finding::Severity::kWarning;
    try {
        const DisplacementField field = read_field(bytes, {kLimits});
        require(valid);
        require(payload_hash(read_field(write_field(field, {.zstd_level = 1}))) == payload_hash(field));
    } catch (const FormatError&) {
        require(!valid);
    }
}

// A section with the hash that its content has, so that what decodes is accepted.
template<class Table, class Decode, class Encode>
void try_section(Bytes raw, std::size_t header_bytes, const Decode& decode, const Encode& encode) {
    if (raw.size() < header_bytes) return;
    Table table;
    const auto error = decode(raw, kLimits.max_direction_bytes, table, std::pmr::get_default_resource());
    if (error && error->code != FormatErrorCode::kPayloadHash) return;
    const Bytes again = encode(table);
    Table same;
    require(!decode(again, kLimits.max_direction_bytes, same, std::pmr::get_default_resource()));
    require(encode(same) == again);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes bytes(size);
    if (size > 0) std::memcpy(bytes.data(), data, size);
    if (size >= layout::kMagic.size() &&
        std::memcmp(data, layout::kMagic.data(), layout::kMagic.size()) == 0) {
        try_file(std::move(bytes));
    } else if (size > 0) {
        const int kind = data[0] % 3;
        bytes.erase(bytes.begin());
        const auto decode_octants = [](const Bytes& raw, std::uint64_t most, OcclusionVolume& volume, auto*) {
            return decode_volume(raw, most, volume);
        };
        if (kind == 0)
            try_section<LineTable>(std::move(bytes), layout::kLineHeaderBytes, decode_lines, encode_lines);
        else if (kind == 1)
            try_section<OcclusionVolume>(std::move(bytes), layout::kVolumeHeaderBytes, decode_octants,
                                         encode_volume);
        else
            try_section<DirectionMaps>(std::move(bytes), layout::kDirectionHeaderBytes, decode_directions,
                                       encode_directions);
    }
    return 0;
}
