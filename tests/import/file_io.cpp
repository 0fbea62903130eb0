#include "baker/file_io.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "baker/error.hpp"
#include "tests/import/test_files.hpp"

using Catch::Contains;

namespace {

std::string text_of(const std::filesystem::path& path) {
    std::string text;
    for (const std::byte b : dfield::read_file(path)) text += static_cast<char>(b);
    return text;
}

}  // namespace

TEST_CASE("files go out whole and come back the same") {
    const dfield::test::TestFolder folder;
    const std::filesystem::path path = folder.path() / "a.bin";
    const std::string text("a\0b\r\n\xff", 6);
    dfield::write_file_atomic(path, std::string_view(text));
    CHECK(text_of(path) == text);
    dfield::write_file_atomic(path, std::string_view("shorter"));
    CHECK(text_of(path) == "shorter");
    dfield::write_file_atomic(path, std::string_view());
    CHECK(dfield::read_file(path).empty());
    CHECK(folder.files() == 1);
}

TEST_CASE("what cannot be written leaves nothing behind, and the old file as it was") {
    const dfield::test::TestFolder folder;
    CHECK_THROWS_WITH(dfield::write_file_atomic(folder.path() / "none" / "a", std::string_view("x")),
                      Contains("none") && Contains("does not exist"));
    std::filesystem::create_directory(folder.path() / "dir");
    CHECK_THROWS_AS(dfield::write_file_atomic(folder.path() / "dir", std::string_view("x")),
                    dfield::OutputError);
    CHECK(folder.files() == 1);
#ifdef __linux__
    if (std::filesystem::exists("/dev/full"))
        CHECK_THROWS_AS(dfield::write_file_atomic("/dev/full", std::string_view("x")), dfield::OutputError);
#endif
}

TEST_CASE("what cannot be read says why") {
    const dfield::test::TestFolder folder;
    CHECK_THROWS_WITH(dfield::read_file(folder.path() / "none.obj"),
                      Contains("none.obj") && Contains("no such file"));
    CHECK_THROWS_WITH(dfield::read_file(folder.path()), Contains("folder"));
}
