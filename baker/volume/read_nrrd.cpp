// NRRD. Teem parses the header's fields; names of data files and the voxels themselves are read here, since
// teem allocates what the header claims, overruns a buffer on long ASCII tokens and wraps numbers that do not
// fit.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "baker/error.hpp"
#include "baker/import/text_scan.hpp"
#include "baker/volume/nrrd_header.hpp"
#include "baker/volume/teem.hpp"
#include "baker/volume/volume_formats.hpp"

namespace dfield {
namespace {

enum class Encoding { kRaw, kGzip, kAscii };

// What teem made of the fields.
struct NrrdFields {
    VolumeGrid grid;
    VoxelType type = VoxelType::kU8;
    Encoding encoding = Encoding::kRaw;
    bool swapped = false;  // the file's byte order is not this machine's
    std::uint64_t line_skip = 0;
    std::int64_t byte_skip = 0;
};

class FieldReader {
  public:
    FieldReader(const std::filesystem::path& path, const NrrdHeader& header)
        : path_(path), nrrd_(nrrdNew()), state_(nrrdIoStateNew()) {
        if (!nrrd_ || !state_) throw std::bad_alloc();
        state_->skipData = 1;
        if (nrrdStringRead(nrrd_.get(), header.fields.c_str(), state_.get()) != 0)
            fail(lock_.error() + "; correct the header");
    }

    NrrdFields read() {
        NrrdFields fields;
        fields.type = type();
        fields.encoding = encoding();
        fields.swapped = fields.encoding != Encoding::kAscii && size_of(fields.type) > 1 &&
                         state_->endian != airMyEndian();
        fields.line_skip = state_->lineSkip;
        fields.byte_skip = state_->byteSkip;
        if (fields.byte_skip < (fields.encoding == Encoding::kRaw ? -1 : 0))
            fail("byte skip " + std::to_string(fields.byte_skip) + " is not for this encoding");
        if (nrrd_->spaceDim != 0 && nrrd_->spaceDim != 3)
            fail("its space has " + std::to_string(nrrd_->spaceDim) +
                 " dimensions, dfield knows three; remove the fields of space and give 'spacings'");
        const std::array<unsigned, 3> axes = spatial_axes();
        for (std::size_t i = 0; i < 3; ++i) fields.grid.size[i] = nrrd_->axis[axes[i]].size;
        place(fields.grid, axes);
        return fields;
    }

  private:
    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(path_.string() + ": " + message);
    }

    VoxelType type() const {
        switch (nrrd_->type) {
            case nrrdTypeChar:
                return VoxelType::kI8;
            case nrrdTypeUChar:
                return VoxelType::kU8;
            case nrrdTypeShort:
                return VoxelType::kI16;
            case nrrdTypeUShort:
                return VoxelType::kU16;
            case nrrdTypeInt:
                return VoxelType::kI32;
            case nrrdTypeUInt:
                return VoxelType::kU32;
            case nrrdTypeFloat:
                return VoxelType::kF32;
            case nrrdTypeDouble:
                return VoxelType::kF64;
            default:
                fail(std::string("voxels of type ") + airEnumStr(nrrdType, nrrd_->type) +
                     " are not supported; convert them, such as by 'unu convert -t float'");
        }
    }

    Encoding encoding() const {
        if (state_->encoding == nrrdEncodingRaw) return Encoding::kRaw;
        if (state_->encoding == nrrdEncodingGzip) return Encoding::kGzip;
        if (state_->encoding == nrrdEncodingAscii) return Encoding::kAscii;
        fail(std::string("encoding ") + state_->encoding->name +
             " is not supported; save it raw or with gzip, such as by 'unu save -f nrrd -e gzip'");
    }

    std::string sizes() const {
        std::vector<std::size_t> all;
        for (unsigned i = 0; i < nrrd_->dim; ++i) all.push_back(nrrd_->axis[i].size);
        return size_text(all);
    }

    bool has_direction(unsigned axis) const { return AIR_EXISTS(nrrd_->axis[axis].spaceDirection[0]); }

    // The file's three axes of space; any others must have a size of 1.
    std::array<unsigned, 3> spatial_axes() const {
        std::vector<unsigned> axes;
        for (unsigned i = 0; i < nrrd_->dim; ++i) axes.push_back(i);
        const bool directions =
            std::any_of(axes.begin(), axes.end(), [&](unsigned i) { return has_direction(i); });
        const auto spatial = [&](unsigned i) {
            return directions
                       ? has_direction(i)
                       : nrrd_->axis[i].kind == nrrdKindUnknown || nrrdKindIsDomain(nrrd_->axis[i].kind) != 0;
        };
        // Axes of something else than space go, then those at the end, then those at the beginning.
        for (std::size_t i = axes.size(); i-- > 0 && axes.size() > 3;)
            if (!spatial(axes[i]) && nrrd_->axis[axes[i]].size == 1)
                axes.erase(axes.begin() + static_cast<std::ptrdiff_t>(i));
        while (axes.size() > 3 && nrrd_->axis[axes.back()].size == 1) axes.pop_back();
        while (axes.size() > 3 && nrrd_->axis[axes.front()].size == 1) axes.erase(axes.begin());
        if (axes.size() < 3)
            fail("has " + std::to_string(nrrd_->dim) + " axes (" + sizes() +
                 "), a volume has three; stack slices, such as by 'unu join'");
        if (axes.size() > 3)
            fail("has " + std::to_string(nrrd_->dim) + " axes (" + sizes() +
                 "): several values a voxel or points in time; choose one, such as by 'unu slice'");
        for (const unsigned i : axes)
            if (!spatial(i))
                fail("axis " + std::to_string(i) + " of its axes (" + sizes() +
                     ") is not one of space: it has several values a voxel and fewer than three dimensions");
        return {axes[0], axes[1], axes[2]};
    }

    void place(VolumeGrid& grid, const std::array<unsigned, 3>& axes) const {
        if (nrrd_->spaceDim != 0) {
            grid.space =
                nrrd_->space != nrrdSpaceUnknown ? airEnumStr(nrrdSpace, nrrd_->space) : kUnnamedSpace;
            for (int component = 0; component < 3; ++component)
                if (AIR_EXISTS(nrrd_->spaceOrigin[component]))
                    grid.origin[component] = nrrd_->spaceOrigin[component];
        }
        for (int i = 0; i < 3; ++i) {
            const NrrdAxisInfo& axis = nrrd_->axis[axes[static_cast<std::size_t>(i)]];
            if (AIR_EXISTS(axis.spaceDirection[0])) {
                for (int component = 0; component < 3; ++component)
                    grid.directions[i][component] = axis.spaceDirection[component];
                continue;
            }
            const bool node =
                axis.center == nrrdCenterNode;  // teem, too, takes axes for cell-centred by default
            double spacing = axis.spacing;
            if (!AIR_EXISTS(spacing) && AIR_EXISTS(axis.min) && AIR_EXISTS(axis.max) &&
                (!node || axis.size > 1))
                spacing = (axis.max - axis.min) / static_cast<double>(node ? axis.size - 1 : axis.size);
            if (!AIR_EXISTS(spacing)) spacing = 1;
            grid.directions[i][i] = spacing;
            if (AIR_EXISTS(axis.min) && nrrd_->spaceDim == 0)
                grid.origin[i] = node ? axis.min : axis.min + spacing / 2;
        }
    }

    const std::filesystem::path& path_;
    TeemLock lock_;
    NrrdPointer nrrd_;
    NrrdIoPointer state_;
};

constexpr std::size_t kChunk = 1 << 16;

// The offset behind `lines` lines from `offset` on.
std::uint64_t skip_lines(const std::filesystem::path& file, std::uint64_t offset, std::uint64_t lines) {
    if (lines == 0) return offset;
    DataStream stream(file, DataStream::Encoding::kRaw, offset);
    std::vector<std::byte> chunk(kChunk);
    for (std::size_t count; (count = stream.read(chunk)) > 0; offset += count)
        for (std::size_t i = 0; i < count; ++i)
            if (chunk[i] == std::byte{'\n'} && --lines == 0) return offset + i + 1;
    throw InputError(file.string() +
                     ": ends within the lines that 'line skip' leaves out; correct the header");
}

// The voxels as text, separated by blanks or commas.
template<class T>
void read_ascii(DataStream& stream, std::span<T> voxels) {
    std::vector<std::byte> chunk(kChunk);
    std::string token;
    std::size_t done = 0;
    const auto finish = [&] {
        if (token.empty()) return;
        if (done == voxels.size())
            throw InputError(stream.path().string() + ": has more than the " + std::to_string(voxels.size()) +
                             " voxels of its header; correct its sizes");
        std::string_view digits = token;
        if (digits.starts_with('+')) digits.remove_prefix(1);
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), voxels[done]);
        if (error != std::errc() || end != digits.data() + digits.size())
            throw InputError(stream.path().string() + ": voxel " + std::to_string(done) + " is " +
                             quoted(std::string_view(token)) + ", which is no number of the header's type");
        ++done;
        token.clear();
    };
    for (std::size_t count; (count = stream.read(chunk)) > 0;)
        for (std::size_t i = 0; i < count; ++i) {
            const char c = static_cast<char>(chunk[i]);
            if (c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ',')
                finish();
            else if (token.size() < 400)  // the longest double written out has 326 digits
                token += c;
        }
    finish();
    if (done < voxels.size())
        throw InputError(stream.path().string() + ": its header promises " + std::to_string(voxels.size()) +
                         " voxels, the file has " + std::to_string(done));
}

class VoxelReader {
  public:
    VoxelReader(const std::filesystem::path& path, const NrrdHeader& header, const NrrdFields& fields,
                Warnings& warnings)
        : path_(path), header_(header), fields_(fields), warnings_(warnings) {}

    // `bytes`: of all voxels, checked.
    void read(Volume& volume, std::uint64_t bytes) {
        const std::size_t files = header_.data_files.size();
        check_pieces(files);
        piece_bytes_ = bytes / files;
        // Nothing is allocated before every file is known to be large enough.
        for (const std::filesystem::path& file : header_.data_files) check_size(*open(file));
        volume.data.resize(bytes);
        for (std::size_t i = 0; i < files; ++i)
            read_piece(*open(header_.data_files[i]), volume,
                       std::span(volume.data).subspan(i * piece_bytes_, piece_bytes_));
        if (fields_.swapped) swap_bytes(volume.data, size_of(fields_.type));
    }

  private:
    void check_pieces(std::size_t files) const {
        const auto& size = fields_.grid.size;
        // Pieces are whole along the fast axes, which only the header's text says for a list of slabs.
        const bool whole = header_.piece_axes == 0 || header_.piece_axes >= 3
                               ? size[2] % files == 0 || files == size[1] * size[2]
                               : files == (header_.piece_axes == 2 ? size[2] : size[1] * size[2]);
        if (!whole)
            throw InputError(path_.string() + ": " + std::to_string(files) + " data files do not share out " +
                             size_text(size) + " voxels evenly; correct the list of files or the sizes");
    }

    std::unique_ptr<DataStream> open(const std::filesystem::path& file) const {
        std::error_code ignored;
        if (header_.detached && !std::filesystem::exists(file, ignored))
            throw InputError(path_.string() + ": its data file " + file.string() +
                             " does not exist; put it there or correct 'data file:' in the header");
        std::uint64_t offset = skip_lines(file, header_.data_offset, fields_.line_skip);
        if (fields_.encoding == Encoding::kGzip)
            return std::make_unique<DataStream>(file, DataStream::Encoding::kGzip, offset);
        if (fields_.byte_skip >= 0) {
            offset += static_cast<std::uint64_t>(fields_.byte_skip);
        } else {  // the voxels are the file's last bytes
            const std::uint64_t length = DataStream(file, DataStream::Encoding::kRaw).most_bytes();
            if (length >= offset + piece_bytes_) offset = length - piece_bytes_;
        }
        return std::make_unique<DataStream>(file, DataStream::Encoding::kRaw, offset);
    }

    void check_size(const DataStream& stream) const {
        const std::uint64_t voxel = size_of(fields_.type);
        std::uint64_t most = stream.most_bytes();
        if (fields_.encoding == Encoding::kAscii) most = (most + 1) / 2 * voxel;  // a digit and a blank
        if (most < piece_bytes_) too_short(stream, most);
    }

    [[noreturn]] void too_short(const DataStream& stream, std::uint64_t bytes) const {
        throw InputError(stream.path().string() + ": " + size_text(fields_.grid.size) + " voxels of type " +
                         name_of(fields_.type) + " take " + std::to_string(piece_bytes_) + " bytes" +
                         (header_.data_files.size() > 1 ? " in each file" : "") + ", the file has " +
                         std::to_string(bytes) + "; the file is cut off or its header is wrong");
    }

    void read_piece(DataStream& stream, Volume& volume, std::span<std::byte> piece) {
        if (fields_.encoding == Encoding::kAscii) {
            visit_type(volume.type, [&](auto voxel) {
                using T = decltype(voxel);
                const std::size_t begin =
                    static_cast<std::size_t>(piece.data() - volume.data.data()) / sizeof(T);
                read_ascii(stream, volume.voxels<T>().subspan(begin, piece.size() / sizeof(T)));
            });
            return;
        }
        if (fields_.encoding == Encoding::kGzip) {  // the bytes to skip are compressed as well
            std::vector<std::byte> chunk(kChunk);
            for (auto left = static_cast<std::uint64_t>(fields_.byte_skip); left > 0;) {
                const std::size_t count =
                    stream.read(std::span(chunk).first(std::min<std::uint64_t>(left, kChunk)));
                if (count == 0) too_short(stream, 0);
                left -= count;
            }
        }
        if (const std::size_t count = stream.read(piece); count < piece.size()) too_short(stream, count);
        if (stream.drain(0) > 0)
            warnings_.push_back(stream.path().string() + ": bytes after the last voxel are left out");
    }

    const std::filesystem::path& path_;
    const NrrdHeader& header_;
    const NrrdFields& fields_;
    Warnings& warnings_;
    std::uint64_t piece_bytes_ = 0;
};

}  // namespace

Volume read_nrrd(const std::filesystem::path& path, const VolumeReadOptions& options, Warnings& warnings) {
    const NrrdHeader header = read_nrrd_header(path);
    const NrrdFields fields = FieldReader(path, header).read();
    Volume volume;
    volume.grid = fields.grid;
    volume.grid.unit = header.unit;
    volume.type = fields.type;
    check_geometry(path, volume.grid);
    const std::uint64_t bytes = checked_bytes(path, volume.grid.size, volume.type, options.max_bytes);
    VoxelReader(path, header, fields, warnings).read(volume, bytes);
    check_finite(path, volume);
    return volume;
}

}  // namespace dfield
