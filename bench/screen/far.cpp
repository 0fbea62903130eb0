// Displacement fields beyond the radius, screen space within it.
#include <array>

#include "baker/cli/screen_far.hpp"
#include "baker/cli/screen_picture.hpp"
#include "bench/screen/pieces.hpp"

namespace dfield::screens {
namespace {

using cli::text;

struct Case {
    const char* file;
    bool others;  // objects do not ask their own field
    float share;  // of the usual radius
};
constexpr std::array<Case, 6> kCases{{{"scene_instances.glb", false, 0.15f},
                                      {"scene_instances.glb", false, 0.5f},
                                      {"scene_instances.glb", true, 0.15f},
                                      {"harbour.glb", false, 0.05f},
                                      {"harbour.glb", true, 0.05f},
                                      {"harbour.glb", true, 0.2f}}};
constexpr std::size_t kPictured = 0;

}  // namespace

Json measure_far(const Lab& lab) {
    Json rows = Json::array();
    cli::FarOptions options;
    options.field = "auto";
    options.rays = lab.quick ? 36 : 100;
    if (lab.quick) options.parameters.subdivision = options.parameters.map_size = 8;
    options.no_cache = true;
    for (std::size_t i = 0; i < kCases.size(); ++i) {
        const Case& made = kCases[i];
        const cli::ScreenSubject subject = load_screen_subject(lab.input(made.file, "360x270"), lab.common());
        const cli::ScreenRunner runner(subject, 0, lab.references());
        dfield_screen_desc desc = usual_desc(made.share * subject.default_radius());
        desc.samples = 32;
        options.others = made.others;
        const cli::ScreenShading near = runner.shade(desc, false, 1);
        const cli::FarVisibility far = far_visibility(options, subject, runner, desc, lab.common());
        const std::vector<float> both = cli::combined(near.visibility, far.beyond);
        const RayReference truth = runner.by_rays(desc, false, true);
        std::vector<float> product(both.size());
        for (std::size_t k = 0; k < product.size(); ++k) product[k] = near.visibility[k] * far.all[k];
        const auto error = [&](const std::vector<float>& frame) {
            return cli::rms_grey(runner.at_pixels(frame), truth.sky);
        };
        rows.push_back({{"scene", made.file},
                        {"others", made.others},
                        {"radius", desc.radius},
                        {"screen", error(near.visibility)},
                        {"field", error(far.all)},
                        {"product", error(product)},
                        {"combined", error(both)}});
        if (i != kPictured) continue;
        const auto picture = [&](const std::vector<float>& frame) {
            return cli::screen_picture("visibility", runner.buffer(), {frame, {}, {}, 0}, {});
        };
        const std::array<Image, 4> images{picture(near.visibility), picture(far.all), picture(both),
                                          picture(runner.picture_by_rays(desc, 100, true))};
        const std::array<std::string, 4> names{"screen space", "fields", "both", "rays"};
        const std::array<Image, 2> halves{image_row(std::span(images).first(2), std::span(names).first(2)),
                                          image_row(std::span(images).last(2), std::span(names).last(2))};
        lab.page.save_picture("screen_far", image_column(halves));
    }
    return {{"rays", options.rays}, {"rows", rows}};
}

void write_far(const Json& figures, bench::Page& page) {
    page.heading(3, "With displacement fields");
    page.link_picture("screen_far", "A room: screen space, displacement fields, both, rays");
    page.paragraph(text(
        "Every mesh's displacement maps, looked up by %u rays a pixel, occluders at any distance. A surface "
        "at "
        "distance D counts 1 - mu(D) in screen space and mu(D) in the fields, so every occluder counts once; "
        "the product of both counts those within R twice. Pixels ask their own object's field too, or only "
        "those of others. RMS against rays, grey levels:",
        figures["rays"].get<unsigned>()));
    bench::Table table(
        {"scene", "fields asked", "R", "screen space alone", "fields alone", "product", "both"});
    for (const Json& row : figures["rows"]) {
        const auto grey = [&](const char* name) { return text("%.1f", row[name].get<double>()); };
        table.row({row["scene"].get<std::string>(), row["others"].get<bool>() ? "others'" : "all",
                   text("%.2g", row["radius"].get<double>()), grey("screen"), grey("field"), grey("product"),
                   grey("combined")});
    }
    page.table(table);
    page.paragraph(
        "An object's own field, asked from its surface, knows what is far and errs where it is near: "
        "weighted by "
        "mu, with screen space for the rest, it becomes usable, which is what trees in a room need. Where "
        "objects "
        "are convex, as in the harbour, others' fields alone are already better than what the halos of "
        "screen space "
        "leave: there R should be no larger than the contacts that fields blur.");
}

}  // namespace dfield::screens
