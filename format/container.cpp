#include "format/container.hpp"

#include <zstd.h>

#include <algorithm>
#include <array>

#include "format/bytes.hpp"
#include "format/hash.hpp"

namespace dfield {
namespace {

using Code = FormatErrorCode;

constexpr const char* kDamaged = "; the file is damaged: copy it again or bake again";

std::string version_name(unsigned major, unsigned minor) {
    return std::to_string(major) + "." + std::to_string(minor);
}

struct KnownSection {
    std::string_view id;
    bool optional;
};
constexpr auto kKnownSections = [] {
    std::array<KnownSection, 8 + layout::kDirectionLevels.size()> sections{};
    std::size_t count = 0;
    const auto add = [&](std::string_view id, bool optional) { sections[count++] = {id, optional}; };
    for (const auto id : {layout::kField, layout::kMask, layout::kDistances, layout::kMeanDepth})
        add(id, false);
    add(layout::kLines, true);
    for (const auto id : layout::kDirectionLevels) add(id, true);
    for (const auto id : {layout::kVolume, layout::kSelfVisibility, layout::kProvenance}) add(id, true);
    return sections;
}();

// Ids may hold any bytes; messages hold only letters, digits and dots for the rest.
std::string printable(const std::string& id) {
    std::string result = id;
    for (char& c : result)
        if (!((c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'))) c = '.';
    return result;
}

bool all_zero(std::span<const std::byte> bytes) {
    return std::all_of(bytes.begin(), bytes.end(), [](std::byte byte) { return byte == std::byte{0}; });
}

}  // namespace

std::optional<FileInfo> parse_header(std::span<const std::byte> bytes, Report& report) {
    if (bytes.size() < layout::kHeaderBytes) {
        report.error(Code::kTooShort, bytes.size(),
                     "the file has " + std::to_string(bytes.size()) + " bytes, a .dfield header " +
                         std::to_string(layout::kHeaderBytes) + "; it is truncated or no .dfield file");
        return std::nullopt;
    }
    for (std::size_t i = 0; i < layout::kMagic.size(); ++i)
        if (std::to_integer<std::uint8_t>(bytes[i]) != layout::kMagic[i]) {
            report.error(
                Code::kMagic, i,
                "not a .dfield file, or one that a transfer in text mode has changed; bake the model again");
            return std::nullopt;
        }
    FileInfo info;
    info.version_major = load_le<std::uint16_t>(&bytes[layout::kMajorAt]);
    info.version_minor = load_le<std::uint16_t>(&bytes[layout::kMinorAt]);
    info.file_bytes = load_le<std::uint64_t>(&bytes[layout::kFileBytesAt]);
    const std::uint32_t count = load_le<std::uint32_t>(&bytes[layout::kSectionCountAt]);
    if (info.version_major != layout::kVersionMajor) {
        report.error(Code::kVersion, layout::kMajorAt,
                     "the file is of format version " + version_name(info.version_major, info.version_minor) +
                         ", this reader knows version " +
                         version_name(layout::kVersionMajor, layout::kVersionMinor) +
                         "; bake again with a dfield of this version" +
                         (info.version_major > layout::kVersionMajor ? ", or update this one" : ""));
        return std::nullopt;
    }
    if (info.file_bytes != bytes.size()) {
        report.error(Code::kFileSize, std::min<std::uint64_t>(info.file_bytes, bytes.size()),
                     "the file has " + std::to_string(bytes.size()) + " bytes, its header says " +
                         std::to_string(info.file_bytes) + "; it is " +
                         (bytes.size() < info.file_bytes ? "truncated" : "extended") +
                         ": copy it again or bake again");
        return std::nullopt;
    }
    if (count == 0 || count > layout::kMaxSections ||
        bytes.size() - layout::kHeaderBytes < std::size_t{count} * layout::kEntryBytes) {
        report.error(Code::kSectionCount, layout::kSectionCountAt,
                     "the header says " + std::to_string(count) + " sections, which cannot be" + kDamaged);
        return std::nullopt;
    }
    if (load_le<std::uint64_t>(&bytes[layout::kHeaderChecksumAt]) != header_checksum(bytes, count)) {
        report.error(Code::kHeaderChecksum, layout::kHeaderChecksumAt,
                     std::string("the checksum of the header and the section table is wrong") + kDamaged);
        return std::nullopt;
    }
    if (info.version_minor > layout::kVersionMinor)
        report.warning(Code::kNewerMinor, layout::kMinorAt,
                       "the file is of format version " +
                           version_name(info.version_major, info.version_minor) + ", newer than " +
                           version_name(layout::kVersionMajor, layout::kVersionMinor) +
                           ": what it adds is ignored");
    for (std::size_t i = 0; i < count; ++i) {
        const std::byte* entry = &bytes[layout::kHeaderBytes + i * layout::kEntryBytes];
        SectionInfo& section = info.sections.emplace_back();
        for (std::size_t c = 0; c < 4; ++c) section.id += static_cast<char>(entry[layout::kEntryIdAt + c]);
        section.flags = load_le<std::uint32_t>(entry + layout::kEntryFlagsAt);
        section.offset = load_le<std::uint64_t>(entry + layout::kEntryOffsetAt);
        section.stored_bytes = load_le<std::uint64_t>(entry + layout::kEntryStoredAt);
        section.raw_bytes = load_le<std::uint64_t>(entry + layout::kEntryRawAt);
        section.checksum = load_le<std::uint64_t>(entry + layout::kEntryChecksumAt);
    }
    return info;
}

bool check_sections(std::span<const std::byte> bytes, const FileInfo& info, Report& report) {
    std::uint64_t end = layout::kHeaderBytes + info.sections.size() * layout::kEntryBytes;
    std::size_t next_known = 0;
    for (std::size_t i = 0; i < info.sections.size(); ++i) {
        const SectionInfo& section = info.sections[i];
        const std::uint64_t entry = layout::kHeaderBytes + i * layout::kEntryBytes;
        const std::string name = "section " + std::to_string(i) + " (" + printable(section.id) + ")";
        const bool optional = (section.flags & layout::kFlagOptional) != 0;

        const auto known = std::find_if(kKnownSections.begin(), kKnownSections.end(),
                                        [&](const KnownSection& k) { return k.id == section.id; });
        const bool reserved_flags = (section.flags & ~layout::kFlagOptional) != 0;
        if (reserved_flags || (known != kKnownSections.end() && known->optional != optional))
            report.error(
                Code::kSectionFlags, entry + layout::kEntryFlagsAt,
                name + " has flags " + std::to_string(section.flags) + ", which it cannot have; bake again");
        if (known != kKnownSections.end()) {
            const auto place = static_cast<std::size_t>(known - kKnownSections.begin());
            if (place < next_known)
                report.error(Code::kSectionOrder, entry,
                             name + " is out of order or there twice; bake again");
            next_known = std::max(next_known, place + 1);
        } else if (!optional) {
            report.error(Code::kSectionUnknown, entry,
                         name + " is required and not known to format version " +
                             version_name(layout::kVersionMajor, layout::kVersionMinor) +
                             "; update dfield or bake again");
        } else {
            report.warning(Code::kSkippedSection, entry, name + " is not known and skipped");
        }

        // In order, without gaps and overlaps, up to the end of the file exactly.
        const std::uint64_t start = layout::align_section(end);
        if (section.offset != start || section.stored_bytes == 0 || start > bytes.size() ||
            section.stored_bytes > bytes.size() - start)
            return report.error(Code::kSectionPlacement, entry + layout::kEntryOffsetAt,
                                name + " says bytes " + std::to_string(section.offset) + " + " +
                                    std::to_string(section.stored_bytes) + ", it should begin at " +
                                    std::to_string(start) + " and end within " +
                                    std::to_string(bytes.size()) + "; bake again");
        if (!all_zero(bytes.subspan(end, start - end)))
            report.error(Code::kSectionPadding, end,
                         "the padding before " + name + " is not zero" + kDamaged);
        end = start + section.stored_bytes;
    }
    if (end != bytes.size())
        report.error(Code::kSectionPlacement, end,
                     "the last section ends before the file does" + std::string(kDamaged));
    return true;
}

const SectionInfo* find_section(const FileInfo& info, std::string_view id) {
    for (const SectionInfo& section : info.sections)
        if (section.id == id) return &section;
    return nullptr;
}

std::optional<std::pmr::vector<std::byte>> decompress_section(std::span<const std::byte> bytes,
                                                              const SectionInfo& section, Report& report,
                                                              std::pmr::memory_resource* memory) {
    const auto stored = bytes.subspan(section.offset, section.stored_bytes);
    const auto fail = [&](Code code, const std::string& what) {
        report.error(code, section.offset, "section " + printable(section.id) + ": " + what + kDamaged);
        return std::nullopt;
    };
    if (checksum64(stored) != section.checksum) return fail(Code::kSectionChecksum, "the checksum is wrong");
    // One frame, not several and no skippable ones; ZSTD_decompress would take those too.
    if (stored.size() < 4 || load_le<std::uint32_t>(stored.data()) != ZSTD_MAGICNUMBER ||
        ZSTD_findFrameCompressedSize(stored.data(), stored.size()) != stored.size())
        return fail(Code::kSectionFrame, "not one zstd frame");
    if (ZSTD_getFrameContentSize(stored.data(), stored.size()) != section.raw_bytes)
        return fail(Code::kSectionFrame, "the zstd frame's size is not the section's raw size");
    std::pmr::vector<std::byte> raw(section.raw_bytes, memory);
    const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), stored.data(), stored.size());
    if (ZSTD_isError(size) != 0)
        return fail(Code::kSectionFrame, std::string("zstd: ") + ZSTD_getErrorName(size));
    if (size != raw.size()) return fail(Code::kSectionFrame, "shorter than its raw size");
    return raw;
}

FileInfo read_file_info(std::span<const std::byte> bytes) {
    Report report;
    const auto info = parse_header(bytes, report);
    check_sections(bytes, *info, report);
    return *info;
}

}  // namespace dfield
