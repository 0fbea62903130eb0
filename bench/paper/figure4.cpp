// Figure 4: does a byte a ray do?
#include "baker/cli/report.hpp"
#include "baker/cli/terminal.hpp"
#include "bench/paper/figures.hpp"

namespace dfield::paper {

using cli::bytes_text;
using cli::text;

void write_figure4(Lab& lab, Page& page) {
    const Model& model = lab.subject();
    page.heading(2, "Figure 4: 32-bit floats against 8 bits");
    page.paragraph(
        "The " + model.name + ", " + maps_text(lab.parameters()) +
        ". \"Any hit\": every hit occludes fully, as in all other tables. \"By distance\": V of the "
        "paper's integral rises linearly with a hit's distance, to 1 at the room's side. "
        "\"To floats\" is the RMS between the room lit with this field and with floats.");
    const float reach = lab.reach(model);
    const Receivers& receivers = lab.receivers(model, Room::kGap);
    const Directions& rays = lab.directions(Rays::kConcentric);
    Table table(
        {"bits a ray", "RMS, any hit", "to floats", "RMS, by distance", "to floats", "in memory", "file"});
    std::vector<float> any_floats, far_floats;
    for (const std::uint32_t bits : {32u, 16u, 8u}) {
        const Baked& field = lab.baked(model, lab.parameters(32, 32, bits));
        Lookup any(field.bytes, receivers, rays), far(field.bytes, receivers, rays, reach);
        any.run();
        far.run();
        if (bits == 32) any_floats = any.visibility(), far_floats = far.visibility();
        const auto rms = [](const std::vector<float>& visibility, const std::vector<float>& reference) {
            return text("%.3f", errors_of(visibility, reference).rms);
        };
        table.row({std::to_string(bits),
                   rms(any.visibility(), lab.ray_cast(model, Room::kGap, Rays::kConcentric)),
                   rms(any.visibility(), any_floats),
                   rms(far.visibility(), lab.ray_cast(model, Room::kGap, Rays::kConcentric, reach)),
                   rms(far.visibility(), far_floats), bytes_text(any.memory_bytes()),
                   bytes_text(field.bytes.size())});
    }
    page.table(table);
    page.paragraph(
        "As in the paper, a byte is enough. For any-hit occlusion this scene needs no distance at all: each "
        "plane has the whole object in front of it, so that nothing on a ray's line lies behind its origin.");
}

}  // namespace dfield::paper
