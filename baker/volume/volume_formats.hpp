// The readers behind read_volume(), and what they share. All of them throw InputError.
#pragma once

#include "baker/volume/data_stream.hpp"
#include "baker/volume/read_volume.hpp"

namespace dfield {

using Warnings = std::vector<std::string>;

Volume read_nrrd(const std::filesystem::path& path, const VolumeReadOptions& options, Warnings& warnings);
Volume read_nifti(const std::filesystem::path& path, const VolumeReadOptions& options, Warnings& warnings);
Volume read_raw(const std::filesystem::path& path, const VolumeReadOptions& options);

// Sizes above 0 whose voxels fit `max_bytes`; returns the bytes that they take.
std::uint64_t checked_bytes(const std::filesystem::path& path, const std::array<std::size_t, 3>& size,
                            VoxelType type, std::uint64_t max_bytes);

// A grid that lengths, gradients and inverses can be taken of: finite, spacings above 0 that a float can
// hold, directions that span space.
void check_geometry(const std::filesystem::path& path, const VolumeGrid& grid);

// Every voxel is finite.
void check_finite(const std::filesystem::path& path, const Volume& volume);

const char* axis_name(int axis);  // "x", "y", "z"

// Each group of `size` bytes back to front.
void swap_bytes(std::span<std::byte> bytes, std::size_t size);

}  // namespace dfield
