// The paper's figures 1, 7, 8 and 9 in kind.
#include <array>

#include "baker/cli/screen_picture.hpp"
#include "bench/screen/pieces.hpp"

namespace dfield::screens {
namespace {

using cli::text;

// One view of a scene, shaded once, shown in several ways.
class Studio {
  public:
    Studio(const Lab& lab, const cli::ScreenInput& input, dfield_screen_estimator estimator,
           float share_of_radius)
        : subject_(load_screen_subject(input, lab.common())),
          runner_(subject_, 0, {1, 1}),
          light_{{0.3f, 0.33f, 0.38f}, cli::vector_of(input.background)} {
        dfield_screen_desc desc = usual_desc(share_of_radius * subject_.default_radius());
        desc.estimator = estimator;
        shading_ = runner_.shade(desc, true, 1);
    }
    Image show(const char* what) const { return screen_picture(what, runner_.buffer(), shading_, light_); }

  private:
    cli::ScreenSubject subject_;
    cli::ScreenRunner runner_;
    cli::ScreenLight light_;
    cli::ScreenShading shading_;
};

cli::ScreenInput closer(cli::ScreenInput input, const std::array<float, 3>& eye,
                        const std::array<float, 3>& target, float fov) {
    input.eye = eye;
    input.target = target;
    input.fov = fov;
    return input;
}

}  // namespace

Json draw_figure1(const Lab& lab) {
    const Studio studio(
        lab, closer(lab.input("harbour.glb", "400x300"), {3.6f, 2.2f, 3.4f}, {0.9f, 0.5f, -1.9f}, 40),
        DFIELD_ESTIMATOR_DISK, 0.5f);
    const std::array<Image, 2> images{studio.show("classic"), studio.show("lit")};
    const std::array<std::string, 2> names{"local illumination", "occlusion and indirect light"};
    lab.page.save_picture("screen_figure1", image_row(images, names));
    return Json::object();
}

void write_figure1(const Json&, bench::Page& page) {
    page.heading(3, "Figure 1: local and indirect light");
    page.link_picture("screen_figure1",
                      "Crates on the quay: local illumination, and occlusion with indirect light");
    page.paragraph(
        "The sun, with shadows, and constant ambient light; the same with that light times visibility and "
        "with "
        "the light of the neighbourhood: shadows have a form, and colours bleed onto pale sides beside "
        "them.");
}

Json draw_figure7(const Lab& lab) {
    const Studio harbour(lab, lab.input("harbour.glb", "360x270"), DFIELD_ESTIMATOR_IMPORTANCE, 0.5f);
    const Studio room(lab, lab.input("scene_instances.glb", "360x270"), DFIELD_ESTIMATOR_IMPORTANCE, 1);
    std::array<Image, 3> rows;
    const std::array<std::pair<const char*, const char*>, 3> shows{
        {{"classic", "ambient light"}, {"ambient", "times visibility"}, {"lit", "and indirect light"}}};
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::array<Image, 2> pair{harbour.show(shows[i].first), room.show(shows[i].first)};
        const std::array<std::string, 2> names{shows[i].second, shows[i].second};
        rows[i] = image_row(pair, names);
    }
    lab.page.save_picture("screen_figure7", image_column(rows));
    return Json::object();
}

void write_figure7(const Json&, bench::Page& page) {
    page.heading(3, "Figure 7: ambient, occlusion, indirect light");
    page.link_picture("screen_figure7", "Two scenes: ambient light, times visibility, with indirect light");
    page.paragraph("Importance sampling, 16 samples, interleaved and filtered, as in the paper's figure.");
}

Json draw_figure8(const Lab& lab) {
    const Studio studio(lab, lab.input("scene_instances.glb", "480x360"), DFIELD_ESTIMATOR_TANGENT, 1);
    const std::array<Image, 1> images{studio.show("visibility")};
    lab.page.save_picture("screen_figure8", image_row(images));
    return Json::object();
}

void write_figure8(const Json&, bench::Page& page) {
    page.heading(3, "Figure 8: the tangent sphere");
    page.link_picture("screen_figure8", "Trees and cubes in a room, visibility");
    page.paragraph("Visibility by 16 samples in the tangent sphere, interleaved and filtered.");
}

Json draw_figure9(const Lab& lab) {
    const Studio studio(lab, lab.input("harbour.glb", "400x300"), DFIELD_ESTIMATOR_DISK, 0.5f);
    const std::array<Image, 2> images{studio.show("visibility"), studio.show("lit")};
    const std::array<std::string, 2> names{"visibility", "lit"};
    lab.page.save_picture("screen_figure9", image_row(images, names));
    return Json::object();
}

void write_figure9(const Json&, bench::Page& page) {
    page.heading(3, "Figure 9: the harbour");
    page.link_picture("screen_figure9", "The harbour: visibility, and lit");
    page.paragraph("The base disk, 16 samples, interleaved and filtered, R a twentieth of the scene.");
}

}  // namespace dfield::screens
