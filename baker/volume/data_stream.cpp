#include "baker/volume/data_stream.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>
#include <system_error>

#include "baker/error.hpp"

namespace dfield {
namespace {

namespace fs = std::filesystem;

// Deflate cannot do better: a match of 258 bytes takes two bits at least.
constexpr std::uint64_t kMostInflated = 1032;

std::ifstream open_file(const fs::path& path, std::uint64_t& bytes) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw InputError(path.string() + ": no such file");
    if (fs::is_directory(status)) throw InputError(path.string() + ": is a folder, not a file");
    if (!fs::is_regular_file(status))
        throw InputError(path.string() + ": is no regular file; copy the volume to a file first");
    bytes = fs::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file) throw InputError(path.string() + ": cannot be opened");
    return file;
}

}  // namespace

struct DataStream::Inflater {
    z_stream stream{};
    std::array<std::byte, 1 << 16> input;
    bool at_end = false;

    Inflater() {
        if (inflateInit2(&stream, 15 + 16) != Z_OK) throw std::bad_alloc();  // 16: gzip's wrapper
    }
    ~Inflater() { inflateEnd(&stream); }
};

DataStream::DataStream(fs::path path, Encoding encoding, std::uint64_t offset) : path_(std::move(path)) {
    std::uint64_t bytes = 0;
    file_ = open_file(path_, bytes);
    most_bytes_ = bytes - std::min(bytes, offset);
    if (encoding == Encoding::kGzip) {
        most_bytes_ = most_bytes_ > std::numeric_limits<std::uint64_t>::max() / kMostInflated
                          ? std::numeric_limits<std::uint64_t>::max()
                          : most_bytes_ * kMostInflated;
        inflater_ = std::make_unique<Inflater>();
    }
    file_.seekg(static_cast<std::streamoff>(std::min(bytes, offset)));
}

DataStream::~DataStream() = default;

std::size_t DataStream::read_file(std::span<std::byte> bytes) {
    if (!file_.eof())
        file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    else
        return 0;
    if (file_.bad()) throw InputError(path_.string() + ": cannot be read: input/output error");
    return static_cast<std::size_t>(file_.gcount());
}

std::size_t DataStream::read(std::span<std::byte> bytes) {
    if (!inflater_) return read_file(bytes);
    z_stream& stream = inflater_->stream;
    std::size_t done = 0;
    while (done < bytes.size() && !inflater_->at_end) {
        if (stream.avail_in == 0) {
            stream.avail_in = static_cast<uInt>(read_file(inflater_->input));
            stream.next_in = reinterpret_cast<Bytef*>(inflater_->input.data());
        }
        const std::size_t room = std::min<std::size_t>(bytes.size() - done, 1u << 30);
        stream.next_out = reinterpret_cast<Bytef*>(bytes.data() + done);
        stream.avail_out = static_cast<uInt>(room);
        const int status = inflate(&stream, Z_NO_FLUSH);
        done += room - stream.avail_out;
        if (status == Z_STREAM_END) {
            // Parallel compressors write several members, each with a header of its own. What follows the
            // last one and is none is padding.
            if (stream.avail_in == 0) {
                stream.avail_in = static_cast<uInt>(read_file(inflater_->input));
                stream.next_in = reinterpret_cast<Bytef*>(inflater_->input.data());
            }
            if (stream.avail_in > 0 && *stream.next_in == 0x1f)
                inflateReset(&stream);
            else
                inflater_->at_end = true;
        } else if (status == Z_BUF_ERROR && stream.avail_in == 0) {
            throw InputError(path_.string() + ": its gzip data are cut off; copy or download the file again");
        } else if (status == Z_MEM_ERROR) {
            throw std::bad_alloc();
        } else if (status != Z_OK) {
            throw InputError(path_.string() + ": its gzip data are damaged (" +
                             (stream.msg != nullptr ? stream.msg : "no valid stream") +
                             "); copy or download the file again");
        }
    }
    return done;
}

std::uint64_t DataStream::drain(std::uint64_t limit) {
    std::array<std::byte, 1 << 14> bytes;
    std::uint64_t count = 0;
    for (std::size_t more = 1; more > 0 && count <= limit; count += more) more = read(bytes);
    return count;
}

bool is_gzip(const fs::path& path) {
    DataStream file(path, DataStream::Encoding::kRaw);
    std::array<std::byte, 2> magic{};
    return file.read(magic) == 2 && magic[0] == std::byte{0x1f} && magic[1] == std::byte{0x8b};
}

}  // namespace dfield
