// Checksums that are right for changed bytes of a .dfield file: so that a test reaches the checks behind
// them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/bytes.hpp"
#include "format/hash.hpp"
#include "format/layout.hpp"

namespace dfield::test {

using Bytes = std::vector<std::byte>;

// Right checksums of the header, and of the sections that lie within the file.
inline void seal(Bytes& bytes) {
    if (bytes.size() < layout::kHeaderBytes) return;
    const std::uint32_t count = load_le<std::uint32_t>(&bytes[layout::kSectionCountAt]);
    if (count > (bytes.size() - layout::kHeaderBytes) / layout::kEntryBytes) return;
    for (std::uint32_t i = 0; i < count; ++i) {
        std::byte* entry = &bytes[layout::kHeaderBytes + i * layout::kEntryBytes];
        const std::uint64_t offset = load_le<std::uint64_t>(entry + layout::kEntryOffsetAt);
        const std::uint64_t size = load_le<std::uint64_t>(entry + layout::kEntryStoredAt);
        if (offset <= bytes.size() && size <= bytes.size() - offset)
            store_le(entry + layout::kEntryChecksumAt, checksum64(std::span(bytes).subspan(offset, size)));
    }
    store_le(&bytes[layout::kHeaderChecksumAt], header_checksum(bytes, count));
}

}  // namespace dfield::test
