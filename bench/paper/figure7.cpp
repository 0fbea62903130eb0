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
        ". The paper's 1 bit, 64 x 64, has an RMS of 4.4030 and is slightly "
        "brighter than the 8-bit picture. Bias is lookup minus ray casting: positive is too bright.");
    const std::vector<float>& reference = lab.ray_cast(model, Room::kGap, Rays::kConcentric);
    Table table({"field", "bits", "RMS", "bias", "max", "in memory", "file"});
    std::vector<Image> images;
    double one_bit = 0;
    for (const std::uint32_t size : {64u, 32u})
        for (const std::uint32_t bits : {1u, 8u}) {
            const Baked& field = lab.baked(model, lab.parameters(32, size, bits));
            Lookup lookup(field.bytes, lab.receivers(model, Room::kGap), lab.directions(Rays::kConcentric));
            lookup.run();
            const Errors errors = errors_of(lookup.visibility(), reference);
            table.row({maps_text(field.parameters), std::to_string(bits), text("%.2f", errors.rms),
                       text("%+.2f", errors.bias), text("%.1f", errors.max),
                       bytes_text(lookup.memory_bytes()), bytes_text(field.bytes.size())});
            if (!images.empty()) continue;
            one_bit = errors.rms;
            for (const Image& image :
                 corner_images(lab, model, Room::kGap, Rays::kConcentric, lookup.visibility(), 400, 340))
                images.push_back(image);
        }
    page.table(table);
    const std::vector<std::string> captions{"ray casting",
                                            "1 bit, " + std::to_string(lab.parameters(32, 64).map_size) +
                                                " x " + std::to_string(lab.parameters(32, 64).map_size),
                                            text("difference x5, RMS %.2f", one_bit)};
    page.picture("figure7", image_row(images, captions), "Reference, 1-bit lookup, difference times five");
    page.paragraph(
        "Where an object lies wholly in front of a receiver's tangent plane, \"is anything on this line\" is "
        "the whole question and one bit answers it as well as a distance does; that is so for most of the "
        "room. The rest has the mean depth of a map to decide by, and is where 1 bit loses.");
}

}  // namespace dfield::paper
