#include "baker/cli/comparison_picture.hpp"

#include "baker/cli/runtime_scene.hpp"

namespace dfield::cli {

std::array<Image, 3> comparison_images(const std::vector<PictureObject>& objects, const Camera& camera,
                                       int threads, std::uint32_t width, std::uint32_t height) {
    RenderOptions options;
    options.background = {0.86f, 0.90f, 0.95f};
    options.width = width;
    options.height = height;
    options.threads = threads;
    const auto picture = [&](bool lookup, bool shaded) {
        std::vector<RenderObject> drawn;
        for (const PictureObject& object : objects) {
            if (!casts(*object.mesh, object.transform)) continue;  // nothing to see either
            RenderObject& entry = drawn.emplace_back();
            entry.mesh = object.mesh;
            entry.transform = object.transform;
            entry.visibility = lookup ? object.lookup : object.reference;
            entry.cull_back = object.room;
            entry.shade = shaded && !object.room;
        }
        return render(drawn, camera, options);
    };
    return {picture(false, true), picture(true, true),
            image_difference(picture(false, false), picture(true, false), 5)};
}

Image comparison_picture(const std::vector<PictureObject>& objects, const Camera& camera,
                         const Comparison& result, int threads, std::uint32_t width, std::uint32_t height) {
    const std::array<Image, 3> images = comparison_images(objects, camera, threads, width, height);
    const std::array<std::string, 3> captions{
        text("ray casting, %.1f Mray/s", result.embree_mrays_per_s),
        text("displacement field, %.1f Mray/s", result.lookup_mrays_per_s),
        text("difference x5, RMS %.2f of 255", result.rms_grey)};
    return image_row(images, captions);
}

}  // namespace dfield::cli
