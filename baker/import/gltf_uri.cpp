#include "baker/import/gltf_uri.hpp"

namespace dfield {
namespace {

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

}  // namespace

std::optional<std::filesystem::path> relative_path_of_uri(std::string_view uri) {
    const std::size_t colon = uri.find(':');
    if (uri.empty() || uri.front() == '/' || (colon != std::string_view::npos && colon < uri.find('/')))
        return std::nullopt;
    std::u8string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
        const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
        if (low < 0) {
            text += static_cast<char8_t>(uri[i]);
            continue;
        }
        text += static_cast<char8_t>(high * 16 + low);
        i += 2;
    }
    const std::filesystem::path path(text);
    if (path.is_absolute() || text.find(u8'\0') != std::u8string::npos) return std::nullopt;
    return path;
}

std::string uri_of_relative_path(const std::filesystem::path& path) {
    std::string uri;
    for (const char8_t c : path.generic_u8string()) {
        const bool plain =
            (c >= u8'A' && c <= u8'Z') || (c >= u8'a' && c <= u8'z') || (c >= u8'0' && c <= u8'9') ||
            std::string_view("-._~/!$&'()*+,;=@").find(static_cast<char>(c)) != std::string_view::npos;
        if (plain)
            uri += static_cast<char>(c);
        else
            (uri += '%') += {"0123456789ABCDEF"[c / 16], "0123456789ABCDEF"[c % 16]};
    }
    return uri;
}

}  // namespace dfield
