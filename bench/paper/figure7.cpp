// Figure 7: one bit a ray.
#include "baker/cli/report.hpp"
#include "baker/cli/terminal.hpp"
#include "bench/paper/corner_picture.hpp"
#include "bench/paper/figures.hpp"

namespace dfield::paper {

using cli::bytes_text;
using cli::text;

void write_figure7(Lab& lab, Page& page) {
    const Model& model = lab.subject();
    page.heading(2, "Figure 7: one bit a ray");
    page.paragraph(
        "The " + model.name +
        ". The paper's picture, of 4,226 maps of 64 × 64, has an RMS of 4.4030 and is slightly "
        "brighter than the one of 8 bits. Bias is lookup minus ray casting: positive is too bright. "
        "\"Any hit\" and \"by distance\" as under figure 4.");
    const float reach = lab.reach(model);
    const Receivers& receivers = lab.receivers(model, Room::kGap);
    const Directions& rays = lab.directions(Rays::kConcentric);
    Table table({"field", "bits", "RMS, any hit", "bias", "RMS, by distance", "bias", "in memory", "file"});
    std::vector<Image> images;
    std::vector<std::string> captions{"ray casting"};
    for (const std::uint32_t size : {64u, 32u})
        for (const std::uint32_t bits : {1u, 8u}) {
            const Baked& field = lab.baked(model, lab.parameters(32, size, bits));
            Lookup any(field.bytes, receivers, rays), far(field.bytes, receivers, rays, reach);
            any.run();
            far.run();
            const Errors any_errors =
                errors_of(any.visibility(), lab.ray_cast(model, Room::kGap, Rays::kConcentric));
            const Errors far_errors =
                errors_of(far.visibility(), lab.ray_cast(model, Room::kGap, Rays::kConcentric, reach));
            table.row({maps_text(field.parameters), std::to_string(bits), text("%.2f", any_errors.rms),
                       text("%+.2f", any_errors.bias), text("%.2f", far_errors.rms),
                       text("%+.2f", far_errors.bias), bytes_text(any.memory_bytes()),
                       bytes_text(field.bytes.size())});
            if (!images.empty()) continue;
            for (const Image& image :
                 corner_images(lab, model, Room::kGap, Rays::kConcentric, any.visibility(), 400, 340))
                images.push_back(image);
            captions.push_back(text("1 bit, %u x %u", field.parameters.map_size, field.parameters.map_size));
            captions.push_back(text("difference x5, RMS %.2f", any_errors.rms));
        }
    page.table(table);
    page.picture("figure7", image_row(images, captions), "Reference, 1-bit lookup, difference times five");
    page.paragraph(
        "Where the whole object lies in front of a receiver's tangent plane, as in this scene, \"is anything "
        "on this line\" is all that any-hit occlusion asks: 1 bit answers it as well as 8. The paper takes "
        "the "
        "mean depth of a map for the distance of every hit; where occlusion depends on the distance, that "
        "is what 1 bit costs.");
}

}  // namespace dfield::paper
