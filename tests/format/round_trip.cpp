// What is written is read back: every bit depth, mapping, layout, and odd sizes.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include "format/codec.hpp"
#include "format/file.hpp"
#include "format/layout.hpp"
#include "format/writer.hpp"
#include "tests/format/fields.hpp"

using namespace dfield;
using namespace dfield::test;

TEST_CASE("fields come back as they were written") {
    for (const Positions positions : {Positions::kSlater, Positions::kLatlong})
        for (const Mapping mapping : {Mapping::kConcentric, Mapping::kPolar, Mapping::kRejection})
            for (const std::uint32_t bits : {1u, 8u, 16u, 32u})
                for (const std::uint32_t n : {1u, 2u, 3u})
                    for (const std::uint32_t m : {1u, 2u, 3u, 5u, 8u, 9u, 17u})
                        for (const Pattern pattern :
                             {Pattern::kSmooth, Pattern::kNoise, Pattern::kAllMiss, Pattern::kAllHit}) {
                            DisplacementField field =
                                make_field({positions, n, mapping, m, bits}, pattern, n + m);
                            if (n == 2) add_optional_sections(field);
                            const auto bytes = write_field(field, {.zstd_level = 1});
                            INFO("bits " << bits << " n " << n << " m " << m << " pattern "
                                         << static_cast<int>(pattern));
                            const DisplacementField read = read_field(bytes);
                            REQUIRE(same_field(read, field));
                            REQUIRE(payload_hash(read) == payload_hash(field));
                            for (const Finding& finding : validate_file(bytes))
                                REQUIRE(finding.severity == Finding::Severity::kWarning);
                        }
}

TEST_CASE("32 bit distances keep their extremes") {
    DisplacementField field =
        make_field({Positions::kSlater, 1, Mapping::kConcentric, 4, 32}, Pattern::kSmooth);
    const float values[] = {0.0f, std::numeric_limits<float>::denorm_min(), std::nextafter(1.0f, 0.0f), 1.0f,
                            1e-30f};
    for (std::size_t i = 0; i < field.texels.size() / 4; ++i)
        store_float(&field.texels[4 * i], values[i % 5]);
    CHECK(same_field(read_field(write_field(field)), field));
}

TEST_CASE("noise does not grow") {
    for (const std::uint32_t bits : {1u, 8u, 16u, 32u}) {
        DisplacementField field =
            make_field({Positions::kSlater, 8, Mapping::kConcentric, 16, bits}, Pattern::kNoise);
        const std::uint64_t raw = texel_bytes(field.parameters) + codec::plane_bytes(field.parameters) +
                                  2 * field.mean_depth.size();
        CHECK(write_field(field).size() < raw + raw / 100 + 2048);
    }
}

TEST_CASE("smooth fields shrink") {
    for (const std::uint32_t bits : {1u, 8u, 16u}) {
        const DisplacementField field =
            make_field({Positions::kSlater, 8, Mapping::kConcentric, 32, bits}, Pattern::kSmooth);
        CHECK(write_field(field).size() < field.texels.size() / 6);
    }
}

TEST_CASE("the payload does not depend on how it is compressed, the bytes not on threads") {
    DisplacementField field =
        make_field({Positions::kSlater, 4, Mapping::kConcentric, 16, 8}, Pattern::kSmooth);
    add_optional_sections(field);
    const auto reference = write_field(field);
    CHECK(write_field(field, {.threads = 8}) == reference);
    for (const int level : {-7, 1, 22, 1000})
        CHECK(same_field(read_field(write_field(field, {.zstd_level = level})), field));
}

TEST_CASE("the payload hash tells fields apart, and ignores the provenance") {
    const DisplacementField field =
        make_field({Positions::kSlater, 2, Mapping::kConcentric, 4, 8}, Pattern::kSmooth);
    const std::string hash = payload_hash(field);
    CHECK(hash.size() == 32);
    CHECK(hash.find_first_not_of("0123456789abcdef") == std::string::npos);
    DisplacementField other = field;
    other.provenance = "{}";
    CHECK(payload_hash(other) == hash);
    const auto differs = [&](auto change) {
        DisplacementField changed = field;
        change(changed);
        return payload_hash(changed) != hash;
    };
    CHECK(differs([](DisplacementField& f) { f.radius = 3; }));
    CHECK(differs([](DisplacementField& f) { f.bounds_max.z += 0.1f; }));
    CHECK(differs([](DisplacementField& f) { f.parameters.mapping = Mapping::kPolar; }));
    CHECK(differs([](DisplacementField& f) { f.texels.back() ^= 1; }));
    CHECK(differs([](DisplacementField& f) { f.mean_depth.push_back(1); }));
    CHECK(differs([](DisplacementField& f) { f.self_visibility.push_back(0); }));
}

TEST_CASE("file information names the sections") {
    DisplacementField field =
        make_field({Positions::kSlater, 2, Mapping::kConcentric, 4, 1}, Pattern::kSmooth);
    add_optional_sections(field);
    const auto bytes = write_field(field);
    const FileInfo info = read_file_info(bytes);
    CHECK(info.version_major == layout::kVersionMajor);
    CHECK(info.file_bytes == bytes.size());
    std::string ids;
    for (const SectionInfo& section : info.sections) ids += section.id + " ";
    CHECK(ids == "FELD MASK MEAN SELF PROV ");
}

TEST_CASE("the writer refuses fields that break a rule") {
    const FieldParameters p{Positions::kSlater, 2, Mapping::kConcentric, 5, 8};
    const auto refused = [](const FieldParameters& parameters, auto change) {
        DisplacementField field = make_field(parameters, Pattern::kSmooth);
        change(field);
        CHECK_THROWS_AS(write_field(field), std::invalid_argument);
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    refused(p, [](DisplacementField& f) { f.parameters.bits = 4; });
    refused(p, [](DisplacementField& f) { f.parameters.map_size = 0; });
    refused(p, [](DisplacementField& f) { f.texels.pop_back(); });
    refused(p, [](DisplacementField& f) { f.mean_depth.resize(3); });
    refused(p, [&](DisplacementField& f) { f.radius = nan; });
    refused(p, [](DisplacementField& f) { f.radius = 0; });
    refused(p, [](DisplacementField& f) { f.radius = -1; });
    refused(p, [](DisplacementField& f) { f.radius = 1e-42f; });
    refused(p, [](DisplacementField& f) { f.radius = 3e38f; });
    refused(p, [&](DisplacementField& f) { f.centre.y = nan; });
    refused(p, [](DisplacementField& f) { f.bounds_min.x = f.bounds_max.x + 1; });
    refused(p, [](DisplacementField& f) { f.bounds_max.y = 100; });
    refused(p, [](DisplacementField& f) { f.provenance = "text"; });
    refused(p, [](DisplacementField& f) { f.provenance = "{\xff}"; });
    FieldParameters one = p, rejection = p, floats = p;
    one.bits = 1;
    rejection.mapping = Mapping::kRejection;
    floats.bits = 32;
    refused(one, [](DisplacementField& f) { f.texels[3] |= 0x80; });  // 25 bits a map
    refused(one, [](DisplacementField& f) { f.mean_depth.clear(); });
    refused(one, [](DisplacementField& f) { std::fill(f.texels.begin(), f.texels.end(), std::uint8_t{0}); });
    refused(rejection, [](DisplacementField& f) { f.texels[0] = 7; });
    for (const float value :
         {nan, -0.0f, -0.5f, std::nextafter(1.0f, 2.0f), std::numeric_limits<float>::infinity()})
        refused(floats, [&](DisplacementField& f) { store_float(&f.texels[40], value); });
}
