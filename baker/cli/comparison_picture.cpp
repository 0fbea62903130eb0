#include "baker/cli/comparison_picture.hpp"

#include <array>

namespace dfield::cli {

Image comparison_picture(const std::vector<PictureObject>& objects, const Camera& camera,
                         const Comparison& result, int threads, std::uint32_t width, std::uint32_t height) {
    RenderOptions options;
    options.width = width;
    options.height = height;
    options.threads = threads;
    const auto picture = [&](bool lookup) {
        std::vector<RenderObject> drawn;
        for (const PictureObject& object : objects) {
            RenderObject& entry = drawn.emplace_back();
            entry.mesh = object.mesh;
            entry.transform = object.transform;
            entry.visibility = lookup ? object.lookup : object.reference;
            entry.cull_back = object.room;
            entry.shade = entry.visibility.empty();
        }
        return render(drawn, camera, options);
    };
    const Image reference = picture(false), lookup = picture(true);
    const std::array<Image, 3> images{reference, lookup, image_difference(reference, lookup, 5)};
    const std::array<std::string, 3> captions{
        text("ray casting, %.1f Mray/s", result.embree_mrays_per_s),
        text("displacement field, %.1f Mray/s", result.lookup_mrays_per_s),
        text("difference x5, RMS %.2f of 255", result.rms_grey)};
    return image_row(images, captions);
}

}  // namespace dfield::cli
