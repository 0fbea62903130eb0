#include "baker/error.hpp"
#include "baker/volume/volume_formats.hpp"

namespace dfield {

Volume read_raw(const std::filesystem::path& path, const VolumeReadOptions& options) {
    const RawLayout& layout = *options.raw;
    Volume volume;
    volume.type = layout.type;
    volume.grid.size = layout.size;
    for (int axis = 0; axis < 3; ++axis) volume.grid.directions[axis][axis] = layout.spacing[axis];
    const std::uint64_t bytes = checked_bytes(path, layout.size, layout.type, options.max_bytes);
    check_geometry(path, volume.grid);

    DataStream stream(path, DataStream::Encoding::kRaw, layout.header_bytes);
    if (stream.most_bytes() != bytes)
        throw InputError(path.string() + ": " + size_text(layout.size) + " voxels of type " +
                         name_of(layout.type) + " take " + std::to_string(bytes) + " bytes, the file has " +
                         std::to_string(stream.most_bytes()) +
                         (layout.header_bytes > 0 ? " after the header" : "") +
                         "; correct --dims, --type or --header-bytes");
    volume.data.resize(bytes);
    if (stream.read(volume.data) != bytes) throw InputError(path.string() + ": cannot be read to its end");
    if (layout.endian != std::endian::native) swap_bytes(volume.data, size_of(layout.type));
    check_finite(path, volume);
    return volume;
}

}  // namespace dfield
