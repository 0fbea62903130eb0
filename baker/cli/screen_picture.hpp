// Pictures of what screen space computes.
#pragma once

#include <string>

#include "baker/cli/screen_runner.hpp"
#include "baker/picture/image.hpp"

namespace dfield::cli {

struct ScreenLight {
    glm::vec3 ambient{1}, background{1};
};

// what: visibility, indirect, classic, ambient or lit, as --show has them; the sky is white in visibility's,
// black in indirect's. The shading has indirect light where that is shown.
Image screen_picture(const std::string& what, const GBuffer& buffer, const ScreenShading& shading,
                     const ScreenLight& light);

}  // namespace dfield::cli
