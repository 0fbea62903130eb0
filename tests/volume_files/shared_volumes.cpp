// Real volumes: figures that are known for them.
#include <catch2/catch.hpp>

#include "baker/file_io.hpp"
#include "baker/volume/read_volume.hpp"
#include "tests/test_data.hpp"

using namespace dfield;
using dfield::test::shared_file;

namespace {

void check_volume(const std::string& name, std::array<std::size_t, 3> size, VoxelType type,
                  glm::dvec3 spacing) {
    const auto path = shared_file("volumes/" + name);
    if (!path) return;
    INFO(name);
    std::vector<std::string> warnings;
    const Volume volume = read_volume(*path, {}, &warnings);
    CHECK(volume.grid.size == size);
    CHECK(volume.type == type);
    CHECK(volume.grid.spacing() == spacing);
    CHECK(warnings.empty());
    const ValueRange range = value_range(volume);
    CHECK(range.min < range.max);
}

}  // namespace

TEST_CASE("volumes come in with their sizes, types and spacings") {
    check_volume("bonsai_256x256x256_uint8.nrrd", {256, 256, 256}, VoxelType::kU8, {1, 1, 1});
    check_volume("engine_256x256x128_uint8.nrrd", {256, 256, 128}, VoxelType::kU8, {1, 1, 1});
    check_volume("engine.nii.gz", {256, 256, 128}, VoxelType::kU8, {1, 1, 1});
    check_volume("headsq_64x64x93_int16.nrrd", {64, 64, 93}, VoxelType::kI16, {3.2, 3.2, 1.5});
    check_volume("nucleon.nrrd", {41, 41, 41}, VoxelType::kU8, {1, 1, 1});
}

TEST_CASE("the same voxels come out of NRRD and NIfTI, out of a detached header and a raw file") {
    const auto nrrd = shared_file("volumes/engine_256x256x128_uint8.nrrd");
    const auto nifti = shared_file("volumes/engine.nii.gz");
    if (nrrd && nifti) CHECK(read_volume(*nrrd).data == read_volume(*nifti).data);
    const auto header = shared_file("volumes/nucleon.nrrd");
    const auto raw = shared_file("volumes/nucleon.raw");
    if (!header || !raw) return;
    const std::vector<std::byte> bytes = read_file(*raw);
    CHECK(read_volume(*header).data == bytes);
    CHECK(read_volume(*raw, {.raw = RawLayout{.size = {41, 41, 41}, .type = VoxelType::kU8}}).data == bytes);
}
