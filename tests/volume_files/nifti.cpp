// NIfTI-1 and -2: types, byte orders, pairs, scaling, transforms.
#include <cmath>

#include "tests/volume_files/volume_bytes.hpp"

using namespace dfield;
using namespace dfield::test;
using Catch::Contains;

namespace {

Volume read(const NiftiHeader& header, const std::string& voxels = kVoxels) {
    const TestFolder folder;
    return read_volume(folder.write("a.nii", header.bytes() + voxels));
}

std::string error_with(const NiftiHeader& header, const std::string& voxels = kVoxels) {
    const TestFolder folder;
    return error_of(folder.write("a.nii", header.bytes() + voxels));
}

template<class T>
void check_type(VoxelType type, int datatype) {
    const auto values = sample_voxels<T>();
    for (const bool big : {false, true}) {
        INFO(name_of(type) << (big ? " big" : " little"));
        const NiftiHeader header =
            NiftiHeader(big).dims({2, 3, 2}).type(datatype, 8 * int{sizeof(T)}).spacing(1, 2, 4).scale(1, 0);
        const Volume volume = read(header, bytes_of_all(values, big));
        CHECK(volume.type == type);
        CHECK(voxels_of<T>(volume) == values);
        check_vector(volume.grid.spacing(), {1, 2, 4});
    }
}

// NIfTI-2's layout, by the numbers of nifti2.h.
std::string nifti2(bool big) {
    std::string bytes(544, '\0');
    const auto put = [&](std::size_t at, const std::string& value) {
        bytes.replace(at, value.size(), value);
    };
    put(0, bytes_of<std::int32_t>({540}, big));
    put(4, std::string("n+2\0\r\n\032\n", 8));
    put(12, bytes_of<std::int16_t>({4, 16}, big));  // i16
    put(16, bytes_of<std::int64_t>({3, 2, 3, 2}, big));
    put(104, bytes_of<double>({1, 0.1, 0.2, 0.3}, big));
    put(168, bytes_of<std::int64_t>({544}, big));
    put(344, bytes_of<std::int32_t>({0, 1}, big));  // sform
    put(400, bytes_of<double>({0, 0.1, 0, 5, 0.2, 0, 0, 6, 0, 0, 0.3, 7}, big));
    put(500, bytes_of<std::int32_t>({2}, big));
    return bytes + bytes_of_all(sample_voxels<std::int16_t>(), big);
}

}  // namespace

TEST_CASE("NIfTI: every type in both byte orders") {
    check_type<std::int8_t>(VoxelType::kI8, 256);
    check_type<std::uint8_t>(VoxelType::kU8, 2);
    check_type<std::int16_t>(VoxelType::kI16, 4);
    check_type<std::uint16_t>(VoxelType::kU16, 512);
    check_type<std::int32_t>(VoxelType::kI32, 8);
    check_type<std::uint32_t>(VoxelType::kU32, 768);
    check_type<float>(VoxelType::kF32, 16);
    check_type<double>(VoxelType::kF64, 64);
}

TEST_CASE("NIfTI-2 in both byte orders") {
    const TestFolder folder;
    for (const bool big : {false, true}) {
        const Volume volume = read_volume(folder.write("a.nii", nifti2(big)));
        CHECK(voxels_of<std::int16_t>(volume) == sample_voxels<std::int16_t>());
        check_vector(volume.grid.origin, {5, 6, 7});
        check_vector(volume.grid.directions[0], {0, 0.2, 0});
        check_vector(volume.grid.directions[1], {0.1, 0, 0});
        check_vector(volume.grid.directions[2], {0, 0, 0.3});
        CHECK_FALSE(volume.grid.right_handed());
        CHECK(volume.grid.unit == "mm");
    }
}

TEST_CASE("NIfTI: compressed, in pairs, under any of the pair's names") {
    const TestFolder folder;
    const std::string single = small_nifti().bytes() + kVoxels;
    const auto read_file = [&](const std::string& name) {
        return voxels_of<std::uint8_t>(read_volume(folder.path() / name));
    };
    folder.write("a.nii.gz", gzip(single));
    CHECK(read_file("a.nii.gz") == kValues);
    folder.write("b.nii", gzip(single));  // compressed, whatever it is called
    CHECK(read_file("b.nii") == kValues);
    folder.write("c.hdr", small_nifti(true, true).bytes());
    folder.write("c.img", kVoxels);
    CHECK(read_file("c.hdr") == kValues);
    CHECK(read_file("c.img") == kValues);
    folder.write("d.hdr.gz", gzip(small_nifti(false, true).set<float>(108, 16).bytes()));
    folder.write("d.img.gz", gzip(std::string(16, 'x') + kVoxels));
    CHECK(read_file("d.hdr.gz") == kValues);
    CHECK(read_file("d.img.gz") == kValues);
    folder.write("e.hdr", small_nifti(false, true).bytes());
    CHECK_THAT(error_of(folder.path() / "e.hdr"), Contains("e.img") && Contains("do not exist"));
    CHECK_THAT(error_of(folder.path() / "f.img"), Contains("f.img: no such file"));
}

TEST_CASE(
    "NIfTI: extensions before the voxels are stepped over, and an offset of 0 is the first there can be") {
    const std::string extension = bytes_of<std::int32_t>({16, 6}) + "comment!";
    NiftiHeader header = small_nifti();
    header.set<float>(108, 368).set<char>(348, 1);
    CHECK(voxels_of<std::uint8_t>(read(header, extension + kVoxels)) == kValues);
    CHECK(voxels_of<std::uint8_t>(read(small_nifti().set<float>(108, 0))) == kValues);
}

TEST_CASE("NIfTI: slope and intercept") {
    const Volume half = read(small_nifti().scale(0.5, -1));
    CHECK(half.type == VoxelType::kF32);
    CHECK(half.voxels<float>()[0] == -1);
    CHECK(half.voxels<float>()[11] == 4.5f);
    const Volume shifted = read(small_nifti(true).scale(1, 1000));
    CHECK(shifted.voxels<float>()[3] == 1003);
    // 32-bit integers keep their digits.
    const Volume wide = read(NiftiHeader().dims({1, 1, 2}).type(8, 32).scale(2, 1),
                             bytes_of<std::int32_t>({2147483647, -2147483647}));
    CHECK(wide.type == VoxelType::kF64);
    CHECK(voxels_of<double>(wide) == std::vector<double>{4294967295.0, -4294967293.0});
    for (const auto& [slope, intercept] : {std::pair<float, float>{0, 5}, {1, 0}, {NAN, NAN}}) {
        const Volume plain = read(small_nifti().scale(slope, intercept));
        CHECK(plain.type == VoxelType::kU8);
        CHECK(voxels_of<std::uint8_t>(plain) == kValues);
    }
    CHECK_THAT(error_with(small_nifti().scale(INFINITY, 0)), Contains("slope"));
    CHECK_THAT(error_with(small_nifti().scale(2, NAN)), Contains("intercept"));
    CHECK_THAT(
        error_with(NiftiHeader().dims({1, 1, 1}).type(16, 32).scale(3e38f, 0), bytes_of<float>({3e38f})),
        Contains("infinite"));
}

TEST_CASE("NIfTI: sform before qform before the spacing") {
    const VolumeGrid plain = read(small_nifti().spacing(1.5, 2, 3).units(2)).grid;
    check_vector(plain.spacing(), {1.5, 2, 3});
    CHECK(plain.origin == glm::dvec3(0));
    CHECK(plain.space.empty());
    CHECK(plain.unit == "mm");

    // A quarter turn about z: (a, b, c, d) = (cos 45, 0, 0, sin 45); x goes to y, y to -x.
    const float s = std::sqrt(0.5f);
    NiftiHeader turned = small_nifti();
    turned.spacing(1, 2, 3).qform(1, {0, 0, s}, {10, 20, 30}).units(3);
    const VolumeGrid q = read(turned).grid;
    CHECK(q.space == "right-anterior-superior");
    CHECK(q.unit == "um");
    check_vector(q.directions[0], {0, 1, 0}, 1e-6);
    check_vector(q.directions[1], {-2, 0, 0}, 1e-6);
    check_vector(q.directions[2], {0, 0, 3}, 1e-6);
    check_vector(q.origin, {10, 20, 30});
    CHECK(q.right_handed());
    turned.qform(-1, {0, 0, s}, {10, 20, 30});  // qfac: the third axis turns around
    CHECK_FALSE(read(turned).grid.right_handed());
    check_vector(read(turned).grid.directions[2], {0, 0, -3}, 1e-6);

    // An oblique sform wins over both, and over a spacing that is none.
    turned.sform({0.5, 0, 0.25, -1, 0, 2, 0, -2, -0.25, 0, 0.5, -3}).spacing(0, NAN, -1);
    const VolumeGrid oblique = read(turned).grid;
    check_vector(oblique.directions[0], {0.5, 0, -0.25});
    check_vector(oblique.directions[1], {0, 2, 0});
    check_vector(oblique.directions[2], {0.25, 0, 0.5});
    check_vector(oblique.origin, {-1, -2, -3});
}

TEST_CASE("NIfTI: one point in time is a volume, several are not") {
    CHECK(read(small_nifti().dims({2, 3, 2, 1, 1})).grid.size == std::array<std::size_t, 3>{2, 3, 2});
    CHECK_THAT(error_with(small_nifti().dims({2, 3, 1, 2})), Contains("4 axes (2 x 3 x 1 x 2)"));
    CHECK_THAT(error_with(small_nifti().dims({2, 3, 2, 1, 3})), Contains("several values a voxel"));
    CHECK_THAT(error_with(small_nifti().dims({4, 3})), Contains("2 axes (4 x 3)"));
    CHECK_THAT(error_with(small_nifti().dims({2, 0, 2})), Contains("2 x 0 x 2"));
    CHECK_THAT(error_with(small_nifti().dims({2, 3, -2})), Contains("above 0"));
    CHECK_THAT(error_with(small_nifti().set<std::int16_t>(40, 0)), Contains("0 axes"));
    CHECK_THAT(error_with(small_nifti().set<std::int16_t>(40, 8)), Contains("8 axes"));
}

TEST_CASE("NIfTI: headers that lie") {
    CHECK_THAT(error_with(small_nifti().type(128, 24)), Contains("RGB24") && Contains("not supported"));
    CHECK_THAT(error_with(small_nifti().type(1024, 64)), Contains("INT64"));
    CHECK_THAT(error_with(small_nifti().type(0, 8)), Contains("not supported"));
    CHECK_THAT(error_with(small_nifti().type(12345, 8)), Contains("12345"));
    for (const float wrong : {0.0f, NAN, INFINITY, -1.0f}) {
        CHECK_THAT(error_with(small_nifti().spacing(1, wrong, 1)), Contains("spacing along y"));
        CHECK_THAT(error_with(small_nifti().qform(1, {0, 0, 0}, {0, 0, 0}).spacing(1, 1, wrong)),
                   Contains("spacing along z"));
    }
    CHECK_THAT(error_with(small_nifti().qform(1, {0, NAN, 0}, {0, 0, 0})), Contains("qform"));
    CHECK_THAT(error_with(small_nifti().sform({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, NAN, 0})), Contains("spacing"));
    CHECK_THAT(error_with(small_nifti().sform({1, 0, 0, INFINITY, 0, 1, 0, 0, 0, 0, 1, 0})),
               Contains("origin"));
    CHECK_THAT(error_with(small_nifti().sform({1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0})), Contains("one plane"));
    for (const float wrong : {-1.0f, NAN, INFINITY, 1e30f, 352.5f})
        CHECK_THAT(error_with(small_nifti().set<float>(108, wrong)), Contains("offset"));
    CHECK_THAT(error_with(small_nifti().set<float>(108, 40)), Contains("within the header"));
    CHECK_THAT(error_with(small_nifti().set<float>(108, 1e9f)), Contains("the file has 0"));
    CHECK_THAT(error_with(small_nifti(), kVoxels.substr(1)), Contains("take 12 bytes") && Contains("has 11"));
    CHECK_THAT(error_with(small_nifti().dims({32767, 32767, 32767})), Contains("more than"));
    CHECK_THAT(error_with(small_nifti().set<std::int32_t>(344, 0)), Contains("ANALYZE"));
    CHECK_THAT(error_with(small_nifti().set<std::int32_t>(0, 349)), Contains("348 or 540"));
    CHECK_THAT(error_with(small_nifti().set<std::int32_t>(344, 0x00322b6e)), Contains("magic"));  // n+2
    const TestFolder folder;
    CHECK_THAT(error_of(folder.write("a.nii", "")), Contains("348 or 540"));
    CHECK_THAT(error_of(folder.write("a.nii", "\x1f\x8b")), Contains("gzip"));
    const std::string packed = gzip(small_nifti().bytes() + kVoxels);
    CHECK_THAT(error_of(folder.write("a.nii.gz", packed.substr(0, packed.size() - 9))), Contains("cut off"));
    std::string damaged = packed;
    damaged[packed.size() - 6] ^= 1;  // gzip's checksum
    CHECK_THAT(error_of(folder.write("a.nii.gz", damaged)), Contains("damaged"));
}
