// Displacement fields beyond the radius, screen space within it.
#include <array>

#include "baker/cli/screen_far.hpp"
#include "baker/cli/screen_picture.hpp"
#include "bench/screen/pieces.hpp"

namespace dfield::screens {
namespace {

using cli::text;

// Shares of the usual radius.
constexpr std::array<float, 3> kRadii{0.25f, 0.5f, 1};

}  // namespace

Json measure_far(const Lab& lab) {
    const cli::ScreenInput input = lab.input("scene_instances.glb", "360x270");
    const cli::ScreenSubject subject = load_screen_subject(input, lab.common());
    const cli::ScreenRunner runner(subject, 0, lab.references());
    cli::FarOptions options;
    options.field = "auto";
    options.rays = lab.quick ? 64 : 256;
    options.no_cache = true;
    Json rows = Json::array();
    for (const float share : kRadii) {
        dfield_screen_desc desc = usual_desc(share * subject.default_radius());
        desc.samples = 32;
        const cli::ScreenShading near = runner.shade(desc, false, 1);
        const cli::FarVisibility far = far_visibility(options, subject, runner, desc, lab.common());
        const std::vector<float> both = cli::combined(near.visibility, far.beyond);
        const RayReference truth = runner.by_rays(desc, false, true);
        std::vector<float> product(both.size());
        for (std::size_t i = 0; i < product.size(); ++i) product[i] = near.visibility[i] * far.all[i];
        const auto error = [&](const std::vector<float>& frame) {
            return cli::rms_grey(runner.at_pixels(frame), truth.sky);
        };
        rows.push_back({{"radius", desc.radius},
                        {"screen", error(near.visibility)},
                        {"field", error(far.all)},
                        {"product", error(product)},
                        {"combined", error(both)}});
        if (share != kRadii.back()) continue;
        const auto picture = [&](const std::vector<float>& frame) {
            return screen_picture("visibility", runner.buffer(), {frame, {}, {}, 0}, {});
        };
        const std::array<Image, 4> images{picture(near.visibility), picture(far.all), picture(both),
                                          picture(runner.picture_by_rays(desc, 256, true))};
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
        "The room with trees and cubes, every mesh's displacement maps looked up by %u rays a pixel, its own "
        "included, occluders at any distance. A surface at distance D counts 1 - mu(D) in screen space and "
        "mu(D) in the fields, so every occluder counts once; the product of both counts those within R "
        "twice. Against rays:",
        figures["rays"].get<unsigned>()));
    bench::Table table({"R, RMS in grey levels", "screen space alone", "fields alone", "product", "both"});
    for (const Json& row : figures["rows"]) {
        const auto grey = [&](const char* name) { return text("%.1f", row[name].get<double>()); };
        table.row({text("%.2g", row["radius"].get<double>()), grey("screen"), grey("field"), grey("product"),
                   grey("combined")});
    }
    page.table(table);
}

}  // namespace dfield::screens
