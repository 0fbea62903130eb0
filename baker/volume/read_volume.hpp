// Volumes from files: NRRD (.nrrd, .nhdr), NIfTI (.nii, .nii.gz, .hdr/.img) and headerless raw voxels.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "baker/volume/volume.hpp"

namespace dfield {

// What a raw file does not say itself.
struct RawLayout {
    std::array<std::size_t, 3> size{};
    VoxelType type = VoxelType::kU8;
    glm::dvec3 spacing{1};
    std::endian endian = std::endian::little;
    std::uint64_t header_bytes = 0;  // skipped at the start of the file
};

struct VolumeReadOptions {
    std::optional<RawLayout> raw;  // read the file as raw voxels, whatever its name
    // A file that claims more bytes of voxels than this is refused before anything is allocated. Apart from
    // this, never more is allocated than the file can hold: its own size, or 1032 times that where it is
    // compressed (deflate's limit).
    std::uint64_t max_bytes = std::uint64_t{1} << 36;
};

// The file is taken for what its name says, or for raw voxels where options.raw is set. Files may come from
// anywhere: whatever is wrong with one is an InputError that says what, where and what to do about it: sizes
// that do not match the data, a size of 0, other than three dimensions, several values a voxel, types without
// a VoxelType, spacings of 0, NaN or infinite voxels, missing data files. What is odd but readable goes into
// `warnings` (may be null), a line each.
Volume read_volume(const std::filesystem::path& path, const VolumeReadOptions& options = {},
                   std::vector<std::string>* warnings = nullptr);

// "NRRD", "NIfTI" or "raw": what read_volume() takes the file for; InputError for names that it knows
// nothing of.
const char* volume_format(const std::filesystem::path& path, const VolumeReadOptions& options = {});

}  // namespace dfield
