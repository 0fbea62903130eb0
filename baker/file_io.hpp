// Whole files in and out. Outputs go to a temporary file beside the target and are renamed when complete.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace dfield {

std::vector<std::byte> read_file(const std::filesystem::path& path);                          // InputError
void write_file_atomic(const std::filesystem::path& path, std::span<const std::byte> bytes);  // OutputError
void write_file_atomic(const std::filesystem::path& path, std::string_view text);             // OutputError

}  // namespace dfield
