// Broken files: always an InputError that names the file, never more memory than the file is worth.
#include <cmath>

#include "tests/volume_files/allocations.hpp"
#include "tests/volume_files/volume_bytes.hpp"

using namespace dfield;
using namespace dfield::test;
using Catch::Contains;

namespace {

std::string error_in(const std::string& name, const std::string& bytes) {
    const TestFolder folder;
    return error_of(folder.write(name, bytes));
}

// Either usable or an InputError that names the file.
bool readable(const TestFolder& folder, const std::string& name, const std::string& bytes) {
    const auto path = folder.write(name, bytes);
    try {
        const Volume volume = read_volume(path);
        REQUIRE(volume.data.size() == volume.grid.voxels() * size_of(volume.type));
        REQUIRE(volume.grid.voxels() > 0);
        const glm::dvec3 spacing = volume.grid.spacing();
        REQUIRE((spacing.x > 0 && spacing.y > 0 && spacing.z > 0));
        return true;
    } catch (const InputError& error) {
        REQUIRE_THAT(error.what(), Contains(name));
        REQUIRE(std::string(error.what()).find("does not say why") == std::string::npos);
        return false;
    }
}

const std::string kNrrdFields =
    "space: LPS\nspace directions: (1,0,0) (0,2,0) (0,0,3)\nspace origin: (1,2,3)\nkinds: domain domain "
    "domain\n"
    "space units: \"mm\" \"mm\" \"mm\"\nendian: little\nencoding: raw\n";

struct Valid {
    std::string name, bytes;
    bool whole;  // every cut is an error
};

std::vector<Valid> valid_files() {
    const std::string nifti = small_nifti().qform(1, {0, 0, 0.5f}, {1, 2, 3}).scale(2, 1).bytes() + kVoxels;
    return {
        {"a.nrrd", nrrd("uchar", "2 3 2", kNrrdFields, kVoxels), true},
        {"a.nrrd", nrrd("short", "2 3 1", "spacings: 1 2 3\nendian: big\nencoding: raw\n", kVoxels), true},
        {"a.nrrd", nrrd("uchar", "2 3 2", "axis mins: 0 0 0\nencoding: gzip\n", gzip(kVoxels)), true},
        {"a.nrrd",
         nrrd("float", "2 3 2", "units: \"\" \"a\\\"b\" \"c\"\nencoding: ascii\n",
              "1 2 3 4 5 6 7 8 9 10 11 1e-2"),
         false},
        {"a.nii", nifti, true},
        {"a.nii.gz", gzip(nifti), true}};
}

}  // namespace

TEST_CASE("files that are no volumes") {
    for (const std::string name : {"a.nrrd", "a.nhdr", "a.nii", "a.nii.gz", "a.hdr"}) {
        INFO(name);
        CHECK_THAT(error_in(name, ""), Contains(name));
        CHECK_THAT(error_in(name, std::string(5000, '\0')), Contains(name));
        CHECK_THAT(error_in(name, std::string(5000, '\xff')), Contains(name));
        CHECK_THAT(error_in(name, "a shopping list\n"), Contains(name));
    }
    CHECK_THAT(error_in("a.nrrd", "NRRD0009" + nrrd("uchar", "2 3 2", "encoding: raw\n", kVoxels).substr(8)),
               Contains("NRRD0009"));
    CHECK_THAT(error_in("a.nrrd", "P5\n2 2\n255\nabcd"), Contains("no NRRD"));  // teem reads PNM, too
    CHECK_THAT(error_in("a.nrrd", "NRRD0004\n" + std::string(2'000'000, 'x')), Contains("line 2"));
    CHECK_THAT(error_in("a.nrrd", "NRRD0004\n" + std::string(2'000'000, '#')), Contains("a.nrrd"));
}

TEST_CASE("NRRD: errors say where and what") {
    const auto with = [](const std::string& fields, const std::string& voxels = kVoxels) {
        return error_in("a.nrrd", nrrd("uchar", "2 3 2", fields, voxels));
    };
    CHECK_THAT(with(""), Contains("no 'encoding:'"));
    CHECK_THAT(error_in("a.nrrd", "NRRD0001\nencoding: raw\ndimension: 3\nsizes: 1 1 1\n\nx"),
               Contains("no 'type:'"));
    CHECK_THAT(error_in("a.nrrd", "NRRD0001\nencoding: raw\ntype: uchar\nsizes: 1 1 1\n\nx"),
               Contains("dimension"));
    CHECK_THAT(error_in("a.nrrd", "NRRD0001\nencoding: raw\ntype: uchar\ndimension: 3\n\nx"),
               Contains("no 'sizes:'"));
    CHECK_THAT(error_in("a.nrrd", "NRRD0001\nkinds: domain domain domain\ndimension: 3\n\nx"),
               Contains("line 2: 'kinds' before 'dimension'"));
    CHECK_THAT(with("encoding: bzip2\n"), Contains("bzip2") && Contains("gzip"));
    CHECK_THAT(with("encoding: hex\n"), Contains("hex"));
    CHECK_THAT(with("encoding: zip\n"), Contains("zip"));
    CHECK_THAT(with("encoding: raw\nencoding: raw\n"), Contains("already"));
    CHECK_THAT(with("encoding raw\n"), Contains("line 5: 'encoding raw'"));
    CHECK_THAT(with("flavour: sweet\n"), Contains("line 5: 'flavour: sweet'"));
    CHECK_THAT(with("encoding: raw\nspacings: 1 1 " + std::string(3000, '1') + "\n"), Contains("too long"));
    CHECK_THAT(with("encoding: raw\nkinds: a\001 b c\n"), Contains("line 6") && Contains("printable"));
    CHECK_THAT(with("encoding: raw\nbyte skip: -2\n"), Contains("byte skip"));
    CHECK_THAT(with("encoding: gzip\nbyte skip: -1\n"), Contains("byte skip -1"));
    CHECK_THAT(with("encoding: raw\nbyte skip: 9223372036854775807\n"), Contains("the file has 0"));
    CHECK_THAT(with("encoding: raw\nline skip: 4294967297\n"), Contains("line 6") && Contains("4294967297"));
    CHECK_THAT(with("encoding: gzip\nbyte skip: 9\n", gzip("12345")), Contains("the file has 0"));
    CHECK_THAT(error_in("a.nrrd", nrrd("short", "2 3 1", "encoding: raw\n", kVoxels)), Contains("endian"));
    CHECK_THAT(error_in("a.nrrd", nrrd("short", "2 3 1", "encoding: raw\nendian: middle\n", kVoxels)),
               Contains("middle"));
    CHECK_THAT(error_in("a.nrrd", nrrd("longlong", "1 1 1", "encoding: raw\nendian: big\n", kVoxels)),
               Contains("long long int") && Contains("unu convert"));
    CHECK_THAT(error_in("a.nrrd", nrrd("block", "1 1 1", "encoding: raw\nblock size: 4\n", kVoxels)),
               Contains("block"));
    CHECK_THAT(error_in("a.nrrd", nrrd("half", "1 1 1", "encoding: raw\n", kVoxels)), Contains("half"));
}

TEST_CASE("NRRD: sizes are held against the voxels before anything is allocated") {
    const auto sized = [](const std::string& type, const std::string& sizes, const std::string& encoding,
                          const std::string& voxels) {
        return error_in("a.nrrd", nrrd(type, sizes, "endian: little\nencoding: " + encoding + "\n", voxels));
    };
    // The message itself and what the file holds are all that may be allocated.
    largest_allocation = 0;
    CHECK_THAT(sized("uchar", "2000 2000 2000", "raw", kVoxels), Contains("the file has 12"));
    CHECK_THAT(sized("float", "2147483647 2147483647 2147483647", "raw", kVoxels), Contains("too large"));
    CHECK_THAT(sized("uchar", "4294967296 1 1", "raw", kVoxels), Contains("'4294967296'"));
    CHECK_THAT(sized("uchar", "18446744073709551617 1 1", "raw", kVoxels), Contains("18446744073709551617"));
    CHECK_THAT(sized("uchar", "2000 2000 2000", "gzip", gzip(kVoxels)), Contains("8000000000 bytes"));
    CHECK_THAT(sized("uchar", "2000 2000 2000", "ascii", "1 2 3"), Contains("8000000000 bytes"));
    CHECK_THAT(error_in("a.nii", small_nifti().dims({2000, 2000, 2000}).bytes() + kVoxels),
               Contains("has 12"));
    CHECK_THAT(error_in("a.nii", gzip(small_nifti().dims({2000, 2000, 2000}).bytes() + kVoxels)),
               Contains("8000000000 bytes"));
    CHECK(largest_allocation < 1'000'000);
    CHECK_THAT(sized("uchar", "2 0 2", "raw", kVoxels), Contains("a.nrrd"));
    CHECK_THAT(sized("uchar", "2 -3 2", "raw", kVoxels), Contains("'-3'"));
    CHECK_THAT(sized("uchar", "2 x 2", "raw", kVoxels), Contains("'x'"));
    CHECK_THAT(sized("uchar", "2 3junk 2", "raw", kVoxels), Contains("'3junk'"));
    CHECK_THAT(sized("uchar", "2 3 2", "raw", kVoxels.substr(1)), Contains("take 12 bytes, the file has 11"));
    CHECK_THAT(sized("uchar", "2 3 2", "gzip", gzip(kVoxels.substr(1))), Contains("the file has 11"));
    CHECK_THAT(sized("uchar", "2 3 2", "gzip", kVoxels), Contains("gzip data are damaged"));
    CHECK_THAT(sized("uchar", "2 3 2", "gzip", ""), Contains("a.nrrd"));
    CHECK_THAT(sized("uchar", "2 2 1", "ascii", "1 2 3   "), Contains("promises 4 voxels, the file has 3"));
    CHECK_THAT(sized("uchar", "2 1 1", "ascii", "1 2 3"), Contains("more than the 2"));
    CHECK_THAT(sized("uchar", "2 1 1", "ascii", "1 256"), Contains("voxel 1 is '256'"));
    CHECK_THAT(sized("uchar", "2 1 1", "ascii", "1 -1"), Contains("'-1'"));
    CHECK_THAT(sized("short", "2 1 1", "ascii", "1 2.5"), Contains("'2.5'"));
    CHECK_THAT(sized("uchar", "2 1 1", "ascii", std::string(1'000'000, '7')), Contains("no number"));
}

TEST_CASE("voxels that are NaN or infinite are errors that say which") {
    for (const bool big : {false, true}) {
        const std::string fields = "encoding: raw\nendian: " + std::string(big ? "big" : "little") + "\n";
        CHECK_THAT(error_in("a.nrrd", nrrd("float", "2 2 2", fields,
                                           bytes_of<float>({1, 2, 3, 4, 5, NAN, 7, NAN}, big))),
                   Contains("voxel (1, 0, 1) is NaN (2 of them"));
        CHECK_THAT(error_in("a.nrrd", nrrd("double", "1 2 1", fields, bytes_of<double>({1, -INFINITY}, big))),
                   Contains("voxel (0, 1, 0) is infinite (1 of them"));
    }
    CHECK_THAT(
        error_in("a.nii", NiftiHeader().dims({1, 1, 2}).type(16, 32).bytes() + bytes_of<float>({NAN, 1})),
        Contains("voxel (0, 0, 0) is NaN"));
}

TEST_CASE("every prefix of a file is read or refused, and a cut binary file is refused") {
    const TestFolder folder;
    for (const Valid& file : valid_files()) {
        INFO(file.name);
        REQUIRE(readable(folder, file.name, file.bytes));
        for (std::size_t size = 0; size < file.bytes.size(); ++size) {
            INFO(size << " of " << file.bytes.size());
            const bool good = readable(folder, file.name, file.bytes.substr(0, size));
            if (file.whole) REQUIRE_FALSE(good);
        }
    }
}

TEST_CASE("every flipped byte of a file is read or refused, within the memory that the file is worth") {
    const TestFolder folder;
    for (const Valid& file : valid_files()) {
        largest_allocation = 0;
        for (std::size_t at = 0; at < file.bytes.size(); ++at)
            for (const int flip : {0x01, 0x02, 0x10, 0x80, 0xff}) {
                std::string flipped = file.bytes;
                flipped[at] = static_cast<char>(flipped[at] ^ flip);
                readable(folder, file.name, flipped);
            }
        CHECK(largest_allocation < 1'000'000);
    }
}
