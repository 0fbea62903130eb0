// Cut and damaged files: read, or refused with an InputError that names the file.
#include <algorithm>

#include "tests/random.hpp"
#include "tests/screen_files/buffers.hpp"

using namespace dfield;
using namespace dfield::test;
using Catch::Contains;

namespace {

bool readable(const TestFolder& folder, const std::string& file, const std::string& named) {
    try {
        const GBuffer buffer = read_gbuffer(folder.path() / file);
        REQUIRE(buffer.depth.size() == buffer.pixels());
        REQUIRE((buffer.normals.empty() || buffer.normals.size() == buffer.pixels()));
        return true;
    } catch (const InputError& error) {
        REQUIRE_THAT(error.what(), Contains(named));
        return false;
    }
}

}  // namespace

TEST_CASE("every cut of an EXR is refused, every damage survived") {
    const TestFolder folder;
    write_gbuffer(folder.path() / "a.exr", small_buffer());
    const std::string bytes = text_of(folder.path() / "a.exr");
    REQUIRE(readable(folder, "a.exr", "a.exr"));
    for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 64) {
        INFO(size);
        folder.write("cut.exr", bytes.substr(0, size));
        CHECK_FALSE(readable(folder, "cut.exr", "cut.exr"));
    }
    for (std::size_t at = 0; at < bytes.size(); at += 1 + at / 256) {
        std::string damaged = bytes;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
        folder.write("bad.exr", damaged);
        readable(folder, "bad.exr", "bad.exr");
    }
}

TEST_CASE("every cut of a depth PNG is refused, every damage survived") {
    const TestFolder folder;
    write_gbuffer(folder.path() / "a.json", small_buffer());
    const std::string bytes = text_of(folder.path() / "a-depth.png");
    REQUIRE(readable(folder, "a.json", "a"));
    for (std::size_t size = 0; size + 12 < bytes.size(); ++size) {  // what follows IDAT need not be there
        INFO(size);
        folder.write("a-depth.png", bytes.substr(0, size));
        CHECK_FALSE(readable(folder, "a.json", "a-depth.png"));
    }
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::string damaged = bytes;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
        folder.write("a-depth.png", damaged);
        readable(folder, "a.json", "a");
    }
}

TEST_CASE("a few bytes cannot ask for gigabytes") {
    const TestFolder folder;
    write_gbuffer(folder.path() / "a.exr", small_buffer());
    std::string exr = text_of(folder.path() / "a.exr");
    // The box of the data window, and that of the display window.
    const std::string box = bytes_of<std::int32_t>({0, 0, 6, 4});
    for (std::size_t at = exr.find(box); at != std::string::npos; at = exr.find(box, at + 1))
        exr.replace(at, box.size(), bytes_of<std::int32_t>({0, 0, 16000, 16000}));
    folder.write("large.exr", exr);
    CHECK_THAT(error_of(folder.path() / "large.exr"), Contains("large.exr"));

    // An attribute of two gigabytes.
    exr = text_of(folder.path() / "a.exr");
    const std::string attribute("dfield\0string\0", 14);
    REQUIRE(exr.find(attribute) != std::string::npos);
    exr.replace(exr.find(attribute) + attribute.size(), 4, bytes_of<std::uint32_t>({0x7f000000}));
    folder.write("attribute.exr", exr);
    CHECK_THAT(error_of(folder.path() / "attribute.exr"), Contains("cut off or broken"));

    write_gbuffer(folder.path() / "a.json", small_buffer());
    std::string png = text_of(folder.path() / "a-depth.png");
    png.replace(16, 8, bytes_of<std::uint32_t>({16000, 16000}, true));
    folder.write("a-depth.png", png);
    CHECK_THAT(error_of(folder.path() / "a.json"), Contains("cut off or broken"));
}
