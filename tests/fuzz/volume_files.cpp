// libFuzzer: volume files. The first byte says what the rest is: NRRD, NIfTI, either of them compressed as a
// whole or with its voxels compressed, so that mutations reach the header behind the compression. A file is
// refused, or is a volume that holds what it says.
#include <cmath>
#include <filesystem>
#include <string>

#include "baker/error.hpp"
#include "baker/volume/read_volume.hpp"
#include "baker/volume/write_nrrd.hpp"
#include "tests/fuzz/folder.hpp"
#include "tests/volume_files/gzip.hpp"

namespace {

using namespace dfield;

using fuzz::folder;
using fuzz::require;
using fuzz::write;

void check(const Volume& volume) {
    const VolumeGrid& grid = volume.grid;
    require(grid.voxels() > 0 && volume.data.size() == grid.voxels() * size_of(volume.type));
    const glm::dvec3 spacing = grid.spacing();
    for (int axis = 0; axis < 3; ++axis)
        require(spacing[axis] > 0 && std::isfinite(spacing[axis]) && std::isfinite(grid.origin[axis]));
    const ValueRange range = value_range(volume);
    require(range.min <= range.max && std::isfinite(range.min) && std::isfinite(range.max));

    const std::filesystem::path path = folder() / "again.nrrd";
    write_nrrd(path, volume);
    const Volume again = read_volume(path);
    require(again.type == volume.type && again.data == volume.data && again.grid.size == grid.size &&
            again.grid.directions == grid.directions && again.grid.origin == grid.origin &&
            again.grid.space == grid.space);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string rest(reinterpret_cast<const char*>(data + 1), size - 1);
    std::string name = "a.nrrd", bytes = rest;
    switch (data[0] % 5) {
        case 0:
            break;
        case 1:
            name = "a.nii";
            break;
        case 2:
            name = "a.nii.gz";
            bytes = test::gzip(rest);
            break;
        case 3:  // an NRRD whose voxels are compressed
            if (const std::size_t blank = rest.find("\n\n"); blank != std::string::npos)
                bytes = rest.substr(0, blank + 2) + test::gzip(rest.substr(blank + 2));
            break;
        case 4:  // a detached header before its voxels
            name = "a.nhdr";
            if (const std::size_t blank = rest.find("\n\n"); blank != std::string::npos) {
                write("voxels.raw", rest.substr(blank + 2));
                bytes.resize(blank + 1);
            }
            break;
    }
    const std::filesystem::path path = write(name, bytes);
    try {
        check(read_volume(path, {.max_bytes = 1 << 20}));
    } catch (const InputError& error) {
        require(std::string(error.what()).find(folder().string()) != std::string::npos);
    }
    return 0;
}
