// Figures 5 to 7: vessels, the geometry term, a cloudy day.
#include <algorithm>
#include <array>

#include "bench/volume/pieces.hpp"
#include "bench/volume/studio.hpp"

namespace dfield::volumes {
namespace {

using cli::text;

constexpr std::uint32_t kUpperOctants = 0xf0;  // those with directions of positive z

dfield_sweep_desc with_gamma(dfield_sweep_desc desc) {
    desc.gamma = kGamma;
    return desc;
}

}  // namespace

Json draw_figure5(Lab& lab) {
    const std::uint32_t n = lab.stock.size(256);
    const Subject subject = tangled_vessels(n);
    Studio studio(subject, {{0.25f, -1, 0.35f}, {0, 0, 1}, 360, 360}, lab.stock);
    const std::array<Image, 3> images{studio.local(),
                                      studio.swept(with_gamma(studio.desc(DFIELD_FORM_PAPER))),
                                      studio.swept(with_gamma(studio.desc(DFIELD_FORM_IMPROVED)))};
    const std::array<std::string, 3> names{"local shading", "paper's form, gamma 2",
                                           "improved form, gamma 2"};
    lab.page.save_picture("volume_figure5", image_row(images, names));
    std::size_t inside = 0;
    for (const float value : subject.volume.voxels<float>()) inside += value >= 0;
    return {{"size", n},
            {"inside_percent",
             100 * static_cast<double>(inside) / static_cast<double>(subject.volume.grid.voxels())}};
}

void write_figure5(const Json& all, bench::Page& page) {
    const Json& figures = all["figure5"];
    page.heading(3, "Figure 5: vessels");
    page.link_picture("volume_figure5", "Vessels: local shading, and sweeping in both forms");
    page.paragraph(
        text("In place of the paper's capillaries a tree of vessels that is made, %u³, %.1f%% of the "
             "voxels inside. With local shading all vessels are equally bright, whatever lies in front "
             "of them; with occlusion those within the tangle are darker.",
             figures["size"].get<unsigned>(), figures["inside_percent"].get<double>()));
}

Json draw_figure6(Lab& lab) {
    const Subject* engine = lab.stock.shared("engine");
    if (!engine) return Json::object();
    Studio studio(*engine, {{0.7f, -1, 0.8f}, {0, 0, 1}, 360, 320}, lab.stock);
    // Half of the sky is the most that a flat wall sees: twice the octants' mean, as bright as with the term.
    dfield_sweep_desc combined = studio.desc(DFIELD_FORM_COMBINED);
    std::fill(std::begin(combined.intensities), std::end(combined.intensities), 2.0f);
    const std::array<Image, 3> images{studio.local(), studio.swept(studio.desc(DFIELD_FORM_PAPER)),
                                      studio.swept(combined)};
    const std::array<std::string, 3> names{"local shading", "with the geometry term",
                                           "without it (combined)"};
    lab.page.save_picture("volume_figure6", image_row(images, names));
    return {{"isovalue", engine->isovalue},
            {"mean_with", picture_mean(images[1])},
            {"mean_without", picture_mean(images[2])}};
}

void write_figure6(const Json& all, bench::Page& page) {
    const Json& figures = all["figure6"];
    page.heading(3, "Figure 6: without the geometry term");
    if (figures.empty()) return page.paragraph("**The engine was not there: figure 6 is left out.**");
    page.link_picture("volume_figure6", "The engine: local shading, with and without the geometry term");
    page.paragraph(
        text("The engine, 256 × 256 × 128, isovalue %g, paper's form, mean grey %.0f with and %.0f "
             "without the term. Without it the mean of the eight octants is all that is kept: a "
             "surface's own half of the sky counts too, so that open faces are grey, and edges and "
             "corners, which hide less of it, stand out.",
             figures["isovalue"].get<double>(), figures["mean_with"].get<double>(),
             figures["mean_without"].get<double>()));
}

Json draw_figure7(Lab& lab) {
    const Subject* bonsai = lab.stock.shared("bonsai");
    if (!bonsai) return Json::object();
    const Subject subject = padded(*bonsai, kAir);
    Studio studio(subject, {{0.3f, -1, 0.35f}, {0, 0, 1}, 360, 360}, lab.stock);
    dfield_sweep_desc cloudy = studio.desc(DFIELD_FORM_PAPER);
    cloudy.octants = kUpperOctants;
    const std::array<Image, 3> images{studio.swept(studio.desc(DFIELD_FORM_PAPER)), studio.swept(cloudy),
                                      studio.swept(with_gamma(cloudy))};
    const std::array<std::string, 3> names{"all octants", "the upper four", "the upper four, gamma 2"};
    lab.page.save_picture("volume_figure7", image_row(images, names));
    return {{"isovalue", bonsai->isovalue}};
}

void write_figure7(const Json& all, bench::Page& page) {
    const Json& figures = all["figure7"];
    page.heading(3, "Figure 7: a cloudy day");
    if (figures.empty()) return page.paragraph("**The bonsai was not there: figure 7 is left out.**");
    page.link_picture("volume_figure7", "The bonsai lit by all octants and by the upper four");
    page.paragraph(
        text("The bonsai, isovalue %g, paper's form. With the upper four octants light comes from above "
             "alone: what faces sideways gets half of it, what faces down none.",
             figures["isovalue"].get<double>()));
}

}  // namespace dfield::volumes
