// Takes .dfield files apart, and seals what was changed with checksums that are right: so that a test reaches
// the checks behind them.
#pragma once

#include <zstd.h>

#include <catch2/catch.hpp>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "format/bytes.hpp"
#include "format/file.hpp"
#include "format/hash.hpp"
#include "format/layout.hpp"
#include "tests/format/seal.hpp"

namespace dfield::test {

// A copy in a heap block of exactly its size: sanitizers see every read past the end.
class ExactCopy {
  public:
    explicit ExactCopy(std::span<const std::byte> bytes)
        : data_(new std::byte[bytes.size()]), size_(bytes.size()) {
        if (!bytes.empty()) std::memcpy(data_.get(), bytes.data(), size_);
    }
    operator std::span<const std::byte>() const { return {data_.get(), size_}; }

  private:
    std::unique_ptr<std::byte[]> data_;
    std::size_t size_;
};

inline Bytes zstd_frame(std::span<const std::byte> raw, int level = 1) {
    Bytes frame(ZSTD_compressBound(raw.size()));
    const std::size_t size = ZSTD_compress(frame.data(), frame.size(), raw.data(), raw.size(), level);
    REQUIRE(ZSTD_isError(size) == 0);
    frame.resize(size);
    return frame;
}

struct FileEditor {
    struct Section {
        std::string id;
        std::uint32_t flags;
        Bytes raw;
        // Stored instead of `raw`, and said to have raw_bytes, when not empty.
        Bytes frame;
        std::uint64_t raw_bytes;
    };
    std::uint16_t major = layout::kVersionMajor, minor = layout::kVersionMinor;
    std::vector<Section> sections;

    explicit FileEditor(std::span<const std::byte> bytes) {
        for (const SectionInfo& info : read_file_info(bytes).sections) {
            Section section{info.id, info.flags, Bytes(info.raw_bytes), {}, 0};
            const std::size_t size = ZSTD_decompress(section.raw.data(), section.raw.size(),
                                                     &bytes[info.offset], info.stored_bytes);
            REQUIRE(size == info.raw_bytes);
            sections.push_back(std::move(section));
        }
    }

    std::size_t index(const std::string& id) const {
        for (std::size_t i = 0; i < sections.size(); ++i)
            if (sections[i].id == id) return i;
        FAIL("no section " + id);
        return 0;
    }
    Section& operator[](const std::string& id) { return sections[index(id)]; }
    void erase(const std::string& id) {
        sections.erase(sections.begin() + static_cast<std::ptrdiff_t>(index(id)));
    }

    Bytes build() const {
        Bytes bytes(layout::kHeaderBytes + sections.size() * layout::kEntryBytes);
        for (std::size_t i = 0; i < layout::kMagic.size(); ++i) bytes[i] = std::byte{layout::kMagic[i]};
        store_le(&bytes[layout::kMajorAt], major);
        store_le(&bytes[layout::kMinorAt], minor);
        store_le(&bytes[layout::kSectionCountAt], static_cast<std::uint32_t>(sections.size()));
        for (std::size_t i = 0; i < sections.size(); ++i) {
            const Section& section = sections[i];
            const Bytes frame = section.frame.empty() ? zstd_frame(section.raw) : section.frame;
            bytes.resize(layout::align_section(bytes.size()));
            std::byte* entry = &bytes[layout::kHeaderBytes + i * layout::kEntryBytes];
            std::memcpy(entry + layout::kEntryIdAt, section.id.data(), 4);
            store_le(entry + layout::kEntryFlagsAt, section.flags);
            store_le(entry + layout::kEntryOffsetAt, std::uint64_t{bytes.size()});
            store_le(entry + layout::kEntryStoredAt, std::uint64_t{frame.size()});
            store_le(entry + layout::kEntryRawAt,
                     section.frame.empty() ? section.raw.size() : section.raw_bytes);
            bytes.insert(bytes.end(), frame.begin(), frame.end());
        }
        store_le(&bytes[layout::kFileBytesAt], std::uint64_t{bytes.size()});
        seal(bytes);
        return bytes;
    }
};

// The code and the message with which read_field refuses the bytes; validate_file must agree.
struct Refusal {
    FormatErrorCode code;
    std::string message;
};
inline Refusal refusal(std::span<const std::byte> bytes, const ReadLimits& limits = {}) {
    const ExactCopy exact(bytes);
    try {
        read_field(exact, {limits});
    } catch (const FormatError& error) {
        for (const Finding& finding : validate_file(exact, limits))
            if (finding.severity == Finding::Severity::kError)
                return {finding.code == error.code() ? error.code() : FormatErrorCode{0}, error.what()};
        return {FormatErrorCode{0}, "validate_file found nothing"};
    }
    return {FormatErrorCode{0}, "accepted"};
}

inline void check_refused(std::span<const std::byte> bytes, FormatErrorCode code,
                          const ReadLimits& limits = {}) {
    const Refusal result = refusal(bytes, limits);
    INFO(result.message);
    CHECK(format_error_name(result.code) == format_error_name(code));
    CHECK(result.message.size() > 30);
}

inline bool accepted(std::span<const std::byte> bytes) {
    const ExactCopy exact(bytes);
    const std::vector<Finding> findings = validate_file(exact);
    try {
        read_field(exact);
    } catch (const FormatError& error) {
        UNSCOPED_INFO(error.what());
        return false;
    }
    for (const Finding& finding : findings)
        if (finding.severity == Finding::Severity::kError) return false;
    return true;
}

}  // namespace dfield::test
