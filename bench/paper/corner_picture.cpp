#include "bench/paper/corner_picture.hpp"

#include "baker/cli/comparison_picture.hpp"

namespace dfield::paper {

Camera corner_camera(const Bounds& room, std::uint32_t width, std::uint32_t height) {
    return frame_bounds(room, {1, 0.8f, 1.1f}, {0, 1, 0}, 30,
                        static_cast<float>(width) / static_cast<float>(height));
}

std::array<Image, 3> corner_images(Lab& lab, const Model& model, Room room, Rays rays,
                                   const std::vector<float>& visibility, std::uint32_t width,
                                   std::uint32_t height) {
    width = lab.pixels(width), height = lab.pixels(height);
    const TriangleMesh& planes = lab.room(model, room);
    const std::vector<float>& self = lab.self_visibility(model);
    const std::vector<cli::PictureObject> objects{
        {&planes, glm::mat4(1), lab.ray_cast(model, room, rays), visibility, true},
        {&model.mesh, glm::mat4(1), self, self, false}};
    return cli::comparison_images(objects, corner_camera(triangle_bounds(planes), width, height), 0, width,
                                  height);
}

}  // namespace dfield::paper
