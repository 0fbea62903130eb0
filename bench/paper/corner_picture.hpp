// Pictures of a model in its corner.
#pragma once

#include <array>

#include "baker/picture/image.hpp"
#include "baker/picture/render.hpp"
#include "bench/paper/lab.hpp"

namespace dfield::paper {

// The view of a room that all pictures share.
Camera corner_camera(const Bounds& room, std::uint32_t width, std::uint32_t height);

// Ray casting, the given visibility of the room, and their difference times five. The model itself shows its
// own occlusion. A quick() lab's pictures are smaller.
std::array<Image, 3> corner_images(Lab& lab, const Model& model, Room room, Rays rays,
                                   const std::vector<float>& visibility, std::uint32_t width,
                                   std::uint32_t height);

}  // namespace dfield::paper
