#include "baker/file_io.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <system_error>

#include "baker/error.hpp"

namespace dfield {
namespace {

namespace fs = std::filesystem;

std::string reason_of_errno() {
    return errno != 0 ? std::strerror(errno) : "input/output error";
}

// Removes the temporary file unless it was renamed to its target.
class TemporaryFile {
  public:
    explicit TemporaryFile(const fs::path& target) {
        // Several processes may write the same target at once: each gets its own name in the target's folder.
        std::random_device random;
        path_ = target;
        path_ += ".tmp" + std::to_string(random()) + std::to_string(random());
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        std::error_code ignored;
        if (!kept_) fs::remove(path_, ignored);
    }
    const fs::path& path() const { return path_; }
    void keep() { kept_ = true; }

  private:
    fs::path path_;
    bool kept_ = false;
};

}  // namespace

std::vector<std::byte> read_file(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw InputError(path.string() + ": no such file");
    if (fs::is_directory(status)) throw InputError(path.string() + ": is a folder, not a file");
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InputError(path.string() + ": cannot be opened: " + reason_of_errno());

    std::vector<std::byte> bytes;
    const std::uintmax_t size = fs::is_regular_file(status) ? fs::file_size(path, error) : 0;
    if (size > 0 && !error) bytes.resize(static_cast<std::size_t>(size));
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    // Pipes have no size, and a file may grow while it is read.
    for (char chunk[65536]; file && file.read(chunk, sizeof chunk).gcount() > 0;) {
        const auto* begin = reinterpret_cast<const std::byte*>(chunk);
        bytes.insert(bytes.end(), begin, begin + file.gcount());
    }
    if (file.bad()) throw InputError(path.string() + ": cannot be read: " + reason_of_errno());
    return bytes;
}

void check_output(const fs::path& path) {
    if (path.empty()) throw OutputError("the output has no name");
    std::error_code error;
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, error))
        throw OutputError(path.string() + ": cannot be written: the folder " + folder.string() +
                          " does not exist");
    if (fs::is_directory(path, error))
        throw OutputError(path.string() + ": cannot be written: a folder of that name exists");
}

void write_file_atomic(const fs::path& path, const std::function<void(std::ostream&)>& write) {
    check_output(path);
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    const bool special =
        fs::exists(status) && !fs::is_regular_file(status);  // /dev/stdout, /dev/null, a pipe

    TemporaryFile temporary(path);
    if (special) temporary.keep();
    const fs::path& target = special ? path : temporary.path();
    errno = 0;
    std::ofstream file(target, std::ios::binary | std::ios::trunc);
    if (!file) throw OutputError(path.string() + ": cannot be created: " + reason_of_errno());
    write(file);
    file.close();  // flushes: a full disk shows here at the latest
    if (!file) throw OutputError(path.string() + ": cannot be written: " + reason_of_errno());
    if (special) return;
    fs::rename(temporary.path(), path, error);
    if (error) throw OutputError(path.string() + ": cannot be written: " + error.message());
    temporary.keep();
}

void write_file_atomic(const fs::path& path, std::span<const std::byte> bytes) {
    write_file_atomic(path, [&](std::ostream& file) {
        file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    });
}

void write_file_atomic(const fs::path& path, std::string_view text) {
    write_file_atomic(path, std::as_bytes(std::span(text)));
}

}  // namespace dfield
