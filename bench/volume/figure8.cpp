// Figures 8 to 10: shadows of one octant and of any light, light that shines through.
#include <array>
#include <cmath>

#include "bench/volume/pieces.hpp"
#include "bench/volume/studio.hpp"

namespace dfield::volumes {
namespace {

using cli::text;

// V G / pi of an octant that is open, on a surface that faces it: G = sqrt(3) pi / 4.
const float kOctantGain = 4 / std::sqrt(3.0f);

// One octant's light alone.
dfield_sweep_desc only(dfield_sweep_desc desc, unsigned octant) {
    desc.octants = 1u << octant;
    return desc;
}

glm::vec3 diagonal(unsigned octant) {
    return {octant & 1 ? 1 : -1, octant & 2 ? 1 : -1, octant & 4 ? 1 : -1};
}

}  // namespace

Json draw_figure8(Lab& lab) {
    const std::uint32_t n = lab.stock.size(100);
    const Subject subject = slab_with_boxes(n);
    Studio studio(subject, {{0.1f, -1, 0.9f}, {0, 0, 1}, 360, 270}, lab.stock);
    constexpr unsigned kOctant = 4;  // from the left, the front and above
    const glm::vec3 low(0.9f, -0.35f, 0.55f);
    const std::array<Image, 2> above{
        studio.hard_shadows(diagonal(kOctant)),
        studio.soft_shadows(only(studio.desc(DFIELD_FORM_PAPER), kOctant), kOctantGain)};
    const std::array<Image, 2> below{studio.hard_shadows(low),
                                     studio.soft_shadows_of_light(studio.desc(DFIELD_FORM_IMPROVED), low)};
    const std::array<std::string, 2> above_names{"hard shadows, light along octant 4's diagonal",
                                                 "octant 4 alone, paper's form"};
    const std::array<std::string, 2> below_names{"hard shadows, light elsewhere",
                                                 "grid turned to it, improved form"};
    const std::array<Image, 2> rows{image_row(above, above_names), image_row(below, below_names)};
    lab.page.save_picture("volume_figure8", image_column(rows));
    return {{"size", n}};
}

void write_figure8(const Json& all, bench::Page& page) {
    page.heading(3, "Figure 8: low-frequency shadows");
    page.link_picture("volume_figure8",
                      "Hard shadows and those of one octant; the same for a light elsewhere");
    page.paragraph(
        text("The floor with boxes, %u³, over the same ambient part of a quarter. Above, one of the "
             "eight octants is the light; below, the grid is turned until an octant points at a light "
             "that is given. ",
             all["figure8"]["size"].get<unsigned>()));
}

Json draw_figure9(Lab& lab) {
    const std::uint32_t n = lab.stock.size(256);
    const Subject subject = tangled_vessels(n);
    Studio studio(subject, {{0.25f, -1, 0.35f}, {0, 0, 1}, 360, 360}, lab.stock);
    constexpr unsigned kOctant = 4;
    const std::array<Image, 2> images{
        studio.hard_shadows(diagonal(kOctant)),
        studio.soft_shadows(only(studio.desc(DFIELD_FORM_PAPER), kOctant), kOctantGain)};
    const std::array<std::string, 2> names{"hard shadows", "octant 4 alone, paper's form"};
    lab.page.save_picture("volume_figure9", image_row(images, names));
    return {{"size", n}};
}

void write_figure9(const Json& all, bench::Page& page) {
    page.heading(3, "Figure 9: shadows among vessels");
    page.link_picture("volume_figure9", "Vessels with hard shadows and with those of one octant");
    page.paragraph(
        text("The vessels of figure 5, %u³, lit from the left, the front and above. Hard shadows cut the "
             "vessels into pieces that are none of theirs; the octant's do not.",
             all["figure9"]["size"].get<unsigned>()));
}

Json draw_figure10(Lab& lab) {
    const Subject* bonsai = lab.stock.shared("bonsai");
    if (!bonsai) return Json::object();
    const Subject subject = padded(*bonsai, kAir);
    Studio studio(subject, {{0.3f, -1, 0.35f}, {0, 0, 1}, 270, 270}, lab.stock);
    std::vector<Image> images;
    std::vector<std::string> names;
    for (const float alpha : {1.0f, 0.3f, 0.1f, 0.03f}) {
        dfield_sweep_desc desc = studio.desc(DFIELD_FORM_PAPER);
        desc.alpha = alpha;
        desc.through = 1;
        desc.gamma = kGamma;
        images.push_back(studio.swept(desc));
        names.push_back(text("alpha %.2f", static_cast<double>(alpha)));
    }
    lab.page.save_picture("volume_figure10", image_row(images, names));
    return {{"isovalue", bonsai->isovalue}};
}

void write_figure10(const Json& all, bench::Page& page) {
    const Json& figures = all["figure10"];
    page.heading(3, "Figure 10: subsurface scattering");
    if (figures.empty()) return page.paragraph("**The bonsai was not there: figure 10 is left out.**");
    page.link_picture("volume_figure10", "Light that shines through, by opacity");
    page.paragraph(
        text("The bonsai, isovalue %g, paper's form with equation 8 and |N·ω|. The less opaque the "
             "matter, the brighter its thin parts: the leaves long before the pot.",
             figures["isovalue"].get<double>()));
}

}  // namespace dfield::volumes
