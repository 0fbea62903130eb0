// Every truncated prefix, every flipped bit, every extension of valid files is refused with a reason.
#include <catch2/catch.hpp>

#include "format/file.hpp"
#include "format/writer.hpp"
#include "tests/format/fields.hpp"
#include "tests/format/file_editor.hpp"
#include "tests/format/kinds.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

std::vector<Bytes> small_files() {
    std::vector<Bytes> files;
    for (const std::uint32_t bits : {1u, 8u}) {
        DisplacementField field =
            make_field({Positions::kSlater, 1, Mapping::kConcentric, 5, bits}, Pattern::kSmooth);
        add_optional_sections(field);
        files.push_back(write_field(field));
        REQUIRE(accepted(files.back()));
    }
    DisplacementField directions = make_empty_field();
    directions.lines = make_line_table(line_parameters(3, 4, 2), Pattern::kSmooth);
    directions.directions.push_back(make_direction_maps({1, 16, 8}, Pattern::kSmooth));
    DisplacementField volume = make_empty_field();
    volume.volume = make_volume({4, 5, 4}, 3, Pattern::kNoise);
    for (const DisplacementField& field : {make_all_kinds_and_volume(), directions, volume}) {
        files.push_back(write_field(field));
        REQUIRE(accepted(files.back()));
    }
    return files;
}

// Refused by read_field and validate_file, with the same code.
bool refused(std::span<const std::byte> bytes) {
    const Refusal result = refusal(bytes);
    return result.code != FormatErrorCode{0} && format_error_name(result.code) != "unknown" &&
           result.message.size() > 30;
}

}  // namespace

TEST_CASE("every truncated prefix is refused") {
    for (const Bytes& file : small_files())
        for (std::size_t size = 0; size < file.size(); ++size) REQUIRE(refused(std::span(file).first(size)));
}

TEST_CASE("every flipped bit is refused") {
    for (Bytes file : small_files())
        for (std::size_t bit = 0; bit < 8 * file.size(); ++bit) {
            const auto mask = static_cast<std::byte>(1 << bit % 8);
            file[bit / 8] ^= mask;
            INFO("bit " << bit);
            REQUIRE(refused(file));
            file[bit / 8] ^= mask;
        }
}

TEST_CASE("extensions are refused") {
    for (const Bytes& file : small_files())
        for (const std::size_t more : {1, 2, 7, 8, 64, 4096})
            for (const std::byte fill : {std::byte{0}, std::byte{0xff}}) {
                Bytes longer = file;
                longer.resize(file.size() + more, fill);
                check_refused(longer, FormatErrorCode::kFileSize);
                // Also where the header knows of the extension.
                store_le(&longer[layout::kFileBytesAt], std::uint64_t{longer.size()});
                seal(longer);
                check_refused(longer, FormatErrorCode::kSectionPlacement);
            }
}

TEST_CASE("other files are refused by what they are") {
    check_refused({}, FormatErrorCode::kTooShort);
    Bytes text(1000, std::byte{'a'});
    check_refused(text, FormatErrorCode::kMagic);
    Bytes converted = small_files()[0];
    converted.erase(converted.begin() + 4);  // "\r\n" made "\n"
    check_refused(converted, FormatErrorCode::kMagic);
    check_refused(std::span(small_files()[0]).first(100), FormatErrorCode::kFileSize);
}
