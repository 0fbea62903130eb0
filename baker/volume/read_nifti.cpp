// NIfTI-1 and NIfTI-2. The library swaps headers and turns their transforms into matrices; what it would mend
// silently (spacings of 0, sizes below 1, NaN) or believe (offsets, sizes) is checked before, and voxels are
// read here, since the library turns NaN into 0.
#include <nifti2_io.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "baker/error.hpp"
#include "baker/import/text_scan.hpp"
#include "baker/volume/volume_formats.hpp"

namespace dfield {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kChunk = 1 << 16;

struct NiftiDeleter {
    void operator()(nifti_image* image) const { nifti_image_free(image); }
};
using NiftiPointer = std::unique_ptr<nifti_image, NiftiDeleter>;

// "brain.hdr.gz" -> "brain"; `extension` gets ".hdr".
fs::path stem_of(const fs::path& path, std::string& extension) {
    fs::path stem = path;
    if (equal_ignoring_case(stem.extension().string(), ".gz")) stem.replace_extension();
    extension = stem.extension().string();
    return stem.replace_extension();
}

std::unique_ptr<DataStream> open(const fs::path& path) {
    return std::make_unique<DataStream>(
        path, is_gzip(path) ? DataStream::Encoding::kGzip : DataStream::Encoding::kRaw);
}

class NiftiReader {
  public:
    NiftiReader(fs::path path, const VolumeReadOptions& options, Warnings& warnings)
        : path_(std::move(path)), options_(options), warnings_(warnings) {}

    Volume read() {
        std::array<char, sizeof(nifti_2_header)> bytes{};
        const std::size_t count = open(path_)->read(std::as_writable_bytes(std::span(bytes)));
        std::int32_t header_size = 0;
        std::memcpy(&header_size, bytes.data(), sizeof header_size);
        for (const bool swapped : {false, true}) {
            if (swapped) swap_bytes(std::as_writable_bytes(std::span(&header_size, 1)), sizeof header_size);
            if (header_size == sizeof(nifti_1_header) && count >= sizeof(nifti_1_header)) {
                nifti_1_header header;
                std::memcpy(&header, bytes.data(), sizeof header);
                if (swapped) nifti_swap_as_nifti1(&header);
                return read(header, 1, swapped);
            }
            if (header_size == sizeof(nifti_2_header) && count >= sizeof(nifti_2_header)) {
                nifti_2_header header;
                std::memcpy(&header, bytes.data(), sizeof header);
                if (swapped) nifti_swap_as_nifti2(&header);
                return read(header, 2, swapped);
            }
        }
        fail("is no NIfTI file: it does not begin with a header of 348 or 540 bytes");
    }

  private:
    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(path_.string() + ": " + message);
    }

    template<class Header>
    Volume read(const Header& header, int version, bool swapped) {
        if (NIFTI_VERSION(header) == 0)
            fail(
                "is no NIfTI file but ANALYZE 7.5, which does not say how the volume lies; convert it to "
                "NIfTI");
        if (NIFTI_VERSION(header) != version) fail("the magic of its header does not match its version");
        check_dimensions(header);
        check_transform(header);
        Volume volume;
        volume.type = type_of(header.datatype);
        for (std::size_t axis = 0; axis < 3; ++axis)
            volume.grid.size[axis] = static_cast<std::size_t>(header.dim[axis + 1]);
        const std::uint64_t bytes = checked_bytes(path_, volume.grid.size, volume.type, options_.max_bytes);
        const NiftiPointer image = convert(header);
        if (!image) fail("the NIfTI library refuses its header");
        place(volume.grid, *image);
        check_geometry(path_, volume.grid);
        read_voxels(volume, bytes, NIFTI_ONEFILE(header) ? path_ : voxel_file(), offset_of(header));
        if (swapped) swap_bytes(volume.data, size_of(volume.type));
        check_finite(path_, volume);
        scale(volume, header.scl_slope, header.scl_inter);
        return volume;
    }

    static NiftiPointer convert(const nifti_1_header& header) {
        return NiftiPointer(nifti_convert_n1hdr2nim(header, nullptr));
    }
    static NiftiPointer convert(const nifti_2_header& header) {
        return NiftiPointer(nifti_convert_n2hdr2nim(header, nullptr));
    }

    template<class Header>
    void check_dimensions(const Header& header) const {
        const std::int64_t axes = header.dim[0];
        if (axes < 1 || axes > 7) fail("has " + std::to_string(axes) + " axes; the header is damaged");
        std::vector<std::size_t> all;
        for (int i = 1; i <= axes; ++i)
            all.push_back(static_cast<std::size_t>(std::max<std::int64_t>(header.dim[i], 0)));
        const std::string sizes = size_text(all);
        if (axes < 3) fail("has " + std::to_string(axes) + " axes (" + sizes + "), a volume has three");
        for (int i = 1; i <= axes; ++i)
            if (header.dim[i] < 1) fail("its size is " + sizes + " voxels; every size must be above 0");
        for (int i = 4; i <= axes; ++i)
            if (header.dim[i] != 1)
                fail("has " + std::to_string(axes) + " axes (" + sizes +
                     "): several values a voxel or points in time; choose one, such as by 'fslroi'");
    }

    // What the library would silently put right.
    template<class Header>
    void check_transform(const Header& header) const {
        if (header.sform_code > 0) return;  // check_geometry() sees all of it
        for (int i = 1; i <= 3; ++i)
            if (!(std::isfinite(header.pixdim[i]) && header.pixdim[i] > 0))
                fail(std::string("the spacing along ") + axis_name(i - 1) + " is " +
                     std::to_string(header.pixdim[i]) +
                     "; it must be a finite number above 0: correct pixdim in the header");
        if (header.qform_code > 0)
            for (const double value :
                 {double{header.quatern_b}, double{header.quatern_c}, double{header.quatern_d},
                  double{header.qoffset_x}, double{header.qoffset_y}, double{header.qoffset_z}})
                if (!std::isfinite(value)) fail("its qform is not finite; correct it in the header");
    }

    VoxelType type_of(int datatype) const {
        switch (datatype) {
            case DT_INT8:
                return VoxelType::kI8;
            case DT_UINT8:
                return VoxelType::kU8;
            case DT_INT16:
                return VoxelType::kI16;
            case DT_UINT16:
                return VoxelType::kU16;
            case DT_INT32:
                return VoxelType::kI32;
            case DT_UINT32:
                return VoxelType::kU32;
            case DT_FLOAT32:
                return VoxelType::kF32;
            case DT_FLOAT64:
                return VoxelType::kF64;
            default:
                fail(std::string("voxels of type ") + nifti_datatype_string(datatype) + " (" +
                     std::to_string(datatype) + ") are not supported; convert them to FLOAT32");
        }
    }

    static std::string unit_name(int unit) {
        switch (unit) {
            case NIFTI_UNITS_METER:
                return "m";
            case NIFTI_UNITS_MM:
                return "mm";
            case NIFTI_UNITS_MICRON:
                return "um";
            default:
                return {};
        }
    }

    // NIfTI's methods 3 (sform), 2 (qform) and 1 (spacing alone), the first of them that the file has.
    static void place(VolumeGrid& grid, const nifti_image& image) {
        const bool placed = image.sform_code > 0 || image.qform_code > 0;
        const nifti_dmat44& to_world = image.sform_code > 0 ? image.sto_xyz : image.qto_xyz;
        for (int row = 0; row < 3; ++row) {
            for (int axis = 0; axis < 3; ++axis) grid.directions[axis][row] = to_world.m[row][axis];
            grid.origin[row] = to_world.m[row][3];
        }
        if (placed) grid.space = "right-anterior-superior";
        grid.unit = unit_name(image.xyz_units);
    }

    template<class Header>
    std::uint64_t offset_of(const Header& header) const {
        const auto offset = static_cast<double>(header.vox_offset);
        if (!(offset >= 0 && offset <= 1e15 && offset == std::floor(offset)))
            fail("the voxels' offset in the file is " + std::to_string(offset) + "; the header is damaged");
        if (!NIFTI_ONEFILE(header)) return static_cast<std::uint64_t>(offset);
        // After the header and the four bytes that say whether extensions follow; some writers leave it 0.
        constexpr double kFirst = sizeof(Header) + 4;
        if (offset != 0 && offset < kFirst)
            fail("the voxels begin within the header, at byte " + std::to_string(offset) +
                 "; the header is damaged");
        return static_cast<std::uint64_t>(offset == 0 ? kFirst : offset);
    }

    fs::path voxel_file() const {
        std::string extension;
        const fs::path stem = stem_of(path_, extension);
        for (const char* name : {".img", ".img.gz"}) {
            fs::path file = stem;
            file += name;
            std::error_code ignored;
            if (fs::exists(file, ignored)) return file;
        }
        fail("its voxels, " + stem.string() + ".img or .img.gz, do not exist; put them beside the header");
    }

    void read_voxels(Volume& volume, std::uint64_t bytes, const fs::path& file, std::uint64_t offset) {
        const std::unique_ptr<DataStream> stream = open(file);
        const auto too_short = [&](std::uint64_t found) {
            throw InputError(stream->path().string() + ": " + size_text(volume.grid.size) +
                             " voxels of type " + name_of(volume.type) + " take " + std::to_string(bytes) +
                             " bytes after the first " + std::to_string(offset) + ", the file has " +
                             std::to_string(found) + "; the file is cut off or its header is wrong");
        };
        const std::uint64_t most = stream->most_bytes();
        if (most < offset || most - offset < bytes) too_short(most < offset ? 0 : most - offset);
        std::vector<std::byte> chunk(kChunk);
        for (std::uint64_t left = offset; left > 0;) {
            const std::size_t count =
                stream->read(std::span(chunk).first(std::min<std::uint64_t>(left, kChunk)));
            if (count == 0) too_short(0);
            left -= count;
        }
        volume.data.resize(bytes);
        if (const std::size_t count = stream->read(volume.data); count < bytes) too_short(count);
        if (stream->drain(0) > 0)
            warnings_.push_back(stream->path().string() + ": bytes after the last voxel are left out");
    }

    // value * slope + intercept, as f32 where that holds the file's values exactly, otherwise as f64. A slope
    // of 0 means none, and NaN is what some writers leave there.
    void scale(Volume& volume, double slope, double intercept) const {
        if (slope == 0 || std::isnan(slope) || (slope == 1 && intercept == 0)) return;
        if (!std::isfinite(slope) || !std::isfinite(intercept))
            fail("its slope or intercept is not finite; correct scl_slope and scl_inter in the header");
        const VoxelType type =
            size_of(volume.type) > 2 && volume.type != VoxelType::kF32 ? VoxelType::kF64 : VoxelType::kF32;
        const std::uint64_t bytes = checked_bytes(path_, volume.grid.size, type, options_.max_bytes);
        Volume scaled{volume.grid, type, std::vector<std::byte>(bytes)};
        visit_type(volume.type, [&](auto from) {
            visit_type(type, [&](auto to) {
                using To = decltype(to);
                const auto values = std::as_const(volume).template voxels<decltype(from)>();
                const std::span<To> out = scaled.template voxels<To>();
                for (std::size_t i = 0; i < values.size(); ++i)
                    out[i] = static_cast<To>(static_cast<double>(values[i]) * slope + intercept);
            });
        });
        check_finite(path_, scaled);
        volume = std::move(scaled);
    }

    const fs::path path_;
    const VolumeReadOptions& options_;
    Warnings& warnings_;
};

}  // namespace

Volume read_nifti(const fs::path& path, const VolumeReadOptions& options, Warnings& warnings) {
    // The header of a pair is what says all; its voxels alone may have been named.
    std::string extension;
    const fs::path stem = stem_of(path, extension);
    fs::path header = path;
    if (equal_ignoring_case(extension, ".img"))
        for (const char* name : {".hdr", ".hdr.gz"}) {
            fs::path candidate = stem;
            candidate += name;
            std::error_code ignored;
            if (fs::exists(candidate, ignored)) {
                header = candidate;
                break;
            }
        }
    return NiftiReader(header, options, warnings).read();
}

}  // namespace dfield
