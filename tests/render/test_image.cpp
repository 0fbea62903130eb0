#include <catch2/catch.hpp>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/picture/font.hpp"
#include "baker/picture/image.hpp"

using namespace dfield;
namespace fs = std::filesystem;

namespace {

fs::path scratch_folder() {
    const fs::path folder = fs::temp_directory_path() / "dfield_test_image";
    fs::create_directories(folder);
    return folder;
}

Image pattern(std::uint32_t width, std::uint32_t height) {
    Image image(width, height);
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
        image.rgb[i] = static_cast<std::uint8_t>(i * 37 + i / 7);
    return image;
}

bool has_ink(const Image& image, std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
    for (std::uint32_t y = y0; y < y1; ++y)
        for (std::uint32_t x = x0; x < x1; ++x)
            if (image.at(x, y)[0] < 100) return true;
    return false;
}

}  // namespace

TEST_CASE("a PNG comes back as it was written") {
    const Image image = pattern(67, 31);
    const fs::path path = scratch_folder() / "round trip.png";
    write_png(path, image);
    const Image back = read_png(path);
    CHECK(back.width == 67);
    CHECK(back.height == 31);
    CHECK(back.rgb == image.rgb);
    for (const auto& entry : fs::directory_iterator(path.parent_path()))
        CHECK(entry.path().string().find(".tmp") == std::string::npos);
}

TEST_CASE("what is no PNG, or cannot be written, is refused with the file's name") {
    const fs::path folder = scratch_folder();
    write_file_atomic(folder / "text.png", std::string_view("P3 1 1 255 0 0 0"));
    CHECK_THROWS_WITH(read_png(folder / "text.png"),
                      Catch::Contains("text.png") && Catch::Contains("not a PNG"));
    CHECK_THROWS_AS(read_png(folder / "missing.png"), InputError);
    CHECK_THROWS_AS(write_png(folder / "no such folder" / "a.png", pattern(2, 2)), OutputError);
    CHECK_THROWS_AS(write_png(folder / "empty.png", Image()), OutputError);

    write_png(folder / "whole.png", pattern(40, 40));
    std::vector<std::byte> bytes = read_file(folder / "whole.png");
    bytes.resize(bytes.size() / 2);
    write_file_atomic(folder / "half.png", bytes);
    CHECK_THROWS_AS(read_png(folder / "half.png"), InputError);
}

TEST_CASE("differences are absolute, scaled and clamped") {
    Image a(2, 1, {10, 200, 0}), b(2, 1, {20, 190, 255});
    const Image difference = image_difference(a, b, 5);
    CHECK(difference.at(0, 0)[0] == 50);
    CHECK(difference.at(1, 0)[1] == 50);
    CHECK(difference.at(0, 0)[2] == 255);
    CHECK(image_difference(a, b, 0.25f).at(0, 0)[0] == 3);  // 2.5 rounds away from zero
    CHECK_THROWS_AS(image_difference(a, Image(1, 2), 1), std::invalid_argument);
}

TEST_CASE("rows and columns keep the pictures and add captions below") {
    const Image images[] = {pattern(213, 50), pattern(300, 80)};
    const std::string captions[] = {"reference", "lookup"};
    const Image bare = image_row(images, {}, 8);
    CHECK(bare.width == 213 + 8 + 300);
    CHECK(bare.height == 80);
    const Image row = image_row(images, captions, 8);
    CHECK(row.width == bare.width);
    CHECK(row.height == 80 + kFontLine + 3);
    for (std::uint32_t x = 0; x < 300; ++x)
        REQUIRE(std::equal(row.at(221 + x, 79), row.at(221 + x, 79) + 3, images[1].at(x, 79)));
    CHECK(row.at(215, 20)[0] == 255);  // the gap
    CHECK(row.at(0, 49)[0] == images[0].at(0, 49)[0]);
    CHECK(has_ink(row, 0, 51, 213, 51 + kFontLine));
    CHECK(has_ink(row, 221, 81, 521, row.height));

    const Image column = image_column(images, 4);
    CHECK(column.width == 300);
    CHECK(column.height == 50 + 4 + 80);
    CHECK(std::equal(column.at(0, 54), column.at(0, 54) + 3 * 300, images[1].at(0, 0)));
    CHECK_THROWS_AS(image_row(images, std::span(captions, 1)), std::invalid_argument);
    CHECK(image_row({}).rgb.empty());
    CHECK(image_column({}).rgb.empty());
}

TEST_CASE("captions are larger under larger pictures") {
    const Image wide[] = {Image(640, 10)};
    const std::string captions[] = {"one line"};
    CHECK(image_row(wide, captions).height == 10 + 3 * (kFontLine + 3));
}

TEST_CASE("text wraps at spaces, newlines and, if it must, within words") {
    using Lines = std::vector<std::string>;
    CHECK(wrap_text("rms 2.1 grey", 20) == Lines{"rms 2.1 grey"});
    CHECK(wrap_text("rms 2.1 grey", 8) == Lines{"rms 2.1", "grey"});
    CHECK(wrap_text("rms 2.1 grey", 7) == Lines{"rms 2.1", "grey"});
    CHECK(wrap_text("a\nbc d", 3) == Lines{"a", "bc", "d"});
    CHECK(wrap_text("abcdefgh", 3) == Lines{"abc", "def", "gh"});
    CHECK(wrap_text("", 3) == Lines{""});
    for (const std::string& line : wrap_text(" the quick  brown fox\n\njumps over it ", 5))
        CHECK(line.size() <= 5);
}

TEST_CASE("every printable character has a glyph of its own") {
    std::set<std::string> glyphs;
    for (char letter = ' '; letter <= '~'; ++letter) {
        Image cell(kFontAdvance, kFontLine);
        draw_text(cell, 0, 0, std::string(1, letter), 1);
        CHECK(has_ink(cell, 0, 0, kFontAdvance, kFontLine) == (letter != ' '));
        CHECK(glyphs.emplace(cell.rgb.begin(), cell.rgb.end()).second);
    }
    Image question(kFontAdvance, kFontLine), unknown(kFontAdvance, kFontLine);
    draw_text(question, 0, 0, "?", 1);
    draw_text(unknown, 0, 0, "\x80", 1);
    CHECK(question.rgb == unknown.rgb);
}

TEST_CASE("text beyond the picture's edge is clipped") {
    Image image(9, 5);
    draw_text(image, 4, 2, "WWW", 2);
    CHECK(has_ink(image, 4, 2, 9, 5));
    CHECK(!has_ink(image, 0, 0, 4, 5));
}
