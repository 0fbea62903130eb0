// Whole files in and out. Outputs go to a temporary file beside the target and are renamed when complete.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <span>
#include <string_view>
#include <vector>

namespace dfield {

// What is wrong with an output's name can be said before hours of work: its folder is missing, or it is a
// folder itself. OutputError.
void check_output(const std::filesystem::path& path);

std::vector<std::byte> read_file(const std::filesystem::path& path);                          // InputError
void write_file_atomic(const std::filesystem::path& path, std::span<const std::byte> bytes);  // OutputError
void write_file_atomic(const std::filesystem::path& path, std::string_view text);             // OutputError
// What is too large to hold in memory at once: `write` writes the file piece by piece. Whatever it throws
// comes through, and leaves no file behind.
void write_file_atomic(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

}  // namespace dfield
