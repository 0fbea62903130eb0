#include "baker/cli/screen_picture.hpp"

#include <algorithm>
#include <cmath>

namespace dfield::cli {

Image screen_picture(const std::string& what, const GBuffer& buffer, const ScreenShading& shading,
                     const ScreenLight& light) {
    const auto colour = [&](std::size_t i) {
        const bool surface = is_surface(buffer.depth[i]);
        if (what == "visibility") return glm::vec3(surface ? shading.visibility[i] : 1);
        if (what == "indirect") return surface ? shading.indirect[i] : glm::vec3(0);
        if (!surface) return light.background;
        const glm::vec3 albedo = buffer.albedo.empty() ? glm::vec3(1) : buffer.albedo[i];
        const glm::vec3 direct = buffer.radiance.empty() ? glm::vec3(0) : buffer.radiance[i];
        const float open = what == "classic" ? 1 : shading.visibility[i];
        const glm::vec3 around = what == "lit" ? shading.indirect[i] : glm::vec3(0);
        return direct + albedo * (light.ambient * open + around);
    };
    Image image(buffer.width, buffer.height);
    for (std::size_t i = 0; i < buffer.pixels(); ++i) {
        const glm::vec3 value = colour(i);
        for (int c = 0; c < 3; ++c)  // NaN, which a file's buffers may hold, is black
            image.rgb[3 * i + static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(
                std::lround(255 * (value[c] > 0 ? std::min(value[c], 1.0f) : 0.0f)));
    }
    return image;
}

}  // namespace dfield::cli
