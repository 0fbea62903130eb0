// The paper's figure 5 for a comparison: reference, lookup, and their difference times five.
#pragma once

#include <array>
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

// Reference, lookup and difference, without captions. The background is light, but not the white of an open
// receiver; objects other than rooms are shaded a little so that their form reads, but in the difference.
std::array<Image, 3> comparison_images(const std::vector<PictureObject>& objects, const Camera& camera,
                                       int threads, std::uint32_t width = 560, std::uint32_t height = 480);

// The same in a row, with speed and error below.
Image comparison_picture(const std::vector<PictureObject>& objects, const Camera& camera,
                         const Comparison& result, int threads, std::uint32_t width = 560,
                         std::uint32_t height = 480);

}  // namespace dfield::cli
