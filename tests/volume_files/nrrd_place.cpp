// NRRD: where the voxels lie, and which axes are those of space.
#include "tests/volume_files/volume_bytes.hpp"

using namespace dfield;
using namespace dfield::test;
using Catch::Contains;

namespace {

const std::string kVoxels(12, '\1');

VolumeGrid grid_of(const std::string& fields, const std::string& sizes = "2 3 2") {
    const TestFolder folder;
    return read_volume(folder.write("a.nrrd", nrrd("uchar", sizes, "encoding: raw\n" + fields, kVoxels)))
        .grid;
}

std::string error_with(const std::string& fields, const std::string& sizes = "2 3 2") {
    const TestFolder folder;
    return error_of(folder.write("a.nrrd", nrrd("uchar", sizes, "encoding: raw\n" + fields, kVoxels)));
}

}  // namespace

TEST_CASE("NRRD: spacings, 1 where there are none") {
    const VolumeGrid plain = grid_of("");
    check_vector(plain.spacing(), {1, 1, 1});
    CHECK(plain.origin == glm::dvec3(0));
    CHECK(plain.space.empty());
    CHECK(plain.unit.empty());
    CHECK(plain.axis_aligned());
    CHECK(plain.right_handed());
    const VolumeGrid anisotropic = grid_of("spacings: 3.2 3.2 1.5\nunits: \"mm\" \"mm\" \"mm\"\n");
    check_vector(anisotropic.spacing(), {3.2, 3.2, 1.5});
    check_vector(anisotropic.position({1, 2, 1}), {3.2, 6.4, 1.5});
    CHECK(anisotropic.unit == "mm");
    CHECK(grid_of("units: \"\" \"a\\\"b\" \"c\"\n").unit == "a\"b");
    CHECK_THAT(error_with("units: \"mm\" \"mm\" \"mm\n"), Contains("line 6") && Contains("do not end"));
    CHECK_THAT(error_with("units: mm mm mm\n"), Contains("quotes"));
    check_vector(grid_of("spacings: nan 2 nan\n").spacing(), {1, 2, 1});
    const VolumeGrid mirrored = grid_of("spacings: 1 -2 1\n");
    check_vector(mirrored.spacing(), {1, 2, 1});
    CHECK_FALSE(mirrored.right_handed());
    CHECK_FALSE(mirrored.axis_aligned());
}

TEST_CASE("NRRD: oblique, anisotropic and mirrored directions with an origin") {
    const VolumeGrid grid = grid_of(
        "space: left-posterior-superior\nspace directions: (0.6,0.8,0) (-1.6,1.2,0) (0,0,-0.5)\n"
        "space origin: (10,-20.5,1e-3)\nspace units: \"mm\" \"mm\" \"mm\"\nkinds: domain domain domain\n");
    CHECK(grid.space == "left-posterior-superior");
    CHECK(grid.unit == "mm");
    check_vector(grid.spacing(), {1, 2, 0.5});
    check_vector(grid.origin, {10, -20.5, 1e-3});
    check_vector(grid.directions[0], {0.6, 0.8, 0});
    check_vector(grid.directions[1], {-1.6, 1.2, 0});
    check_vector(grid.position({1, 2, 1}), {10 + 0.6 - 3.2, -20.5 + 0.8 + 2.4, 1e-3 - 0.5});
    CHECK_FALSE(grid.right_handed());
    CHECK(grid_of("space: RAS\n").space == "right-anterior-superior");
    CHECK(grid_of("space dimension: 3\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n").space == kUnnamedSpace);
    check_vector(grid_of("space: LPS\nspacings: 1 2 3\nspace origin: (1,2,3)\n").spacing(), {1, 2, 3});
}

TEST_CASE("NRRD: axis mins and maxs tell of cells or of samples") {
    const VolumeGrid node = grid_of("axis mins: 1 2 3\naxis maxs: 2 6 3.5\ncenters: node node node\n");
    check_vector(node.origin, {1, 2, 3});
    check_vector(node.spacing(), {1, 2, 0.5});
    const VolumeGrid cell = grid_of("axis mins: 1 2 3\naxis maxs: 2 5 4\ncenterings: cell cell cell\n");
    check_vector(cell.origin, {1.25, 2.5, 3.25});
    check_vector(cell.spacing(), {0.5, 1, 0.5});
    check_vector(grid_of("axis mins: 1 2 3\nspacings: 2 2 2\n").origin, {2, 3, 4});
    check_vector(grid_of("axis mins: 0 0 0\naxis maxs: 0 1 1\ncenters: node node node\n", "1 6 2").spacing(),
                 {1, 0.2, 1});
}

TEST_CASE("NRRD: axes of size 1 that are not of space are left out") {
    const std::array<std::size_t, 3> size{2, 3, 2};
    CHECK(grid_of("spacings: 1 2 3 nan\n", "2 3 2 1").size == size);
    CHECK(grid_of("", "1 2 3 2").size == size);
    CHECK(grid_of("", "1 2 3 2 1").size == size);
    CHECK(grid_of("kinds: vector domain domain domain\nspacings: nan 1 2 3\n", "1 2 3 2").size == size);
    const VolumeGrid time =
        grid_of("space: LPS\nspace directions: none (2,0,0) (0,3,0) (0,0,4)\nkinds: time space space space\n",
                "1 2 3 2");
    CHECK(time.size == size);
    check_vector(time.spacing(), {2, 3, 4});
    CHECK(grid_of("kinds: domain domain domain\n", "1 1 12").size == std::array<std::size_t, 3>{1, 1, 12});
}

TEST_CASE("NRRD: other than three dimensions and several values a voxel are errors") {
    CHECK_THAT(error_with("", "3 4"), Contains("2 axes (3 x 4)") && Contains("three"));
    CHECK_THAT(error_with("", "12"), Contains("1 axes (12)"));
    CHECK_THAT(error_with("", "2 3 1 2"), Contains("2 x 3 x 1 x 2") && Contains("points in time"));
    CHECK_THAT(error_with("kinds: vector domain domain domain\n", "3 2 2 1"),
               Contains("several values a voxel"));
    CHECK_THAT(error_with("kinds: RGB-color domain domain\n", "3 2 2"),
               Contains("axis 0") && Contains("values"));
    CHECK_THAT(error_with("space: LPS\nspace directions: none (1,0,0) (0,1,0)\n", "3 2 2"),
               Contains("axis 0"));
}

TEST_CASE("NRRD: places that are none are errors") {
    CHECK_THAT(error_with("spacings: 1 0 1\n"), Contains("spacing"));
    CHECK_THAT(error_with("spacings: 1 inf 1\n"), Contains("a.nrrd"));
    CHECK_THAT(error_with("spacings: 1 1e300 1\n"), Contains("spacing along y"));
    CHECK_THAT(error_with("spacings: 1 1\n"), Contains("2 values"));
    CHECK_THAT(error_with("spacings: 1 1 1 1\n"), Contains("spacings"));
    CHECK_THAT(error_with("spacings: 1 1x 1\n"), Contains("line 6") && Contains("'1x'"));
    CHECK_THAT(error_with("axis mins: 1 1 1\naxis maxs: 1 2 2\n"), Contains("spacing along x is 0"));
    const auto directions = [](const std::string& vectors) {
        return error_with("space: LPS\nspace directions: " + vectors + "\n");
    };
    CHECK_THAT(directions("(0,0,0) (0,1,0) (0,0,1)"), Contains("spacing along x is 0"));
    CHECK_THAT(directions("(1,0,0) (2,0,0) (0,0,1)"), Contains("one plane"));
    CHECK_THAT(directions("(1,0,0) (0,1,0)"), Contains("a.nrrd"));
    CHECK_THAT(directions("(1,0,0) (0,1,0) (0,0,nan)"), Contains("a.nrrd"));
    CHECK_THAT(directions("(1,0,0) (0,1,0) (0,0,1pi)"), Contains("'1pi'"));
    CHECK_THAT(directions("(1,0,0) (0,1,0) (0,0,1"), Contains("a.nrrd"));
    CHECK_THAT(directions("none none none"), Contains("no error"));  // spacing 1, as without the field
    CHECK_THAT(error_with("space: right-up\nspace directions: (1,0) (0,1) none\n"), Contains("2 dimensions"));
    CHECK_THAT(error_with("space: LPS\nspace origin: (1,inf,3)\n"), Contains("a.nrrd"));
    CHECK_THAT(error_with("space: LPS\nspace origin: (1,1e200,3)\n"), Contains("origin"));
    CHECK_THAT(error_with("space: Utopia\n"), Contains("Utopia"));
}
