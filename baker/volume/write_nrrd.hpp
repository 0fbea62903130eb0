// Volumes as NRRD files, which ParaView, 3D Slicer and ITK read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "baker/volume/volume.hpp"

namespace dfield {

struct NrrdOptions {
    bool gzip = false;                  // ParaView reads raw voxels only
    std::string content{};              // what the volume is, a line; empty: not said
    std::vector<std::string> labels{};  // of the axes x, y, z and the components; empty or one for each axis
};

// One value a voxel, or several: each of the `components` holds grid.voxels() voxels of `type` in this
// machine's byte order. Several are written one after the other, as a fourth and slowest axis of kind "list".
// The grid's place goes along: `space directions` and `space origin` where it lies in a named or unnamed
// space, otherwise `spacings` and, for an origin that is not 0, `axis mins` of centers "node". The file is
// complete or absent. OutputError; std::invalid_argument for sizes that do not match.
void write_nrrd(const std::filesystem::path& path, const VolumeGrid& grid, VoxelType type,
                std::span<const std::span<const std::byte>> components, const NrrdOptions& options = {});
void write_nrrd(const std::filesystem::path& path, const Volume& volume, const NrrdOptions& options = {});

}  // namespace dfield
