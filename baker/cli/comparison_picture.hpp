// The paper's figure 5 for a comparison: reference, lookup, and their difference times five.
#pragma once

#include <vector>

#include "baker/cli/comparison.hpp"
#include "baker/picture/render.hpp"

namespace dfield::cli {

// One mesh of the picture. Those with receivers show their two sets of values; the others are shown the same
// twice.
struct PictureObject {
    const TriangleMesh* mesh = nullptr;
    glm::mat4 transform{1};
    std::vector<float> reference, lookup;  // per vertex, empty for an object that only casts
    bool room = false;                     // a wall: not drawn where it turns its back to the camera
};

Image comparison_picture(const std::vector<PictureObject>& objects, const Camera& camera,
                         const Comparison& result, int threads, std::uint32_t width = 560,
                         std::uint32_t height = 480);

}  // namespace dfield::cli
