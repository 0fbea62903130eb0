#include "baker/volume/read_volume.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "baker/error.hpp"
#include "baker/import/text_scan.hpp"
#include "baker/volume/volume_formats.hpp"

namespace dfield {
namespace {

enum class Format { kNrrd, kNifti, kRaw };

Format format_of(const std::filesystem::path& path, const VolumeReadOptions& options) {
    if (options.raw) return Format::kRaw;
    std::string extension = path.extension().string();
    if (equal_ignoring_case(extension, ".gz")) extension = path.stem().extension().string();
    const auto is = [&](std::string_view name) { return equal_ignoring_case(extension, name); };
    if (is(".nrrd") || is(".nhdr")) return Format::kNrrd;
    if (is(".nii") || is(".hdr") || is(".img")) return Format::kNifti;
    if (is(".mha") || is(".mhd") || is(".vti"))
        throw InputError(
            path.string() + ": dfield does not read '" + extension +
            "'; save it as NRRD (ParaView, 3D Slicer), or give its raw voxels with --dims and --type");
    throw InputError(
        path.string() + ": unknown kind of volume '" + extension +
        "'; dfield reads .nrrd, .nhdr, .nii, .nii.gz and .hdr, and raw voxels with --dims and --type");
}

}  // namespace

const char* volume_format(const std::filesystem::path& path, const VolumeReadOptions& options) {
    switch (format_of(path, options)) {
        case Format::kNrrd:
            return "NRRD";
        case Format::kNifti:
            return "NIfTI";
        case Format::kRaw:
            break;
    }
    return "raw";
}

Volume read_volume(const std::filesystem::path& path, const VolumeReadOptions& options, Warnings* warnings) {
    Warnings ignored;
    Warnings& said = warnings != nullptr ? *warnings : ignored;
    switch (format_of(path, options)) {
        case Format::kNrrd:
            return read_nrrd(path, options, said);
        case Format::kNifti:
            return read_nifti(path, options, said);
        case Format::kRaw:
            break;
    }
    return read_raw(path, options);
}

std::uint64_t checked_bytes(const std::filesystem::path& path, const std::array<std::size_t, 3>& size,
                            VoxelType type, std::uint64_t max_bytes) {
    std::uint64_t bytes = size_of(type);
    for (const std::size_t axis : size) {
        if (axis == 0)
            throw InputError(path.string() + ": its size is " + size_text(size) +
                             " voxels; every size must be above 0");
        if (axis > max_bytes / bytes)
            throw InputError(path.string() + ": " + size_text(size) + " voxels of type " + name_of(type) +
                             " are more than the " + std::to_string(max_bytes >> 20) +
                             " MiB that dfield reads; crop or resample the volume");
        bytes *= axis;
    }
    return bytes;
}

void check_geometry(const std::filesystem::path& path, const VolumeGrid& grid) {
    const glm::dvec3 spacing = grid.spacing();
    for (int axis = 0; axis < 3; ++axis)
        // Written so that NaN fails.
        if (!(spacing[axis] >= 1e-18 && spacing[axis] <= 1e18))
            throw InputError(path.string() + ": the spacing along " + axis_name(axis) + " is " +
                             std::to_string(spacing[axis]) +
                             "; it must be a finite number above 0: correct it in the header");
    for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(grid.origin[axis]) <= 1e18))
            throw InputError(path.string() + ": the origin is not finite; correct it in the header");
    const double volume = glm::determinant(glm::dmat3(
        grid.directions[0] / spacing.x, grid.directions[1] / spacing.y, grid.directions[2] / spacing.z));
    if (!(std::abs(volume) > 1e-6))
        throw InputError(path.string() +
                         ": the directions of its axes lie in one plane; correct them in the header");
}

void check_finite(const std::filesystem::path& path, const Volume& volume) {
    if (!is_floating(volume.type)) return;
    visit_type(volume.type, [&](auto voxel) {
        using T = decltype(voxel);
        const std::span<const T> voxels = volume.voxels<T>();
        const auto bad = std::find_if(voxels.begin(), voxels.end(), [](T v) { return !std::isfinite(v); });
        if (bad == voxels.end()) return;
        const auto count = std::count_if(bad, voxels.end(), [](T v) { return !std::isfinite(v); });
        const auto index = static_cast<std::size_t>(bad - voxels.begin());
        const auto& size = volume.grid.size;
        throw InputError(path.string() + ": voxel (" + std::to_string(index % size[0]) + ", " +
                         std::to_string(index / size[0] % size[1]) + ", " +
                         std::to_string(index / size[0] / size[1]) + ") is " +
                         (std::isnan(*bad) ? "NaN" : "infinite") + " (" + std::to_string(count) +
                         " of them are not finite); replace them by a value that means empty");
    });
}

const char* axis_name(int axis) {
    constexpr const char* kNames[] = {"x", "y", "z"};
    return kNames[axis];
}

void swap_bytes(std::span<std::byte> bytes, std::size_t size) {
    // Sizes that the compiler knows become byte-swap instructions.
    const auto swap = [&](auto word) {
        constexpr std::size_t kSize = decltype(word)::value;
        for (std::size_t at = 0; at + kSize <= bytes.size(); at += kSize)
            std::reverse(bytes.data() + at, bytes.data() + at + kSize);
    };
    if (size == 2) swap(std::integral_constant<std::size_t, 2>());
    if (size == 4) swap(std::integral_constant<std::size_t, 4>());
    if (size == 8) swap(std::integral_constant<std::size_t, 8>());
}

}  // namespace dfield
