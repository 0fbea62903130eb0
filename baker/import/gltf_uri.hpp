// URIs of glTF buffers and images.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace dfield {

// The relative path that a URI stands for, percent escapes resolved; nothing for data URIs, other schemes and
// absolute paths, which do not depend on where the document lies.
std::optional<std::filesystem::path> relative_path_of_uri(std::string_view uri);

// The URI of a relative path, percent-encoded.
std::string uri_of_relative_path(const std::filesystem::path& path);

}  // namespace dfield
