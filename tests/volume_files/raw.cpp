// Raw voxels and the names of files.
#include "tests/volume_files/volume_bytes.hpp"

using namespace dfield;
using namespace dfield::test;
using Catch::Contains;

namespace {

template<class T>
void check_raw(VoxelType type) {
    const TestFolder folder;
    const auto values = sample_voxels<T>();
    for (const std::endian endian : {std::endian::little, std::endian::big}) {
        const auto path = folder.write("a.bin", "header" + bytes_of_all(values, endian == std::endian::big));
        const Volume volume = read_volume(path, {.raw = RawLayout{{2, 3, 2}, type, {1, 2, 0.25}, endian, 6}});
        CHECK(voxels_of<T>(volume) == values);
        CHECK(volume.type == type);
        check_vector(volume.grid.spacing(), {1, 2, 0.25});
        CHECK(volume.grid.space.empty());
    }
}

}  // namespace

TEST_CASE("raw voxels of every type in both byte orders") {
    check_raw<std::int8_t>(VoxelType::kI8);
    check_raw<std::uint8_t>(VoxelType::kU8);
    check_raw<std::int16_t>(VoxelType::kI16);
    check_raw<std::uint16_t>(VoxelType::kU16);
    check_raw<std::int32_t>(VoxelType::kI32);
    check_raw<std::uint32_t>(VoxelType::kU32);
    check_raw<float>(VoxelType::kF32);
    check_raw<double>(VoxelType::kF64);
}

TEST_CASE("raw voxels must fill the file") {
    const TestFolder folder;
    const auto path = folder.write("a.raw", std::string(12, 'x'));
    const auto error = [&](std::array<std::size_t, 3> size, VoxelType type, std::uint64_t header,
                           glm::dvec3 spacing = {1, 1, 1}) {
        return error_of(path, {.raw = RawLayout{size, type, spacing, std::endian::little, header}});
    };
    CHECK(error({2, 3, 2}, VoxelType::kU8, 0) == "no error");
    CHECK_THAT(error({2, 3, 1}, VoxelType::kU8, 0), Contains("take 6 bytes, the file has 12;"));
    CHECK_THAT(error({2, 3, 2}, VoxelType::kU16, 0), Contains("take 24 bytes, the file has 12;"));
    CHECK_THAT(error({2, 3, 2}, VoxelType::kU8, 1), Contains("the file has 11 after the header"));
    CHECK_THAT(error({2, 3, 2}, VoxelType::kU8, UINT64_MAX), Contains("the file has 0 after the header"));
    CHECK_THAT(error({0, 3, 2}, VoxelType::kU8, 0), Contains("0 x 3 x 2") && Contains("above 0"));
    CHECK_THAT(error({SIZE_MAX, SIZE_MAX, 2}, VoxelType::kF64, 0), Contains("more than the 65536 MiB"));
    CHECK_THAT(error({std::size_t{1} << 32, std::size_t{1} << 32, 1}, VoxelType::kU8, 0),
               Contains("more than"));
    CHECK_THAT(error({2, 3, 2}, VoxelType::kU8, 0, {1, 0, 1}), Contains("spacing along y"));
    CHECK_THAT(error({2, 3, 2}, VoxelType::kU8, 0, {1, 1, NAN}), Contains("spacing along z"));
    CHECK_THAT(error_of(folder.path() / "none.raw", {.raw = RawLayout{}}), Contains("size is 0 x 0 x 0"));
}

TEST_CASE("what a file is taken for") {
    const TestFolder folder;
    CHECK(volume_format("a.NRRD") == std::string("NRRD"));
    CHECK(volume_format("a.nii.gz") == std::string("NIfTI"));
    CHECK(volume_format("a.nrrd", {.raw = RawLayout{}}) == std::string("raw"));
    CHECK_THAT(error_of(folder.write("a.mhd", "NDims = 3\n")), Contains("'.mhd'") && Contains("--dims"));
    CHECK_THAT(error_of(folder.write("a.vti", "<VTKFile>")), Contains("save it as NRRD"));
    CHECK_THAT(error_of(folder.write("a.raw", "xyz")),
               Contains("unknown kind of volume '.raw'") && Contains("--dims"));
    CHECK_THAT(error_of(folder.path() / "none.nrrd"), Contains("none.nrrd: no such file"));
    CHECK_THAT(error_of(folder.path() / "none.nii"), Contains("none.nii: no such file"));
    std::filesystem::create_directory(folder.path() / "dir.nii");
    CHECK_THAT(error_of(folder.path() / "dir.nii"), Contains("is a folder"));
}
