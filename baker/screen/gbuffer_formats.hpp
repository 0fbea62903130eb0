// The readers and writers behind read_gbuffer() and write_gbuffer(), and what they share.
#pragma once

#include <nlohmann/json.hpp>

#include "baker/screen/gbuffer.hpp"

namespace dfield {

GBuffer read_exr_gbuffer(const std::filesystem::path& path, const ScreenCamera* lens);
GBuffer read_png_gbuffer(const std::filesystem::path& path, const ScreenCamera* lens);
void write_exr_gbuffer(const std::filesystem::path& path, const GBuffer& buffer);
void write_png_gbuffer(const std::filesystem::path& path, const GBuffer& buffer);

// The JSON that goes with either: {"camera": {...}, "depth": {"encoding": ...}, ...}. `where` names it in
// messages. Throws InputError: broken, no object.
nlohmann::json parse_gbuffer_json(const std::string& where, std::string_view text);
nlohmann::json camera_json(const ScreenCamera& camera);
// description["camera"]; where it has none, `lens` with the picture's aspect.
ScreenCamera read_camera_json(const std::string& where, const nlohmann::json& description,
                              const ScreenCamera* lens, std::uint32_t width, std::uint32_t height);
// A finite number, or `fallback` where object has none of that name. Throws InputError.
double read_number(const std::string& where, const nlohmann::json& object, const char* name, double fallback);
// What description["depth"]["encoding"] says: linear (the default) or device, which wants the camera's
// planes. Throws InputError.
bool depth_is_device(const std::string& where, const nlohmann::json& description, const ScreenCamera& camera);

// Throws InputError for sides beyond kMaxScreenSide and for files much too small to hold such a picture, so
// that a few bytes cannot ask for gigabytes.
void check_picture_size(const std::string& where, std::uint64_t width, std::uint64_t height,
                        std::uint64_t file_bytes);

}  // namespace dfield
