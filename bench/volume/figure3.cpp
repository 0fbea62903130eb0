// Figures 3 and 4: sweeping beside local shading and beside Monte Carlo.
#include <array>

#include "bench/common/turns.hpp"
#include "bench/volume/pieces.hpp"
#include "bench/volume/studio.hpp"

namespace dfield::volumes {
namespace {

using cli::text;

constexpr std::uint32_t kRays = 128;  // a sample; a pixel has four

dfield_sweep_desc with_gamma(dfield_sweep_desc desc) {
    desc.gamma = kGamma;
    return desc;
}

std::uint32_t rays(const Lab& lab) {
    return lab.stock.quick() ? 16 : kRays;
}

}  // namespace

Json draw_figure3(Lab& lab) {
    const std::uint32_t n = lab.stock.size(100);
    const Subject subject = slab_with_boxes(n);
    Studio studio(subject, {{0.45f, -1, 0.75f}, {0, 0, 1}, 270, 200}, lab.stock);
    const dfield_sweep_desc paper = studio.desc(DFIELD_FORM_PAPER),
                            improved = studio.desc(DFIELD_FORM_IMPROVED);
    Image truth;
    const double seconds_rays = bench::seconds_of([&] { truth = studio.by_rays(rays(lab), 1); });
    const Image by_paper = studio.swept(paper), by_improved = studio.swept(improved);
    const std::array<Image, 4> above{studio.local(), by_paper, by_improved, truth};
    const std::array<Image, 4> below{image_difference(by_improved, truth, 5), studio.swept(with_gamma(paper)),
                                     studio.swept(with_gamma(improved)), studio.by_rays(rays(lab), kGamma)};
    const std::array<std::string, 4> above_names{"local shading", "sweeping, paper's form",
                                                 "sweeping, improved form", "Monte Carlo"};
    const std::array<std::string, 4> below_names{"improved against Monte Carlo, difference x5",
                                                 "paper's form, gamma 2", "improved form, gamma 2",
                                                 "Monte Carlo, gamma 2"};
    const std::array<Image, 2> rows{image_row(above, above_names), image_row(below, below_names)};
    lab.page.save_picture("volume_figure3", image_column(rows));
    return {{"size", n},
            {"rays", rays(lab)},
            {"seconds_rays", seconds_rays},
            {"rms_paper", picture_rms(by_paper, truth)},
            {"rms_improved", picture_rms(by_improved, truth)}};
}

void write_figure3(const Json& all, bench::Page& page) {
    const Json& figures = all["figure3"];
    page.heading(3, "Figure 3: local shading, sweeping and Monte Carlo");
    page.link_picture("volume_figure3",
                      "A floor with boxes: local shading, both forms of sweeping, Monte Carlo; with gamma");
    page.paragraph(
        text("A slab with boxes on it, %u³. Against the "
             "picture by rays (%u a sample, four samples a pixel, %.0f s on all threads) the paper's form is "
             "off by %.1f "
             "grey levels RMS, the improved form by %.1f. As the paper says of its own: its form "
             "darkens flat walls, throws soft shadows along the diagonals, and lets edges glow; this "
             "is what the improved form mends.",
             figures["size"].get<unsigned>(), figures["rays"].get<unsigned>(),
             figures["seconds_rays"].get<double>(), figures["rms_paper"].get<double>(),
             figures["rms_improved"].get<double>()));
}

Json draw_figure4(Lab& lab) {
    const std::uint32_t n = lab.stock.size(192);
    const Subject subject = as_floats("clouds", models::clouds_volume({n, n, n}, 1));
    Studio studio(subject, {{0.5f, -1, 0.25f}, {0, 0, 1}, 270, 200}, lab.stock);
    const Image paper = studio.swept(with_gamma(studio.desc(DFIELD_FORM_PAPER))),
                improved = studio.swept(with_gamma(studio.desc(DFIELD_FORM_IMPROVED))),
                truth = studio.by_rays(rays(lab), kGamma);
    const std::array<Image, 4> images{studio.local(), paper, improved, truth};
    const std::array<std::string, 4> names{"local shading", "paper's form, gamma 2", "improved form, gamma 2",
                                           "Monte Carlo, gamma 2"};
    lab.page.save_picture("volume_figure4", image_row(images, names));
    return {{"size", n},
            {"rms_paper", picture_rms(paper, truth)},
            {"rms_improved", picture_rms(improved, truth)}};
}

void write_figure4(const Json& all, bench::Page& page) {
    const Json& figures = all["figure4"];
    page.heading(3, "Figure 4: a cloud");
    page.link_picture("volume_figure4", "A cloud: local shading, both forms of sweeping, Monte Carlo");
    page.paragraph(
        text("In place of the paper's thundercloud one that is made, %u³. RMS against the picture by "
             "rays: %.1f grey levels by the paper's form, %.1f by the improved one. On a surface "
             "without flat walls the paper's artefacts hardly show.",
             figures["size"].get<unsigned>(), figures["rms_paper"].get<double>(),
             figures["rms_improved"].get<double>()));
}

}  // namespace dfield::volumes
