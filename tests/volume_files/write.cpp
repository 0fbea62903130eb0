// NRRD files that are written: to the byte, and read back.
#include "baker/volume/write_nrrd.hpp"

#include "baker/file_io.hpp"
#include "tests/volume_files/volume_bytes.hpp"

using namespace dfield;
using namespace dfield::test;
using Catch::Contains;

namespace {

std::string text_of(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

template<class T>
Volume volume_of(VoxelType type, const std::vector<T>& values) {
    Volume volume;
    volume.type = type;
    volume.grid.size = {2, 3, 2};
    const auto bytes = std::as_bytes(std::span(values));
    volume.data.assign(bytes.begin(), bytes.end());
    return volume;
}

VolumeGrid oblique_grid() {
    VolumeGrid grid;
    grid.size = {2, 3, 2};
    grid.origin = {0.1, -1.0 / 3, 1e-7};
    grid.directions =
        glm::dmat3(glm::dvec3(0.6, 0.8, 0), glm::dvec3(-1.6, 1.2, 1.0 / 7), glm::dvec3(0, 0, -0.3));
    grid.space = "left-posterior-superior";
    grid.unit = "mm";
    return grid;
}

void check_same(const VolumeGrid& a, const VolumeGrid& b) {
    CHECK(a.size == b.size);
    CHECK(a.origin == b.origin);  // to the last bit
    CHECK(a.directions == b.directions);
    CHECK(a.space == b.space);
    CHECK(a.unit == b.unit);
}

// The lines of the header, without comments.
std::vector<std::string> header_lines(const std::string& file) {
    std::istringstream text(file.substr(0, file.find("\n\n")));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);)
        if (line[0] != '#') lines.push_back(line);
    return lines;
}

template<class T>
void check_round_trip(VoxelType type) {
    const TestFolder folder;
    const Volume volume = volume_of(type, sample_voxels<T>());
    for (const bool gzip : {false, true}) {
        write_nrrd(folder.path() / "a.nrrd", volume, {.gzip = gzip});
        std::vector<std::string> warnings;
        const Volume back = read_volume(folder.path() / "a.nrrd", {}, &warnings);
        CHECK(back.type == type);
        CHECK(back.data == volume.data);
        CHECK(warnings.empty());
        check_same(back.grid, volume.grid);
    }
    CHECK(folder.files() == 1);
}

}  // namespace

TEST_CASE("a written NRRD is what the format says, raw by default") {
    const TestFolder folder;
    Volume volume = volume_of<std::uint16_t>(VoxelType::kU16, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
    volume.grid.directions[2][2] = 2.5;
    write_nrrd(folder.path() / "a.nrrd", volume, {.content = "visibility"});
    const std::string file = text_of(folder.path() / "a.nrrd");
    CHECK(header_lines(file) ==
          std::vector<std::string>{"NRRD0003", "content: visibility", "type: unsigned short", "dimension: 3",
                                   "sizes: 2 3 2", "spacings: 1 1 2.5", "kinds: domain domain domain",
                                   "endian: little", "encoding: raw"});
    CHECK(file.substr(file.find("\n\n") + 2) ==
          std::string(reinterpret_cast<const char*>(volume.data.data()), 24));
}

TEST_CASE("every type comes back, raw and compressed") {
    check_round_trip<std::int8_t>(VoxelType::kI8);
    check_round_trip<std::uint8_t>(VoxelType::kU8);
    check_round_trip<std::int16_t>(VoxelType::kI16);
    check_round_trip<std::uint16_t>(VoxelType::kU16);
    check_round_trip<std::int32_t>(VoxelType::kI32);
    check_round_trip<std::uint32_t>(VoxelType::kU32);
    check_round_trip<float>(VoxelType::kF32);
    check_round_trip<double>(VoxelType::kF64);
}

TEST_CASE("the place of a volume is carried to the last bit") {
    const TestFolder folder;
    Volume volume = volume_of(VoxelType::kU8, sample_voxels<std::uint8_t>());
    const auto check = [&](const VolumeGrid& grid) {
        volume.grid = grid;
        write_nrrd(folder.path() / "a.nrrd", volume);
        check_same(read_volume(folder.path() / "a.nrrd").grid, grid);
        return header_lines(text_of(folder.path() / "a.nrrd"));
    };
    VolumeGrid grid = oblique_grid();
    const auto lines = check(grid);
    CHECK(std::count(lines.begin(), lines.end(), "space: left-posterior-superior") == 1);
    grid.space = "right-anterior-superior";
    check(grid);
    grid.space = kUnnamedSpace;
    const auto unnamed = check(grid);
    CHECK(std::count(unnamed.begin(), unnamed.end(), "space dimension: 3") == 1);
    VolumeGrid plain;
    plain.size = {2, 3, 2};
    plain.directions = glm::dmat3(3.2, 0, 0, 0, 1.0 / 3, 0, 0, 0, 1.5);
    plain.unit = "um";
    const auto spaced = check(plain);
    CHECK(std::none_of(spaced.begin(), spaced.end(), [](auto& l) { return l.starts_with("axis mins"); }));
    CHECK(std::count(spaced.begin(), spaced.end(), "units: \"um\" \"um\" \"um\"") == 1);
    plain.origin = {1, -2, 0.1};
    check(plain);
}

TEST_CASE("several values a voxel are a slowest axis of kind list") {
    const TestFolder folder;
    const std::vector<std::uint8_t> octants[] = {{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12},
                                                 {21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32}};
    const std::span<const std::byte> components[] = {std::as_bytes(std::span(octants[0])),
                                                     std::as_bytes(std::span(octants[1]))};
    for (const bool gzip : {false, true}) {
        write_nrrd(folder.path() / "a.nrrd", oblique_grid(), VoxelType::kU8, components,
                   {.gzip = gzip, .labels = {"x", "y", "z", "octant"}});
        std::string file = text_of(folder.path() / "a.nrrd");
        const auto lines = header_lines(file);
        const auto has = [&](const std::string& line) {
            INFO(line);
            CHECK(std::count(lines.begin(), lines.end(), line) == 1);
        };
        has("dimension: 4");
        has("sizes: 2 3 2 2");
        has("kinds: domain domain domain list");
        has("labels: \"x\" \"y\" \"z\" \"octant\"");
        has("encoding: " + std::string(gzip ? "gzip" : "raw"));
        CHECK(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
            return line.starts_with("space directions: (0.59999999999999998,") && line.ends_with(" none");
        }));
        if (!gzip) CHECK(file.ends_with("\1\2\3\4\5\6\7\10\11\12\13\14\25\26\27\30\31\32\33\34\35\36\37 "));
        CHECK_THAT(error_of(folder.path() / "a.nrrd"), Contains("2 x 3 x 2 x 2"));
        VolumeGrid plain;
        plain.size = {2, 3, 2};
        plain.unit = "mm";
        write_nrrd(folder.path() / "a.nrrd", plain, VoxelType::kU8, components, {.gzip = gzip});
        file = text_of(folder.path() / "a.nrrd");
        CHECK_THAT(file, Contains("units: \"mm\" \"mm\" \"mm\" \"\"\n"));
        CHECK_THAT(file, Contains("spacings: 1 1 1 nan\n"));
    }
}

TEST_CASE("a volume that cannot be written leaves nothing behind") {
    const TestFolder folder;
    const Volume volume = volume_of(VoxelType::kU8, sample_voxels<std::uint8_t>());
    CHECK_THROWS_AS(write_nrrd(folder.path() / "none" / "a.nrrd", volume), OutputError);
    CHECK(folder.files() == 0);
    Volume wrong = volume;
    wrong.grid.size[0] = 3;
    CHECK_THROWS_AS(write_nrrd(folder.path() / "a.nrrd", wrong), std::invalid_argument);
    CHECK_THROWS_AS(write_nrrd(folder.path() / "a.nrrd", volume, {.labels = {"x"}}), std::invalid_argument);
    CHECK(folder.files() == 0);
#ifdef __linux__
    if (std::filesystem::exists("/dev/full"))
        for (const bool gzip : {false, true})
            CHECK_THROWS_AS(write_nrrd("/dev/full", volume, {.gzip = gzip}), OutputError);
#endif
}
