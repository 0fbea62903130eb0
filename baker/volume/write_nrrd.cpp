#include "baker/volume/write_nrrd.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <ostream>
#include <stdexcept>

#include "baker/error.hpp"
#include "baker/file_io.hpp"
#include "baker/volume/teem.hpp"

namespace dfield {
namespace {

using Components = std::span<const std::span<const std::byte>>;

int teem_type(VoxelType type) {
    switch (type) {
        case VoxelType::kI8:
            return nrrdTypeChar;
        case VoxelType::kU8:
            return nrrdTypeUChar;
        case VoxelType::kI16:
            return nrrdTypeShort;
        case VoxelType::kU16:
            return nrrdTypeUShort;
        case VoxelType::kI32:
            return nrrdTypeInt;
        case VoxelType::kU32:
            return nrrdTypeUInt;
        case VoxelType::kF32:
            return nrrdTypeFloat;
        case VoxelType::kF64:
            break;
    }
    return nrrdTypeDouble;
}

void place(Nrrd& nrrd, const VolumeGrid& grid) {
    if (grid.space.empty()) {
        for (int i = 0; i < 3; ++i) {
            NrrdAxisInfo& axis = nrrd.axis[i];
            axis.spacing = grid.directions[i][i];
            if (grid.origin != glm::dvec3(0)) {
                axis.min = grid.origin[i];
                axis.center = nrrdCenterNode;
            }
        }
        return;
    }
    const int space = airEnumVal(nrrdSpace, grid.space.c_str());
    if (space != nrrdSpaceUnknown && nrrdSpaceDimension(space) == 3)
        nrrdSpaceSet(&nrrd, space);
    else
        nrrdSpaceDimensionSet(&nrrd, 3);
    for (int i = 0; i < 3; ++i) {
        for (int component = 0; component < 3; ++component)
            nrrd.axis[i].spaceDirection[component] = grid.directions[i][component];
        nrrd.spaceOrigin[i] = grid.origin[i];
        if (!grid.unit.empty()) nrrd.spaceUnits[i] = airStrdup(grid.unit.c_str());
    }
}

std::string header_of(const std::filesystem::path& path, const VolumeGrid& grid, VoxelType type,
                      Components components, const NrrdOptions& options) {
    const TeemLock lock;
    const NrrdPointer nrrd(nrrdNew());
    const NrrdIoPointer state(nrrdIoStateNew());
    if (!nrrd || !state) throw std::bad_alloc();
    const auto fail = [&] {
        throw OutputError(path.string() + ": no NRRD header for this volume: " + lock.error());
    };
    const unsigned axes = components.size() > 1 ? 4 : 3;
    const std::size_t sizes[] = {grid.size[0], grid.size[1], grid.size[2], components.size()};
    // Teem wants to see voxels but does not touch them while it writes a header.
    void* voxels = const_cast<std::byte*>(components[0].data());
    if (nrrdWrap_nva(nrrd.get(), voxels, teem_type(type), axes, sizes) != 0) fail();
    place(*nrrd, grid);
    // Teem writes the units of labelled axes only, and reads through a null pointer where such an axis has
    // none.
    static constexpr const char* kNames[] = {"x", "y", "z", "component"};
    const bool units = grid.space.empty() && !grid.unit.empty();
    for (unsigned i = 0; i < axes; ++i) {
        NrrdAxisInfo& axis = nrrd->axis[i];
        axis.kind = i < 3 ? nrrdKindDomain : nrrdKindList;
        if (!options.labels.empty())
            axis.label = airStrdup(options.labels[i].c_str());
        else if (units)
            axis.label = airStrdup(kNames[i]);
        if (units) axis.units = airStrdup(i < 3 ? grid.unit.c_str() : "");
    }
    if (!options.content.empty()) nrrd->content = airStrdup(options.content.c_str());
    state->encoding = options.gzip ? nrrdEncodingGzip : nrrdEncodingRaw;
    state->endian = airMyEndian();
    char* text = nullptr;
    if (nrrdStringWrite(&text, nrrd.get(), state.get()) != 0) fail();
    std::string header = text;
    std::free(text);
    while (header.ends_with('\n')) header.pop_back();
    return header + "\n\n";
}

// Deflates the components as one gzip member.
void write_gzip(std::ostream& file, Components components) {
    z_stream stream{};
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        throw std::bad_alloc();
    const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, deflateEnd);
    std::vector<std::byte> output(1 << 18);
    const auto deflate_all = [&](std::span<const std::byte> bytes, int flush) {
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
        stream.avail_in = static_cast<uInt>(bytes.size());
        do {
            stream.next_out = reinterpret_cast<Bytef*>(output.data());
            stream.avail_out = static_cast<uInt>(output.size());
            deflate(&stream, flush);
            file.write(reinterpret_cast<const char*>(output.data()),
                       static_cast<std::streamsize>(output.size() - stream.avail_out));
        } while (stream.avail_out == 0 && file);
    };
    constexpr std::size_t kPiece = 1u << 30;  // zlib counts in 32 bits
    for (const std::span<const std::byte> component : components)
        for (std::size_t at = 0; at < component.size() && file; at += kPiece)
            deflate_all(component.subspan(at, std::min(kPiece, component.size() - at)), Z_NO_FLUSH);
    deflate_all({}, Z_FINISH);
}

}  // namespace

void write_nrrd(const std::filesystem::path& path, const VolumeGrid& grid, VoxelType type,
                Components components, const NrrdOptions& options) {
    const bool sizes_match =
        !components.empty() && grid.voxels() > 0 &&
        std::all_of(components.begin(), components.end(), [&](std::span<const std::byte> component) {
            return component.size() == grid.voxels() * size_of(type);
        });
    const std::size_t axes = components.size() > 1 ? 4 : 3;
    if (!sizes_match || (!options.labels.empty() && options.labels.size() != axes))
        throw std::invalid_argument("write_nrrd: the components or labels do not match the grid");
    const std::string header = header_of(path, grid, type, components, options);
    write_file_atomic(path, [&](std::ostream& file) {
        file.write(header.data(), static_cast<std::streamsize>(header.size()));
        if (options.gzip) return write_gzip(file, components);
        for (const std::span<const std::byte> component : components)
            file.write(reinterpret_cast<const char*>(component.data()),
                       static_cast<std::streamsize>(component.size()));
    });
}

void write_nrrd(const std::filesystem::path& path, const Volume& volume, const NrrdOptions& options) {
    const std::span<const std::byte> data = volume.data;
    write_nrrd(path, volume.grid, volume.type, std::span(&data, 1), options);
}

}  // namespace dfield
