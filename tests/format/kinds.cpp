// Line tables, direction maps and occlusion volumes: what is written is read back, in part or whole; their
// rules.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <string>

#include "format/codec_directions.hpp"
#include "format/hash.hpp"
#include "format/octahedral.hpp"
#include "format/sections.hpp"
#include "format/sphere_points.hpp"
#include "format/writer.hpp"
#include "tests/format/file_editor.hpp"
#include "tests/format/kinds.hpp"

using namespace dfield;
using namespace dfield::test;
using Code = FormatErrorCode;

namespace {

constexpr Pattern kPatterns[] = {Pattern::kSmooth, Pattern::kNoise, Pattern::kAllMiss, Pattern::kAllHit};

void check_round_trip(const DisplacementField& field) {
    const auto bytes = write_field(field, {.zstd_level = 1});
    const DisplacementField read = read_field(bytes);
    REQUIRE(same_kinds(read, field));
    REQUIRE(payload_hash(read) == payload_hash(field));
    for (const Finding& finding : validate_file(bytes))
        REQUIRE(finding.severity == Finding::Severity::kWarning);
}

std::string section_ids(std::span<const std::byte> bytes) {
    std::string ids;
    for (const SectionInfo& section : read_file_info(bytes).sections) ids += section.id + " ";
    return ids;
}

template<class Change>
Bytes edited(const Change& change) {
    FileEditor editor{write_field(make_all_kinds_and_volume())};
    change(editor);
    return editor.build();
}

}  // namespace

TEST_CASE("line tables come back as they were written") {
    for (const Pattern pattern : kPatterns)
        for (const std::uint32_t lattice : {2u, 3u, 8u, 13u})
            for (const std::uint32_t depth_bits : {0u, 4u, 8u}) {
                DisplacementField field = make_empty_field();
                const std::uint32_t depth_lattice = depth_bits == 0 ? 0 : lattice == 8 ? 5 : lattice;
                field.lines = make_line_table(
                    line_parameters(lattice, depth_bits, depth_lattice, lattice % 3 == 0), pattern);
                check_round_trip(field);
            }
}

TEST_CASE("direction maps come back as they were written") {
    for (const Pattern pattern : kPatterns)
        for (const std::uint32_t n : {1u, 2u, 5u})
            for (const std::uint32_t m : {16u, 32u, 64u, 128u})
                for (const std::uint32_t depth_size : {0u, 8u, 16u}) {
                    DisplacementField field = make_empty_field();
                    field.directions.push_back(make_direction_maps({n, m, depth_size}, pattern));
                    check_round_trip(field);
                }
}

TEST_CASE("occlusion volumes come back as they were written") {
    for (const Pattern pattern : kPatterns)
        for (const auto& dims : {std::array{4u, 4u, 4u}, {4u, 9u, 5u}, {17u, 4u, 6u}, {5u, 6u, 21u}})
            for (const std::uint32_t far_size : {3u, 9u}) {
                DisplacementField field = make_empty_field();
                field.volume = make_volume(dims, far_size, pattern);
                check_round_trip(field);
            }
}

TEST_CASE("all kinds lie in one file, each optional to readers of version 1.0") {
    for (const std::uint32_t bits : {1u, 8u}) check_round_trip(make_all_kinds_and_volume(bits));
    const auto bytes = write_field(make_all_kinds_and_volume());
    CHECK(section_ids(bytes) == "FELD MASK DIST LINE DM00 DM01 VOLU SELF PROV ");
    const FileInfo info = read_file_info(bytes);
    CHECK(info.version_minor == 2);
    for (const SectionInfo& section : info.sections)
        if (section.id == "LINE" || section.id.starts_with("DM") || section.id == "VOLU")
            CHECK(section.flags == layout::kFlagOptional);
    // What FELD states is the hash of what 1.0 knows, so that it can check it.
    DisplacementField known = make_all_kinds();
    known.lines.reset();
    known.directions.clear();
    FileEditor editor{bytes};
    const Digest digest = field_digest(known);
    CHECK(std::equal(digest.begin(), digest.end(), &editor["FELD"].raw[layout::kPayloadHashAt]));
    CHECK(payload_hash(known) != payload_hash(make_all_kinds()));
    CHECK(payload_hash(make_all_kinds()) != payload_hash(make_all_kinds_and_volume()));
    for (const char* id : {"LINE", "DM00", "DM01", "VOLU"}) editor.erase(id);
    CHECK(payload_hash(read_field(editor.build())) == payload_hash(known));
}

TEST_CASE("parts of a file load alone, without a look at the others") {
    const DisplacementField whole = make_all_kinds_and_volume();
    const auto bytes = write_field(whole);
    const auto part = [&](const ReadOptions& options) { return read_field(bytes, options); };
    const DisplacementField coarse = part({.maps = false, .lines = false, .direction_levels = 1});
    CHECK(coarse.parameters == kNoMaps);
    CHECK(coarse.texels.empty());
    CHECK(!coarse.lines);
    REQUIRE(coarse.directions.size() == 1);
    CHECK(same_directions(coarse.directions[0], whole.directions[0]));
    CHECK(coarse.radius == whole.radius);
    CHECK(coarse.self_visibility == whole.self_visibility);
    const DisplacementField lines = part({.maps = false, .direction_levels = 0, .self_visibility = false});
    REQUIRE(lines.lines);
    CHECK(same_lines(*lines.lines, *whole.lines));
    CHECK(lines.directions.empty());
    CHECK(lines.self_visibility.empty());
    CHECK(lines.volume);
    const DisplacementField maps = part({.lines = false, .direction_levels = 0, .volume = false});
    CHECK(!maps.volume);
    CHECK(same_field(maps, whole));
    CHECK(same_kinds(part({}), whole));

    // Damage in a part that is not loaded does not matter, and its limits do not hold.
    const auto refuses = [](const Bytes& file, const ReadOptions& options) {
        try {
            read_field(file, options);
        } catch (const FormatError&) {
            return true;
        }
        return false;
    };
    const ReadOptions no_maps{.maps = false}, no_lines{.lines = false}, one_level{.direction_levels = 1},
        no_self{.self_visibility = false}, no_volume{.volume = false};
    const auto damaged = [&](const char* id) {
        Bytes file = bytes;
        for (const SectionInfo& section : read_file_info(file).sections)
            if (section.id == id) file[section.offset + section.stored_bytes - 1] ^= std::byte{1};
        return file;
    };
    for (const auto& [id, options] : {std::pair{"MASK", no_maps},
                                      {"DIST", no_maps},
                                      {"LINE", no_lines},
                                      {"DM01", one_level},
                                      {"VOLU", no_volume},
                                      {"SELF", no_self}}) {
        INFO(id);
        CHECK(refuses(damaged(id), {}));
        CHECK(!refuses(damaged(id), options));
    }
    CHECK(refuses(damaged("DM00"), one_level));
    const ReadLimits none{.max_texel_bytes = 0,
                          .max_self_vertices = 0,
                          .max_line_bytes = 0,
                          .max_direction_bytes = 0,
                          .max_volume_bytes = 0};
    CHECK(!refuses(bytes, {none, false, false, 0, false, false}));
    CHECK(refuses(bytes, {none, true, false, 0, false, false}));
    CHECK(refuses(bytes, {none, false, true, 0, false, false}));
    CHECK(refuses(bytes, {none, false, false, 1, false, false}));
    CHECK(refuses(bytes, {none, false, false, 0, true, false}));
    CHECK(refuses(bytes, {none, false, false, 0, false, true}));
}

TEST_CASE("limits of line table and direction maps hold in memory") {
    const DisplacementField field = make_all_kinds();
    const auto bytes = write_field(field);
    const std::uint64_t line_bytes = 4 * (field.lines->hits.size() + field.lines->depths.size());
    check_refused(bytes, Code::kMemoryLimit, {.max_line_bytes = line_bytes - 1});
    const std::uint64_t coarse = field.directions[0].memory_bytes(),
                        direction_bytes = coarse + field.directions[1].memory_bytes();
    check_refused(bytes, Code::kMemoryLimit, {.max_direction_bytes = direction_bytes - 1});
    CHECK_NOTHROW(
        read_field(bytes, {{.max_line_bytes = line_bytes, .max_direction_bytes = direction_bytes}}));
    CHECK_NOTHROW(read_field(bytes, {.limits = {.max_direction_bytes = coarse}, .direction_levels = 1}));
    const std::uint64_t volume_bytes = make_all_kinds_and_volume().volume->memory_bytes();
    const auto with_volume = write_field(make_all_kinds_and_volume());
    check_refused(with_volume, Code::kSectionRawSize, {.max_volume_bytes = volume_bytes - 1});
    CHECK_NOTHROW(read_field(with_volume, {{.max_volume_bytes = volume_bytes}}));
    // Sizes that the table states are held against them before a frame is opened.
    const auto claims = [](const char* id, std::uint64_t raw_bytes) {
        return edited([&](FileEditor& e) {
            e[id].frame = zstd_frame(e[id].raw);
            e[id].raw_bytes = raw_bytes;
        });
    };
    for (const char* id : {"LINE", "DM00", "DM01", "VOLU"})
        for (const std::uint64_t size :
             {std::uint64_t{0}, std::uint64_t{31}, std::uint64_t{1} << 40, ~std::uint64_t{0}})
            check_refused(claims(id, size), Code::kSectionRawSize);
}

TEST_CASE("which sections there are") {
    const auto without = [](std::initializer_list<const char*> ids) {
        return edited([&](FileEditor& e) {
            for (const char* id : ids) e.erase(id);
        });
    };
    CHECK(accepted(without({"LINE"})));
    CHECK(accepted(without({"DM01"})));
    CHECK(accepted(without({"DM00", "DM01"})));
    check_refused(without({"DM00"}), Code::kSectionMissing);
    check_refused(edited([](FileEditor& e) { e["LINE"].flags = 0; }), Code::kSectionFlags);
    check_refused(edited([](FileEditor& e) { e["DM01"].flags = 0; }), Code::kSectionFlags);
    check_refused(edited([](FileEditor& e) { std::swap(e["LINE"], e["DM00"]); }), Code::kSectionOrder);
    check_refused(edited([](FileEditor& e) { std::swap(e["DM00"].raw, e["DM01"].raw); }),
                  Code::kDirectionLevels);
    check_refused(edited([](FileEditor& e) { e["DM01"].raw = e["DM00"].raw; }), Code::kDirectionLevels);

    // Without displacement maps: their sections must not be there, and some other kind must.
    DisplacementField field = make_empty_field();
    field.lines = make_line_table(line_parameters(3), Pattern::kSmooth);
    FileEditor lines{write_field(field)};
    CHECK(section_ids(lines.build()) == "FELD LINE ");
    FileEditor none = lines;
    none.erase("LINE");
    check_refused(none.build(), Code::kSectionMissing);
    FileEditor masked = lines;
    masked.sections.insert(masked.sections.begin() + 1, {"MASK", 0, Bytes(2), {}, 0});
    check_refused(masked.build(), Code::kSectionUnexpected);
    for (const std::size_t at :
         {layout::kPositionsAt, layout::kMappingAt, layout::kSubdivisionAt, layout::kMapSizeAt}) {
        FileEditor other = lines;
        other["FELD"].raw[at] = std::byte{1};
        check_refused(other.build(), Code::kParameters);
    }
}

TEST_CASE("the line table's rules") {
    const auto with = [](auto change) { return edited([&](FileEditor& e) { change(e["LINE"].raw); }); };
    const auto byte_at = [&](std::size_t at, std::uint8_t value) {
        return with([&](Bytes& raw) { raw[at] = std::byte{value}; });
    };
    const auto float_at = [&](std::size_t at, float value) {
        return with([&](Bytes& raw) { store_float(&raw[at], value); });
    };
    check_refused(byte_at(layout::kLineReserved16At, 1), Code::kReserved);
    for (std::size_t at = layout::kLineReservedAt; at < layout::kLineHashAt; ++at)
        check_refused(byte_at(at, 0x80), Code::kReserved);
    check_refused(byte_at(layout::kLineFlagsAt, 8), Code::kReserved);
    for (const std::uint8_t value : {0, 1, 129, 255})
        check_refused(byte_at(layout::kLineLatticeAt, value), Code::kParameters);
    for (const std::uint8_t value : {0, 1, 129})
        check_refused(byte_at(layout::kLineDepthLatticeAt, value), Code::kParameters);
    for (const std::uint8_t value : {0, 1, 5, 16})
        check_refused(byte_at(layout::kLineDepthBitsAt, value), Code::kParameters);
    for (std::size_t at = layout::kLineToUnitAt; at < layout::kLineHashedBytes; at += 4)
        for (const float value :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
            check_refused(float_at(at, value), Code::kNotFinite);
    check_refused(with([](Bytes& raw) {
                      for (std::size_t i = 0; i < 3; ++i)
                          store_float(&raw[layout::kLineToUnitAt + 12 * i], 0.0f);
                  }),
                  Code::kLineTransform);
    check_refused(byte_at(layout::kLineFlagsAt, 0), Code::kPayloadHash);
    check_refused(float_at(layout::kLineCentreAt, 7), Code::kPayloadHash);
    check_refused(byte_at(layout::kLineHashAt, 0), Code::kPayloadHash);
    check_refused(byte_at(layout::kLineModeAt, 2), Code::kLineTable);
    check_refused(with([](Bytes& raw) { raw.pop_back(); }), Code::kLineTable);
    check_refused(with([](Bytes& raw) { raw.push_back(std::byte{0}); }), Code::kLineTable);
    check_refused(with([](Bytes& raw) { raw.resize(layout::kLineHeaderBytes); }), Code::kLineTable);
    // Plain content is read too, and held to the same rules.
    const LineTable table = *make_all_kinds().lines;
    const auto plain = [&](Bytes& raw) {
        raw.resize(layout::kLineHeaderBytes);
        raw[layout::kLineModeAt] = std::byte{layout::kPlainMode};
        for (const auto* words : {&table.hits, &table.depths})
            for (const std::uint32_t word : *words) {
                raw.resize(raw.size() + 4);
                store_le(&raw[raw.size() - 4], word);
            }
    };
    CHECK(same_kinds(read_field(with(plain)), make_all_kinds_and_volume()));
    check_refused(with([&](Bytes& raw) { plain(raw), raw.pop_back(); }), Code::kLineTable);
    check_refused(with([&](Bytes& raw) { plain(raw), raw.push_back(std::byte{0}); }), Code::kLineTable);
    // 136 pairs: 24 bits of the fifth word are none.
    check_refused(with([&](Bytes& raw) { plain(raw), raw[layout::kLineHeaderBytes + 19] = std::byte{0x80}; }),
                  Code::kLineTable);
    check_refused(with([&](Bytes& raw) { plain(raw), raw[layout::kLineHeaderBytes] ^= std::byte{1}; }),
                  Code::kPayloadHash);
}

TEST_CASE("the direction maps' rules") {
    const auto with = [](auto change) { return edited([&](FileEditor& e) { change(e["DM01"].raw); }); };
    const auto byte_at = [&](std::size_t at, std::uint8_t value) {
        return with([&](Bytes& raw) { raw[at] = std::byte{value}; });
    };
    for (std::size_t at = layout::kDirectionReserved32At; at < layout::kDirectionModeAt; ++at)
        check_refused(byte_at(at, 1), Code::kReserved);
    for (std::size_t at = layout::kDirectionReservedAt; at < layout::kDirectionHashAt; ++at)
        check_refused(byte_at(at, 1), Code::kReserved);
    for (const std::uint8_t value : {0, 129, 255})
        check_refused(byte_at(layout::kDirectionSubdivisionAt, value), Code::kParameters);
    for (const std::uint8_t value : {0, 8, 17, 255})
        check_refused(byte_at(layout::kDirectionMapSizeAt, value), Code::kParameters);
    for (const std::uint8_t value : {1, 4, 12, 32})
        check_refused(byte_at(layout::kDirectionDepthSizeAt, value), Code::kParameters);
    check_refused(byte_at(layout::kDirectionHashAt + 15, 1), Code::kPayloadHash);
    check_refused(byte_at(layout::kDirectionModeAt, 2), Code::kDirectionMaps);
    check_refused(with([](Bytes& raw) { raw.pop_back(); }), Code::kDirectionMaps);
    check_refused(with([](Bytes& raw) { raw.push_back(std::byte{0}); }), Code::kDirectionMaps);
    check_refused(with([](Bytes& raw) { raw.resize(layout::kDirectionHeaderBytes); }), Code::kDirectionMaps);
    const DirectionMaps maps = make_all_kinds().directions[1];
    const auto plain = [&](Bytes& raw) {
        raw.resize(layout::kDirectionHeaderBytes);
        raw[layout::kDirectionModeAt] = std::byte{layout::kPlainMode};
        for (const auto& frame : maps.frames)
            for (const std::uint8_t byte : frame) raw.push_back(std::byte{byte});
        for (const std::uint32_t word : maps.texels) {
            raw.resize(raw.size() + 4);
            store_le(&raw[raw.size() - 4], word);
        }
        for (const DirectionDepth& depth : maps.depths)
            for (const std::uint8_t byte : {depth.nearest, depth.farthest}) raw.push_back(std::byte{byte});
    };
    CHECK(same_kinds(read_field(with(plain)), make_all_kinds_and_volume()));
    check_refused(with([&](Bytes& raw) { plain(raw), raw.pop_back(); }), Code::kDirectionMaps);
    check_refused(with([&](Bytes& raw) { plain(raw), raw.push_back(std::byte{0}); }), Code::kDirectionMaps);
    check_refused(with([&](Bytes& raw) { plain(raw), raw[layout::kDirectionHeaderBytes] ^= std::byte{1}; }),
                  Code::kPayloadHash);
    check_refused(with([&](Bytes& raw) {
                      plain(raw);
                      raw[raw.size() - 2] = std::byte{9};  // nearest behind farthest
                      raw[raw.size() - 1] = std::byte{8};
                  }),
                  Code::kDirectionMaps);
}

TEST_CASE("the occlusion volume's rules") {
    const auto with = [](auto change) { return edited([&](FileEditor& e) { change(e["VOLU"].raw); }); };
    const auto byte_at = [&](std::size_t at, std::uint8_t value) {
        return with([&](Bytes& raw) { raw[at] = std::byte{value}; });
    };
    const auto float_at = [&](std::size_t at, float value) {
        return with([&](Bytes& raw) { store_float(&raw[at], value); });
    };
    for (std::size_t at = layout::kVolumeReserved32At; at < layout::kVolumeHashAt; ++at)
        check_refused(byte_at(at, 1), Code::kReserved);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const std::uint8_t dim : {0, 1, 3}) check_refused(byte_at(2 * axis, dim), Code::kParameters);
        check_refused(byte_at(2 * axis + 1, 2), Code::kParameters);
        check_refused(byte_at(2 * axis, 7), Code::kVolume);  // other bytes than these samples have
    }
    for (const std::uint8_t size : {0, 1, 2, 4, 35, 255})
        check_refused(byte_at(layout::kVolumeFarSizeAt, size), Code::kParameters);
    check_refused(byte_at(layout::kVolumeFarSizeAt, 5), Code::kVolume);
    for (const float value : {std::nanf(""), INFINITY}) {
        for (std::size_t at = layout::kVolumeOriginAt; at < layout::kVolumeReserved32At; at += 4)
            check_refused(float_at(at, value), Code::kNotFinite);
    }
    check_refused(float_at(layout::kVolumeSpacingAt, 3e38f), Code::kNotFinite);  // the far corner is not
    for (const float value : {0.0f, -0.25f, 1e-40f})
        check_refused(float_at(layout::kVolumeSpacingAt, value), Code::kVolumeGrid);
    for (const float value : {0.0f, 0.2f, -1.0f})
        check_refused(float_at(layout::kVolumeBlendAt, value), Code::kVolumeGrid);
    check_refused(byte_at(layout::kVolumeHashAt + 15, 1), Code::kPayloadHash);
    check_refused(with([](Bytes& raw) { raw.pop_back(); }), Code::kVolume);
    check_refused(with([](Bytes& raw) { raw.push_back(std::byte{0}); }), Code::kVolume);
    check_refused(with([](Bytes& raw) { raw.resize(layout::kVolumeHeaderBytes); }), Code::kVolume);
    for (const std::size_t at : {std::size_t{0}, std::size_t{40}, std::size_t{200}})  // balls, octants
        check_refused(with([&](Bytes& raw) { raw[layout::kVolumeHeaderBytes + at] ^= std::byte{4}; }),
                      Code::kPayloadHash);
}

TEST_CASE("an octahedral map's place and direction are inverses") {
    for (std::uint32_t t = 0; t < 33; ++t)
        for (std::uint32_t s = 0; s < 33; ++s) {
            const glm::vec3 d = far_direction(33, s, t), back = octahedral_direction(octahedral_place(d));
            REQUIRE(glm::length(d) == Approx(1));
            REQUIRE(glm::distance(d, back) < 1e-6f);
        }
    // Nodes opposite each other on the rim are one direction.
    for (std::uint32_t s = 0; s < 9; ++s)
        CHECK(glm::distance(far_direction(9, s, 0), far_direction(9, 8 - s, 0)) < 1e-6f);
}

TEST_CASE("validation goes on after a section that is wrong") {
    const auto findings = validate_file(edited([](FileEditor& e) {
        e["LINE"].raw[layout::kLineModeAt] = std::byte{9};
        e["DM00"].raw[layout::kDirectionReservedAt] = std::byte{9};
        e["PROV"].raw[0] = std::byte{'x'};
    }));
    REQUIRE(findings.size() == 3);
    CHECK(findings[0].code == Code::kLineTable);
    CHECK(findings[1].code == Code::kReserved);
    CHECK(findings[2].code == Code::kProvenance);
}

TEST_CASE("the writer refuses kinds that break a rule") {
    const auto refused = [](auto change) {
        DisplacementField field = make_all_kinds();
        change(field);
        CHECK_THROWS_AS(write_field(field), std::invalid_argument);
    };
    refused([](DisplacementField& f) { f.lines->hits.pop_back(); });
    refused([](DisplacementField& f) { f.lines->hits.back() |= 0x80000000; });
    refused([](DisplacementField& f) { f.lines->depths.push_back(0); });
    refused([](DisplacementField& f) { f.lines->parameters.lattice = 1; });
    refused([](DisplacementField& f) { f.lines->to_unit[2] = {}; });
    refused([](DisplacementField& f) { f.lines->centre.x = std::nanf(""); });
    refused([](DisplacementField& f) { f.directions[0].frames.pop_back(); });
    refused([](DisplacementField& f) { f.directions[0].texels.pop_back(); });
    refused([](DisplacementField& f) { f.directions[0].parameters.map_size = 24; });
    refused([](DisplacementField& f) { f.directions[1].depths[0] = {5, 4}; });
    refused([](DisplacementField& f) { std::swap(f.directions[0], f.directions[1]); });
    refused([](DisplacementField& f) { f.directions.push_back(f.directions.back()); });
    CHECK_THROWS_AS(write_field(make_empty_field()), std::invalid_argument);
    const auto refused_volume = [](auto change) {
        DisplacementField field = make_all_kinds_and_volume();
        change(*field.volume);
        CHECK_THROWS_AS(write_field(field), std::invalid_argument);
    };
    refused_volume([](OcclusionVolume& v) { v.octants.pop_back(); });
    refused_volume([](OcclusionVolume& v) { v.far.push_back(0); });
    refused_volume([](OcclusionVolume& v) { v.dims[1] = 3; });
    refused_volume([](OcclusionVolume& v) { v.spacing = 0; });
    refused_volume([](OcclusionVolume& v) { v.blend = 0; });
    refused_volume([](OcclusionVolume& v) { v.origin.y = std::nanf(""); });
}

TEST_CASE("the payload hash covers every kind") {
    const std::string hash = payload_hash(make_all_kinds());
    const auto differs = [&](auto change) {
        DisplacementField field = make_all_kinds();
        change(field);
        return payload_hash(field) != hash;
    };
    CHECK(differs([](DisplacementField& f) { f.lines.reset(); }));
    CHECK(differs([](DisplacementField& f) { f.lines->hits[0] ^= 1; }));
    CHECK(differs([](DisplacementField& f) { f.lines->depths[0] ^= 1; }));
    CHECK(differs([](DisplacementField& f) { f.lines->centre.z = 9; }));
    CHECK(differs([](DisplacementField& f) { f.lines->parameters.pivot = true; }));
    CHECK(differs([](DisplacementField& f) { f.directions.pop_back(); }));
    CHECK(differs([](DisplacementField& f) { f.directions[0].texels[3] ^= 1; }));
    CHECK(differs([](DisplacementField& f) { f.directions[0].frames[1][7] ^= 1; }));
    CHECK(differs([](DisplacementField& f) { f.directions[1].depths[0].nearest ^= 1; }));
    CHECK(!differs([](DisplacementField& f) { f.provenance = "{}"; }));
}

TEST_CASE("smooth kinds shrink, noise does not grow") {
    for (const Pattern pattern : {Pattern::kSmooth, Pattern::kNoise}) {
        const LineTable lines = make_line_table(line_parameters(20, 8, 12), pattern);
        const DirectionMaps maps = make_direction_maps({6, 64, 0}, pattern);
        const std::size_t line_bytes = 4 * (lines.hits.size() + lines.depths.size());
        const std::size_t coded_lines = encode_lines(lines).size(),
                          coded_maps = encode_directions(maps).size();
        CHECK(coded_lines <= layout::kLineHeaderBytes + line_bytes / (pattern == Pattern::kSmooth ? 4 : 1));
        const OcclusionVolume volume = make_volume({20, 24, 22}, 9, pattern);
        DisplacementField field = make_empty_field();
        field.volume = volume;
        CHECK(write_field(field).size() <=
              512 + volume.memory_bytes() / (pattern == Pattern::kSmooth ? 20 : 1));
        CHECK(coded_maps <=
              layout::kDirectionHeaderBytes + maps.memory_bytes() / (pattern == Pattern::kSmooth ? 12 : 1));
    }
}

TEST_CASE("the codec's planes are those of the lookups") {
    const std::uint32_t n = 5;
    const auto points = sphere_points(Positions::kSlater, n);
    const PackedDirectionFrame packed{200, 140, 99, 150, 80, 131, 70, 190};
    std::uint32_t visited = 0;
    codec::for_each_stored_direction(n, [&](std::uint32_t i, const codec::DirectionPlace& place) {
        const codec::DirectionPlane plane = codec::direction_plane(n, place, packed);
        const DirectionFrame frame = unpack_direction_frame(packed, points.at(i));
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            REQUIRE(plane.direction[a] == Approx(points[i][axis]).margin(1e-6));
            REQUIRE(plane.axis_u[a] == Approx(frame.axis_u[axis]).margin(1e-6));
            REQUIRE(plane.axis_v[a] == Approx(frame.axis_v[axis]).margin(1e-6));
        }
        REQUIRE(plane.half_u == frame.half_u);
        REQUIRE(plane.centre_v == frame.centre_v);
        REQUIRE(plane.depth == frame.depth);
        REQUIRE(plane.slope_u == frame.slope_u);
        // On the same map a texel is where it is.
        const codec::TexelTransform same = codec::texel_transform(plane, plane, 32);
        REQUIRE(same.s == 0);
        REQUIRE(same.s_ds == 65536);
        REQUIRE(same.s_dt == 0);
        REQUIRE(same.t_dt == 65536);
        ++visited;
        return true;
    });
    CHECK(visited == stored_direction_count(n));
}
