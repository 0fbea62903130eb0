// NRRD headers whose voxels are in other files.
#include "tests/volume_files/volume_bytes.hpp"

using namespace dfield;
using namespace dfield::test;
using Catch::Contains;

namespace {

const std::string kHead = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 3 2\nencoding: raw\n";

std::vector<std::uint8_t> read(const std::filesystem::path& path) {
    return voxels_of<std::uint8_t>(read_volume(path));
}

}  // namespace

TEST_CASE("NRRD: one data file, relative to the header or anywhere") {
    const TestFolder folder;
    std::filesystem::create_directory(folder.path() / "sub");
    const auto voxels = folder.write("v o x.raw", kVoxels);
    folder.write("sub/voxels.raw", kVoxels);
    CHECK(read(folder.write("a.nhdr", kHead + "data file: v o x.raw\n")) == kValues);
    CHECK(read(folder.write("a.nhdr", kHead + "datafile: ./sub/voxels.raw\n\n")) == kValues);
    CHECK(read(folder.write("a.nrrd", kHead + "Data File:   " + voxels.string())) == kValues);
    folder.write("head.raw", "one\ntwo\n__" + kVoxels);
    CHECK(read(folder.write("a.nhdr", kHead + "line skip: 2\nbyte skip: 2\ndata file: head.raw\n")) ==
          kValues);
    CHECK(read(folder.write("a.nhdr", kHead + "byte skip: -1\ndata file: head.raw\n")) == kValues);
    folder.write("voxels.gz", gzip(kVoxels));
    const std::string gzip_head = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 3 2\nencoding: gzip\n";
    CHECK(read(folder.write("a.nhdr", gzip_head + "data file: voxels.gz\n")) == kValues);
}

TEST_CASE("NRRD: lists of files") {
    const TestFolder folder;
    folder.write("z0", kVoxels.substr(0, 6));
    folder.write("z1", kVoxels.substr(6));
    for (int row = 0; row < 6; ++row)
        folder.write("row" + std::to_string(row), kVoxels.substr(2 * static_cast<std::size_t>(row), 2));
    CHECK(read(folder.write("a.nhdr", kHead + "data file: LIST\nz0\nz1\n")) == kValues);
    CHECK(read(folder.write("a.nhdr", kHead + "data file: LIST 2\r\nz0\r\nz1")) == kValues);
    CHECK(read(folder.write("a.nhdr", kHead + "data file: LIST 3\nz0\nz1\n")) == kValues);
    CHECK(read(folder.write("a.nhdr", kHead + "data file: LIST 1\nrow0\nrow1\nrow2\nrow3\nrow4\nrow5\n")) ==
          kValues);
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: LIST\nz0\nz1\nz0\n")),
               Contains("3 data files do not share out 2 x 3 x 2"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: LIST 1\nz0\nz1\n")),
               Contains("2 data files"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: LIST\n")), Contains("no file after it"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: LIST\nz0\nz2\n")),
               Contains("a.nhdr") && Contains("z2") && Contains("does not exist"));
}

TEST_CASE("NRRD: numbered files") {
    const TestFolder folder;
    folder.write("s008.raw", kVoxels.substr(0, 6));
    folder.write("s010.raw", kVoxels.substr(6));
    folder.write("t-1", kVoxels.substr(0, 6));
    folder.write("t-2", kVoxels.substr(6));
    CHECK(read(folder.write("a.nhdr", kHead + "data file: s%03d.raw 8 10 2\n")) == kValues);
    CHECK(read(folder.write("a.nhdr", kHead + "data file: s%03d.raw 8 11 2 2\n")) == kValues);
    CHECK(read(folder.write("a.nhdr", kHead + "data file: t%d -1 -2 -1\n")) == kValues);
    const std::vector<std::uint8_t> backwards{6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 4, 5};
    CHECK(read(folder.write("a.nhdr", kHead + "data file: s%03d.raw 10 8 -2\n")) == backwards);
    for (const std::string wrong :
         {"s%03d.raw 8 10 0", "s%03d.raw 8 10 -2", "s%s%d.raw 8 10 2", "s%n 8 10 2", "s%d%n 8 10 2",
          "s%99999999999d 8 10 2", "s%.3d 8 10 2", "s%03d.raw 8 x 2", "s%03d.raw 8 10 2 0", "s% 8 10 2"}) {
        INFO(wrong);
        CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: " + wrong + "\n")),
                   Contains("a.nhdr: line 6: "));
    }
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: s%d 0 2000000000 1\n")),
               Contains("more than 65536"));
}

TEST_CASE("NRRD: data files that are missing, too short or no files") {
    const TestFolder folder;
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: none.raw\n")),
               Contains("a.nhdr: its data file") && Contains("none.raw does not exist"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: .\n")), Contains("is a folder"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: -\n")), Contains("'-'"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: /dev/zero\n")),
               Contains("no regular file"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: \n")), Contains("names no file"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: a\ndata file: b\n")), Contains("second"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: SKIPLIST\n4 a\n")), Contains("SKIPLIST"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead)), Contains("cut off"));
    folder.write("short.raw", kVoxels.substr(1));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "data file: short.raw\n")),
               Contains("short.raw: 2 x 3 x 2 voxels of type u8 take 12 bytes, the file has 11"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "byte skip: -1\ndata file: short.raw\n")),
               Contains("the file has 11"));
    CHECK_THAT(error_of(folder.write("a.nhdr", kHead + "line skip: 7\ndata file: short.raw\n")),
               Contains("'line skip'"));
}
