// Every rule of FORMAT.md broken by itself, in files whose checksums are right.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include "format/codec.hpp"
#include "format/codec_distances.hpp"
#include "format/writer.hpp"
#include "tests/format/fields.hpp"
#include "tests/format/file_editor.hpp"

using namespace dfield;
using namespace dfield::test;
using Code = FormatErrorCode;

namespace {

const FieldParameters kEight{Positions::kSlater, 2, Mapping::kConcentric, 5, 8};
const FieldParameters kOne{Positions::kSlater, 2, Mapping::kConcentric, 5, 1};

DisplacementField full_field(const FieldParameters& p) {
    DisplacementField field = make_field(p, Pattern::kSmooth);
    add_optional_sections(field);
    return field;
}

Bytes full_file(const FieldParameters& p) {
    return write_field(full_field(p));
}

// The file after `change` of its parts.
template<class Change>
Bytes edited(const FieldParameters& p, const Change& change) {
    FileEditor editor{full_file(p)};
    change(editor);
    return editor.build();
}

// The file after `change(bytes, entry)` of its bytes, with the table entry of a section.
template<class Change>
Bytes patched(const FieldParameters& p, std::size_t section, const Change& change) {
    Bytes bytes = full_file(p);
    change(bytes, &bytes[layout::kHeaderBytes + section * layout::kEntryBytes]);
    seal(bytes);
    return bytes;
}

}  // namespace

TEST_CASE("taken apart and built again, a file is the same field") {
    for (const FieldParameters& p : {kEight, kOne}) {
        const Bytes bytes = edited(p, [](FileEditor&) {});
        CHECK(same_field(read_field(bytes), full_field(p)));
    }
}

TEST_CASE("major versions are refused by name, newer minor ones accepted with a warning") {
    for (const std::uint16_t major : {0, 2, 65535}) {
        const Bytes bytes = edited(kEight, [&](FileEditor& e) { e.major = major, e.minor = 7; });
        check_refused(bytes, Code::kVersion);
        const std::string message = refusal(bytes).message;
        CHECK(message.find(std::to_string(major) + ".7") != std::string::npos);
        CHECK(message.find("1.2") != std::string::npos);
        CHECK(message.find("bake again") != std::string::npos);
    }
    const Bytes newer = edited(kEight, [](FileEditor& e) { e.minor = layout::kVersionMinor + 1; });
    CHECK(same_field(read_field(newer), full_field(kEight)));
    CHECK(validate_file(newer).at(0).code == Code::kNewerMinor);
}

TEST_CASE("unknown sections: optional ones are skipped, required ones refused") {
    const FileEditor::Section unknown{"NEWS", layout::kFlagOptional, Bytes(100, std::byte{3}), {}, 0};
    for (const std::size_t place : {0, 2, 5}) {
        const auto with = [&](std::uint32_t flags) {
            return edited(kEight, [&](FileEditor& e) {
                e.sections.insert(e.sections.begin() + static_cast<std::ptrdiff_t>(place), unknown)->flags =
                    flags;
            });
        };
        const Bytes skipped = with(layout::kFlagOptional);
        CHECK(same_field(read_field(skipped), full_field(kEight)));
        CHECK(validate_file(skipped).at(0).code == Code::kSkippedSection);
        check_refused(with(0), Code::kSectionUnknown);
        check_refused(with(2), Code::kSectionFlags);
    }
    // What an unknown section holds is not looked at.
    const Bytes garbage = edited(kEight, [&](FileEditor& e) {
        e.sections.push_back(unknown);
        e.sections.back().frame = Bytes(9, std::byte{1});
        e.sections.back().raw_bytes = std::uint64_t{1} << 60;
    });
    CHECK(same_field(read_field(garbage), full_field(kEight)));
}

TEST_CASE("the table's rules") {
    check_refused(edited(kEight, [](FileEditor& e) { e["PROV"].flags = 0; }), Code::kSectionFlags);
    check_refused(edited(kEight, [](FileEditor& e) { e["MASK"].flags = layout::kFlagOptional; }),
                  Code::kSectionFlags);
    check_refused(edited(kEight, [](FileEditor& e) { e["DIST"].flags = 0x80000000; }), Code::kSectionFlags);
    check_refused(edited(kEight, [](FileEditor& e) { std::swap(e["MASK"], e["DIST"]); }),
                  Code::kSectionOrder);
    check_refused(edited(kEight, [](FileEditor& e) { e.sections.push_back(e["PROV"]); }),
                  Code::kSectionOrder);
    for (const char* id : {"FELD", "MASK", "DIST"})
        check_refused(edited(kEight, [&](FileEditor& e) { e.erase(id); }), Code::kSectionMissing);
    check_refused(edited(kOne, [&](FileEditor& e) { e.erase("MEAN"); }), Code::kSectionMissing);
    check_refused(edited(kEight,
                         [](FileEditor& e) {
                             e.sections.insert(e.sections.begin() + 3, {"MEAN", 0, Bytes(36), {}, 0});
                         }),
                  Code::kSectionUnexpected);
    check_refused(edited(kEight, [](FileEditor& e) { e.sections.clear(); }), Code::kSectionCount);
    check_refused(edited(kEight,
                         [](FileEditor& e) {
                             while (e.sections.size() <= layout::kMaxSections)
                                 e.sections.push_back({"MORE", layout::kFlagOptional, Bytes(1), {}, 0});
                         }),
                  Code::kSectionCount);
    Bytes huge = full_file(kEight);
    store_le(&huge[layout::kSectionCountAt], std::uint32_t{0xffffffff});
    check_refused(huge, Code::kSectionCount);
    store_le(&huge[layout::kSectionCountAt], std::uint32_t{60});  // a table past the end, within the limit
    if (huge.size() < layout::kHeaderBytes + 60 * layout::kEntryBytes)
        check_refused(huge, Code::kSectionCount);
    Bytes header_only = full_file(kEight);
    header_only.resize(layout::kHeaderBytes);
    store_le(&header_only[layout::kFileBytesAt], std::uint64_t{header_only.size()});
    check_refused(header_only, Code::kSectionCount);

    // Without the optional sections the field is still whole.
    const Bytes bare = edited(kEight, [](FileEditor& e) { e.erase("PROV"); });
    CHECK(accepted(bare));
    CHECK(validate_file(bare).at(0).code == Code::kNoProvenance);
}

TEST_CASE("sections lie where they must") {
    const auto shift = [](std::size_t section, std::size_t field, std::uint64_t by) {
        return patched(kEight, section, [&](Bytes&, std::byte* entry) {
            store_le(entry + field, load_le<std::uint64_t>(entry + field) + by);
        });
    };
    constexpr std::uint64_t kMinusEight = ~std::uint64_t{7};
    for (const std::uint64_t by : {std::uint64_t{8}, std::uint64_t{1}, kMinusEight, std::uint64_t{1} << 63}) {
        check_refused(shift(1, layout::kEntryOffsetAt, by), Code::kSectionPlacement);
        check_refused(shift(1, layout::kEntryStoredAt, 2 * by + 8), Code::kSectionPlacement);
        check_refused(shift(4, layout::kEntryStoredAt, by), Code::kSectionPlacement);
    }
    check_refused(
        patched(kEight, 2,
                [](Bytes&, std::byte* entry) { store_le(entry + layout::kEntryStoredAt, std::uint64_t{0}); }),
        Code::kSectionPlacement);
    // Padding; some section of this file ends off a multiple of 8.
    std::size_t padded = 0;
    const Bytes file = full_file(kEight);
    for (const SectionInfo& section : read_file_info(file).sections) {
        const std::uint64_t end = section.offset + section.stored_bytes;
        if (end % 8 == 0 || end == file.size()) continue;
        Bytes changed = file;
        changed[layout::align_section(end) - 1] = std::byte{1};
        seal(changed);
        check_refused(changed, Code::kSectionPadding);
        ++padded;
    }
    CHECK(padded > 0);
}

TEST_CASE("frames hold what the table says") {
    const auto with_frame = [](const char* id, const auto& make) {
        return edited(kEight, [&](FileEditor& e) {
            auto& section = e[id];
            section.raw_bytes = section.raw.size();
            section.frame = make(section.raw);
        });
    };
    const auto no_frame = [](const Bytes& raw) { return raw; };
    const auto two_frames = [](const Bytes& raw) {
        Bytes frames = zstd_frame(std::span(raw).first(raw.size() / 2));
        const Bytes second = zstd_frame(std::span(raw).subspan(raw.size() / 2));
        frames.insert(frames.end(), second.begin(), second.end());
        return frames;
    };
    const auto skippable_first = [](const Bytes& raw) {
        Bytes frames(12);
        store_le(&frames[0], std::uint32_t{0x184d2a50});
        store_le(&frames[4], std::uint32_t{4});
        const Bytes frame = zstd_frame(raw);
        frames.insert(frames.end(), frame.begin(), frame.end());
        return frames;
    };
    const auto without_size = [](const Bytes& raw) {
        ZSTD_CCtx* context = ZSTD_createCCtx();
        ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, 0);
        Bytes frame(ZSTD_compressBound(raw.size()));
        frame.resize(ZSTD_compress2(context, frame.data(), frame.size(), raw.data(), raw.size()));
        ZSTD_freeCCtx(context);
        return frame;
    };
    const auto cut = [](const Bytes& raw) {
        Bytes frame = zstd_frame(raw);
        frame.pop_back();
        return frame;
    };
    const auto other_size = [](Bytes raw) {
        raw.push_back(std::byte{0});
        return zstd_frame(raw);
    };
    for (const char* id : {"FELD", "MASK", "DIST", "SELF", "PROV"}) {
        check_refused(with_frame(id, no_frame), Code::kSectionFrame);
        check_refused(with_frame(id, two_frames), Code::kSectionFrame);
        check_refused(with_frame(id, skippable_first), Code::kSectionFrame);
        check_refused(with_frame(id, without_size), Code::kSectionFrame);
        check_refused(with_frame(id, cut), Code::kSectionFrame);
        check_refused(with_frame(id, other_size), Code::kSectionFrame);
    }
    Bytes damaged = full_file(kEight);
    const SectionInfo mask = read_file_info(damaged).sections.at(1);
    damaged[mask.offset + mask.stored_bytes / 2] ^= std::byte{1};
    check_refused(damaged, Code::kSectionChecksum);
}

TEST_CASE("raw sizes are held against the parameters before memory is taken") {
    const auto claims = [](const FieldParameters& p, const char* id, std::uint64_t raw_bytes) {
        return edited(p, [&](FileEditor& e) {
            e[id].frame = zstd_frame(e[id].raw);
            e[id].raw_bytes = raw_bytes;
        });
    };
    for (const std::uint64_t huge : {std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
        for (const char* id : {"FELD", "MASK", "DIST", "SELF", "PROV"})
            check_refused(claims(kEight, id, huge), Code::kSectionRawSize);
        check_refused(claims(kOne, "MEAN", huge), Code::kSectionRawSize);
    }
    for (const char* id : {"FELD", "MASK", "DIST", "SELF", "PROV"})
        check_refused(claims(kEight, id, 0), Code::kSectionRawSize);
    check_refused(claims(kEight, "SELF", 99), Code::kSectionRawSize);
    check_refused(claims(kEight, "PROV", 1), Code::kSectionRawSize);
    // A bomb: the frame says so too, and would expand.
    for (const char* id : {"FELD", "MASK", "DIST", "PROV"})
        check_refused(
            edited(kEight, [&](FileEditor& e) { e[id].raw.assign(std::size_t{16} << 20, std::byte{0}); }),
            Code::kSectionRawSize);
    // Fewer distances than the mask has hits.
    check_refused(edited(kEight, [](FileEditor& e) { e["DIST"].raw.pop_back(); }), Code::kSectionRawSize);
    check_refused(full_file(kEight), Code::kMemoryLimit, {.max_texel_bytes = texel_bytes(kEight) - 1});
    check_refused(full_file(kEight), Code::kSectionRawSize, {.max_self_vertices = 49});
    CHECK_NOTHROW(
        read_field(full_file(kEight), {{.max_texel_bytes = texel_bytes(kEight), .max_self_vertices = 50}}));
}

TEST_CASE("parameters, sphere and bounds") {
    const auto byte_at = [](std::size_t at, std::uint8_t value) {
        return edited(kEight, [&](FileEditor& e) { e["FELD"].raw[at] = std::byte{value}; });
    };
    const auto word_at = [](std::size_t at, std::uint32_t value) {
        return edited(kEight, [&](FileEditor& e) { store_le(&e["FELD"].raw[at], value); });
    };
    const auto float_at = [](std::size_t at, float value) {
        return edited(kEight, [&](FileEditor& e) { store_float(&e["FELD"].raw[at], value); });
    };
    check_refused(byte_at(layout::kReserved8At, 1), Code::kReserved);
    check_refused(word_at(layout::kReserved32At, 0x80), Code::kReserved);
    check_refused(byte_at(layout::kPositionsAt, 2), Code::kParameters);
    check_refused(byte_at(layout::kMappingAt, 3), Code::kParameters);
    for (const std::uint8_t bits : {0, 2, 4, 24, 64, 255})
        check_refused(byte_at(layout::kBitsAt, bits), Code::kParameters);
    for (const std::uint32_t value : {0u, 257u, 0xffffffffu})
        check_refused(word_at(layout::kSubdivisionAt, value), Code::kParameters);
    for (const std::uint32_t value : {0u, 1025u, 0x80000000u})
        check_refused(word_at(layout::kMapSizeAt, value), Code::kParameters);
    // Each within its limits, together too much.
    check_refused(edited(kEight,
                         [](FileEditor& e) {
                             store_le(&e["FELD"].raw[layout::kSubdivisionAt], kMaxSubdivision);
                             store_le(&e["FELD"].raw[layout::kMapSizeAt], kMaxMapSize);
                         }),
                  Code::kParameters);
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                infinity = std::numeric_limits<float>::infinity();
    for (std::size_t at = layout::kRadiusAt; at < layout::kReserved32At; at += 4)
        for (const float value : {nan, infinity, -infinity})
            check_refused(float_at(at, value), Code::kNotFinite);
    for (const float value : {0.0f, -0.0f, -1.0f, 1e-40f, 3e38f})
        check_refused(float_at(layout::kRadiusAt, value), Code::kRadius);
    check_refused(float_at(layout::kBoundsMinAt, 2.5f), Code::kBounds);
    check_refused(float_at(layout::kBoundsMinAt + 4, -1e30f), Code::kBounds);
    check_refused(float_at(layout::kBoundsMaxAt + 8, 6.0f), Code::kBounds);
    check_refused(float_at(layout::kRadiusAt, 0.5f), Code::kBounds);
    // Everything that is wrong with the section is found.
    const auto findings = validate_file(edited(kEight, [&](FileEditor& e) {
        store_float(&e["FELD"].raw[layout::kCentreAt], nan);
        store_float(&e["FELD"].raw[layout::kBoundsMaxAt], nan);
        e["FELD"].raw[layout::kReserved8At] = std::byte{1};
        e["PROV"].raw[0] = std::byte{'x'};
    }));
    CHECK(findings.size() == 4);
    // Parameters that another field could have, but not this one.
    check_refused(word_at(layout::kMapSizeAt, 4), Code::kHitMask);
    check_refused(byte_at(layout::kMappingAt, 1), Code::kPayloadHash);
    check_refused(float_at(layout::kRadiusAt, 2.75f), Code::kPayloadHash);
    check_refused(byte_at(layout::kPayloadHashAt + 15, 1), Code::kPayloadHash);
}

TEST_CASE("the hit mask's rules") {
    const auto mask = [](const FieldParameters& p, auto change) {
        return edited(p, [&](FileEditor& e) { change(e["MASK"].raw); });
    };
    for (const FieldParameters& p : {kEight, kOne}) {
        check_refused(mask(p, [](Bytes& raw) { raw[0] = std::byte{2}; }), Code::kHitMask);
        check_refused(mask(p, [](Bytes& raw) { raw[0] = std::byte{0}; }), Code::kHitMask);
        check_refused(mask(p, [](Bytes& raw) { raw.push_back(std::byte{0}); }), Code::kHitMask);
        check_refused(mask(p, [](Bytes& raw) { raw.pop_back(); }), Code::kHitMask);
        check_refused(mask(p, [](Bytes& raw) { raw.resize(1); }), Code::kHitMask);
        check_refused(mask(p, [](Bytes& raw) { raw.back() ^= std::byte{1}; }), Code::kHitMask);
    }
    // Plain masks are read too; their padding must be 0.
    const std::vector<std::uint8_t> plane = codec::plane_of_texels(kOne, full_field(kOne).texels);
    const auto plain = [&](Bytes& raw) {
        raw.assign(1, std::byte{0});
        for (const std::uint8_t byte : plane) raw.push_back(std::byte{byte});
    };
    CHECK(same_field(read_field(mask(kOne, plain)), full_field(kOne)));
    check_refused(mask(kOne,
                       [&](Bytes& raw) {
                           plain(raw);
                           raw[3] |= std::byte{0x20};
                       }),
                  Code::kHitMask);
    // A hit in the corner of a disk.
    FieldParameters rejection = kEight;
    rejection.mapping = Mapping::kRejection;
    check_refused(mask(rejection,
                       [&](Bytes& raw) {
                           std::vector<std::uint8_t> cornered =
                               codec::plane_of_texels(rejection, full_field(rejection).texels);
                           cornered[0] |= 1;
                           raw = codec::encode_mask(rejection, cornered);
                       }),
                  Code::kUnusedTexel);
}

TEST_CASE("the distances' rules") {
    const auto distances = [](const FieldParameters& p, auto change) {
        return edited(p, [&](FileEditor& e) { change(e["DIST"].raw); });
    };
    const std::size_t data = 4 * codec::context_count(8);
    check_refused(distances(kEight, [&](Bytes& raw) { raw[data] = std::byte{255}; }), Code::kDistances);
    check_refused(distances(kEight, [&](Bytes& raw) { raw.back() = std::byte{255}; }), Code::kDistances);
    check_refused(distances(kEight, [](Bytes& raw) { raw[3] = std::byte{255}; }), Code::kDistances);
    // Counts that sum up, in the wrong places.
    check_refused(distances(kEight,
                            [&](Bytes& raw) {
                                for (std::size_t c = 0; c + 4 < data; c += 4)
                                    if (load_le<std::uint32_t>(&raw[c]) > 0) {
                                        store_le(&raw[c], load_le<std::uint32_t>(&raw[c]) - 1);
                                        store_le(&raw[c + 4], load_le<std::uint32_t>(&raw[c + 4]) + 1);
                                        return;
                                    }
                            }),
                  Code::kDistances);
    // A single hit, whose residual could be another.
    DisplacementField single = make_field(kEight, Pattern::kAllMiss);
    single.texels.back() = 100;
    FileEditor editor{write_field(single)};
    editor["DIST"].raw.back() ^= std::byte{1};
    check_refused(editor.build(), Code::kPayloadHash);
    for (const std::uint32_t bits : {16u, 32u}) {
        FieldParameters p = kEight;
        p.bits = bits;
        const std::size_t at = 4 * codec::context_count(bits);
        check_refused(distances(p,
                                [&](Bytes& raw) {  // folded residual of all ones: above any texel value
                                    const std::size_t hits = (raw.size() - at) / (bits / 8);
                                    for (std::size_t plane = 0; plane < bits / 8; ++plane)
                                        raw[at + plane * hits] = std::byte{255};
                                }),
                      Code::kDistances);
    }
}

TEST_CASE("mean depth, self visibility, provenance") {
    // All miss, but for the mean depth.
    FileEditor editor{write_field(make_field(kOne, Pattern::kAllMiss))};
    CHECK(validate_file(editor.build()).at(0).code == Code::kNoHit);
    editor["MEAN"].raw[20] = std::byte{1};
    check_refused(editor.build(), Code::kMeanDepth);
    check_refused(edited(kOne, [](FileEditor& e) { e["MEAN"].raw[30] ^= std::byte{1}; }), Code::kPayloadHash);
    check_refused(edited(kEight, [](FileEditor& e) { e["SELF"].raw[30] ^= std::byte{1}; }),
                  Code::kPayloadHash);
    check_refused(edited(kEight, [](FileEditor& e) { e.erase("SELF"); }), Code::kPayloadHash);

    const auto provenance = [](const std::string& text) {
        return edited(kEight, [&](FileEditor& e) {
            e["PROV"].raw.clear();
            for (const char c : text) e["PROV"].raw.push_back(static_cast<std::byte>(c));
        });
    };
    for (const char* text : {"{}", "{\"a\":\n\t1}\r}", "{\xc3\xa9}", "{\xe2\x82\xac}", "{\xf0\x9f\x98\x80}"})
        CHECK(accepted(provenance(text)));
    for (const char* text :
         {"[]", "{", "x}", "{]", "{\x01}", "{\x7f}", "{\x80}", "{\xc0\x80}", "{\xc3}", "{\xe0\x80\x80}",
          "{\xed\xa0\x80}", "{\xf4\x90\x80\x80}", "{\xf0\x80\x80\x80}", "{\xff}"})
        check_refused(provenance(text), text[1] == '\0' ? Code::kSectionRawSize : Code::kProvenance);
    check_refused(provenance(std::string("{\0}", 3)), Code::kProvenance);
    check_refused(provenance("{" + std::string(kMaxProvenanceBytes, ' ') + "}"), Code::kSectionRawSize);
}

TEST_CASE("every error has a name") {
    for (std::uint32_t number = 0; number < 1000; ++number) {
        const auto name = format_error_name(static_cast<Code>(number));
        CHECK(!name.empty());
    }
    CHECK(format_error_name(Code::kPayloadHash) == "payload-hash");
    CHECK(format_error_name(static_cast<Code>(999)) == "unknown");
}
