// NRRD: types, byte orders, encodings of attached voxels.
#include "tests/volume_files/volume_bytes.hpp"

using namespace dfield;
using namespace dfield::test;
using Catch::Contains;

namespace {

template<class T>
void check_type(VoxelType type, const std::vector<std::string>& names) {
    const TestFolder folder;
    const auto values = sample_voxels<T>();
    for (const std::string& name : names)
        for (const bool big : {false, true})
            for (const bool compressed : {false, true}) {
                INFO(name << (big ? " big" : " little") << (compressed ? " gzip" : " raw"));
                const std::string fields =
                    "spacings: 1 2 3\nencoding: " + std::string(compressed ? "gzip" : "raw") +
                    "\nendian: " + (big ? "big" : "little") + "\n";
                const std::string bytes = bytes_of_all(values, big);
                const auto path =
                    folder.write("a.nrrd", nrrd(name, "2 3 2", fields, compressed ? gzip(bytes) : bytes));
                std::vector<std::string> warnings;
                const Volume volume = read_volume(path, {}, &warnings);
                CHECK(volume.type == type);
                CHECK(volume.grid.size == std::array<std::size_t, 3>{2, 3, 2});
                CHECK(voxels_of<T>(volume) == values);
                CHECK(value_range(volume).min == static_cast<double>(std::numeric_limits<T>::lowest()));
                CHECK(value_range(volume).max == static_cast<double>(std::numeric_limits<T>::max()));
                CHECK(warnings.empty());
            }
}

Volume read(const std::string& bytes, std::vector<std::string>* warnings = nullptr) {
    const TestFolder folder;
    return read_volume(folder.write("a.nrrd", bytes), {}, warnings);
}

}  // namespace

TEST_CASE("NRRD: every type, in both byte orders, by all of its names") {
    check_type<std::int8_t>(VoxelType::kI8, {"signed char", "int8", "int8_t"});
    check_type<std::uint8_t>(VoxelType::kU8, {"uchar", "unsigned char", "uint8", "uint8_t"});
    check_type<std::int16_t>(VoxelType::kI16, {"short", "signed short", "int16", "int16_t"});
    check_type<std::uint16_t>(VoxelType::kU16, {"ushort", "unsigned short", "uint16", "uint16_t"});
    check_type<std::int32_t>(VoxelType::kI32, {"int", "signed int", "int32", "int32_t"});
    check_type<std::uint32_t>(VoxelType::kU32, {"uint", "unsigned int", "uint32", "uint32_t"});
    check_type<float>(VoxelType::kF32, {"float"});
    check_type<double>(VoxelType::kF64, {"double"});
}

TEST_CASE("NRRD: gzip, in one member or several, with bytes to skip inside") {
    const std::string fields = "encoding: gzip\n";
    CHECK(voxels_of<std::uint8_t>(read(nrrd("uchar", "2 3 2", fields, gzip(kVoxels)))) == kValues);
    CHECK(voxels_of<std::uint8_t>(read(nrrd(
              "uchar", "2 3 2", fields, gzip(kVoxels.substr(0, 5)) + gzip(kVoxels.substr(5))))) == kValues);
    CHECK(voxels_of<std::uint8_t>(read(
              nrrd("uchar", "2 3 2", "encoding: gz\nbyte skip: 4\n", gzip("head" + kVoxels)))) == kValues);
    // 40 MB of zeros in 40 KB, close to the best that deflate can do.
    std::vector<std::string> warnings;
    const Volume zeros =
        read(nrrd("uchar", "1000 1000 40", fields, gzip(std::string(40'000'000, '\0'))), &warnings);
    CHECK(value_range(zeros).max == 0);
    CHECK(warnings.empty());
}

TEST_CASE("NRRD: voxels as text") {
    const std::string fields = "encoding: ascii\n";
    CHECK(voxels_of<std::uint8_t>(read(nrrd("uchar", "2 3 2", fields, "0 1 2 3\n4,5, 6\t7\r\n8 9 +10 11"))) ==
          kValues);
    CHECK(voxels_of<std::int16_t>(read(nrrd("short", "1 1 3", "encoding: text\n", "-32768 32767 -1\n"))) ==
          std::vector<std::int16_t>{-32768, 32767, -1});
    CHECK(voxels_of<float>(read(nrrd("float", "1 1 3", fields, "1e-3 -2.5 3\n"))) ==
          std::vector<float>{1e-3f, -2.5f, 3.0f});
}

TEST_CASE("NRRD: lines that end as on Windows, comments, keys, fields in any case and order") {
    const Volume volume = read(
        "NRRD0005\r\n# a comment\r\n#\r\nencoding: raw\r\nkey:=value: with colon\r\nmin: x\r\ncontent: "
        "Bonsai\r\nType: uchar\r\nDimension: 3\r\nlabels: \"x\" \"y\" \"z\"\r\nsizes: 2 3 "
        "2\r\naxismins: 0 0 "
        "0\r\n\r\n" +
        kVoxels);
    CHECK(voxels_of<std::uint8_t>(volume) == kValues);
}

TEST_CASE("NRRD: bytes after the voxels are said to be left out") {
    for (const bool compressed : {false, true}) {
        std::vector<std::string> warnings;
        const std::string voxels = kVoxels + "xyz";
        const Volume volume = read(nrrd("uchar", "2 3 2", compressed ? "encoding: gzip\n" : "encoding: raw\n",
                                        compressed ? gzip(voxels) : voxels),
                                   &warnings);
        CHECK(voxels_of<std::uint8_t>(volume) == kValues);
        REQUIRE(warnings.size() == 1);
        CHECK_THAT(warnings[0], Contains("a.nrrd") && Contains("left out"));
    }
}

TEST_CASE("NRRD: skipped lines and bytes before attached voxels") {
    CHECK(voxels_of<std::uint8_t>(read(nrrd("uchar", "2 3 2", "encoding: raw\nline skip: 2\nbyte skip: 3\n",
                                            "first\n\nxyz" + kVoxels))) == kValues);
    CHECK(voxels_of<std::uint8_t>(read(
              nrrd("uchar", "2 3 2", "encoding: raw\nbyte skip: -1\n", "anything" + kVoxels))) == kValues);
    CHECK(voxels_of<std::uint8_t>(read(nrrd("uchar", "2 3 2", "encoding: gzip\nlineskip: 1\n",
                                            "a line\n" + gzip(kVoxels)))) == kValues);
}

TEST_CASE("voxels as floats") {
    const Volume volume = read(nrrd("double", "3 1 1", "encoding: ascii\n", "1.5 -2 1e30"));
    CHECK(float_values(volume) == std::vector<float>{1.5f, -2.0f, 1e30f});
    CHECK_THROWS_AS(float_values(read(nrrd("double", "1 1 1", "encoding: ascii\n", "1e300"))), InputError);
}
