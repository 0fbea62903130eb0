// A file's bytes from an offset on, as they are or out of gzip. Errors are InputErrors that name the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <vector>

namespace dfield {

class DataStream {
  public:
    enum class Encoding { kRaw, kGzip };

    // Opens a regular file; `offset` may lie beyond its end.
    DataStream(std::filesystem::path path, Encoding encoding, std::uint64_t offset = 0);
    ~DataStream();
    DataStream(const DataStream&) = delete;
    DataStream& operator=(const DataStream&) = delete;

    const std::filesystem::path& path() const { return path_; }
    // No more than this can come; exact for raw files. Before the first read().
    std::uint64_t most_bytes() const { return most_bytes_; }
    // As many bytes as there are, up to the span's size. Fewer only at the end of the data, where gzip's
    // checksum has been checked.
    std::size_t read(std::span<std::byte> bytes);
    // Reads on to the end, or so far as to know that more than `limit` bytes follow; how many there were.
    std::uint64_t drain(std::uint64_t limit);

  private:
    struct Inflater;

    std::size_t read_file(std::span<std::byte> bytes);

    std::filesystem::path path_;
    std::ifstream file_;
    std::uint64_t most_bytes_ = 0;
    std::unique_ptr<Inflater> inflater_;  // null for raw
};

// Whether the file begins with gzip's two bytes.
bool is_gzip(const std::filesystem::path& path);

}  // namespace dfield
