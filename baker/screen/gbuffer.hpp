// What a camera sees, pixel by pixel: the input of everything that works in screen space.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "baker/screen/screen_camera.hpp"

namespace dfield {

// Rows from the top. Buffers that are not known are empty, the others have width * height entries.
struct GBuffer {
    std::uint32_t width = 0, height = 0;
    ScreenCamera camera;
    // Along -z, world units; INFINITY where the camera sees no surface (NaN and what is not above 0 count as
    // that too).
    std::vector<float> depth;
    std::vector<glm::vec3> normals;   // camera space, unit, towards the camera; 0 on sky
    std::vector<glm::vec3> albedo;    // linear; 0 on sky
    std::vector<glm::vec3> radiance;  // direct light that the surface reflects, linear; on sky the background

    std::size_t pixels() const { return std::size_t{width} * height; }
};

inline constexpr std::uint32_t kMaxScreenSide = 16384;

// An .exr, or a .json that names PNGs: docs/gbuffer.md. Throws InputError: unreadable, malformed, a channel
// missing, buffers of different sizes. `lens` is the camera of a file that says nothing of its own; its
// half_width follows from the picture's aspect. Null: such a file is an error.
GBuffer read_gbuffer(const std::filesystem::path& path, const ScreenCamera* lens = nullptr);
bool is_gbuffer(const std::filesystem::path& path);  // by its ending

// .exr, or .json with PNGs beside it; each file atomically. Throws OutputError, Error(kUsage) for another
// ending.
void write_gbuffer(const std::filesystem::path& path, const GBuffer& buffer);

}  // namespace dfield
