// Files for a fuzzer that reads files.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "tests/fuzz/input.hpp"

namespace dfield::fuzz {

// A folder of this process, in memory where there is such a place.
inline const std::filesystem::path& folder() {
    static const struct Folder {
        std::filesystem::path path;
        Folder() {
            std::error_code error;
            const std::filesystem::path memory = "/dev/shm";
            std::string name =
                ((std::filesystem::is_directory(memory, error) ? memory
                                                               : std::filesystem::temp_directory_path()) /
                 "dfield-fuzz-XXXXXX")
                    .string();
            require(mkdtemp(name.data()) != nullptr);
            path = name;
        }
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(path, ignored);
        }
    } folder;
    return folder.path;
}

// In that folder.
inline std::filesystem::path write(const std::string& name, const std::string& bytes) {
    const std::filesystem::path path = folder() / name;
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
    return path;
}

}  // namespace dfield::fuzz
