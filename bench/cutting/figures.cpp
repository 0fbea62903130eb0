// The paper's figures in kind: figures 1, 8, 9 and 11, and what cut surfaces look like without CAO.
#include "bench/cutting/pieces.hpp"
#include "bench/cutting/shapes.hpp"
#include "bench/cutting/stage.hpp"

namespace dfield::cutting {
namespace {

constexpr std::uint32_t kPixels = 300;

// A session with cutters at their places, and pictures of it.
class Cut {
  public:
    Cut(const Scene& scene, std::initializer_list<const Cutter*> cutters,
        std::uint32_t clip_samples = DFIELD_CLIP_SAMPLES)
        : scene_(scene), stage_(scene, 54, 0), session_(stage_.session(DFIELD_UPDATE_CHANGED, clip_samples)) {
        unclipped_.assign(session_.visibility(), session_.visibility() + stage_.voxels());
        for (const Cutter* cutter : cutters) {
            const ClipMesh mesh = stage_.mesh(*cutter);
            session_.add(stage_.clip(mesh, *cutter));
        }
        session_.update();
    }
    Image contextual(const Lab& lab, const Frame& frame) const {
        return draw(scene_, session_, {session_.visibility(), stage_.voxels()}, frame, lab);
    }
    Image of_the_whole(const Lab& lab, const Frame& frame) const {
        return draw(scene_, session_, unclipped_, frame, lab);
    }
    Image unshaded(const Lab& lab, const Frame& frame) const {
        return draw(scene_, session_, {}, frame, lab);
    }

  private:
    const Scene& scene_;
    Stage stage_;
    Contextual session_;
    std::vector<float> unclipped_;
};

// Around the first cutter.
Frame close_up(const Scene& scene) {
    const std::array<std::size_t, 3>& size = scene.volume.grid.size;
    const glm::dvec3 middle(0.5 * static_cast<double>(size[0]), 0.5 * static_cast<double>(size[1]),
                            0.5 * static_cast<double>(size[2]));
    return {.to_eye = scene.to_eye,
            .width = kPixels,
            .height = kPixels,
            .zoom = 2.5,
            .towards = scene.first.centre - middle};
}

Json save(const Lab& lab, const char* name, std::span<const Image> images,
          std::span<const std::string> names) {
    lab.page.save_picture(name, image_row(images, names));
    return {{"drawn", true}};
}

void link(const Json& figures, bench::Page& page, const char* name, const char* description,
          const char* what) {
    if (figures.empty()) return page.paragraph("**Its scan was not there: left out.**");
    page.link_picture(name, description);
    page.paragraph(what);
}

}  // namespace

Json draw_figure1(Lab& lab) {
    const volumes::Subject* head = lab.stock.shared("head");
    if (!head) return Json::object();
    const std::array<std::size_t, 3> from = head->volume.grid.size;
    std::array<std::size_t, 3> to = from;
    for (std::size_t& n : to) n *= 3;
    to[2] = to[2] * 15 / 32;  // slices are 1.5 apart, columns 3.2
    Scene scene{.name = "head",
                .volume = resampled(head->volume, {0, 0, 0}, from, to),
                .transfer = transfer_function(lab, "head"),
                .first = {.mesh = torus(0.3)},
                .second = {.mesh = cylinder(2)}};
    const glm::dvec3 extent(static_cast<double>(to[0]), static_cast<double>(to[1]),
                            static_cast<double>(to[2]));
    scene.first.centre = glm::dvec3(0.5, 0.5, 0.55) * extent;
    scene.first.scale = 0.42 * extent.x;
    scene.second.centre = glm::dvec3(0.62, 0.6, 0.12) * extent;
    scene.second.scale = 0.24 * extent.x;
    // Its slices run downwards.
    const Frame frame{.to_eye = {0.6f, 1, -0.8f}, .width = kPixels, .height = kPixels, .up = {0, 0, -1}};
    const std::array<Image, 2> images{Cut(scene, {&scene.first, &scene.second}).contextual(lab, frame),
                                      Cut(scene, {&scene.second}).contextual(lab, frame)};
    return save(lab, "cutting_figure1", images, std::array<std::string, 2>{"torus and cylinder", "cylinder"});
}

void write_figure1(const Json& all, bench::Page& page) {
    page.heading(3, "Figure 1: concave and convex clips");
    link(all["figure1"], page, "cutting_figure1", "A head cut by a torus and a cylinder",
         "A CT head of 64 × 64 × 93 voxels, resampled three times as fine, through `head.json`.");
}

Json draw_figure8(Lab& lab) {
    const std::optional<Scene> scene = make_scene(lab, "engine");
    if (!scene) return Json::object();
    Frame frame = close_up(*scene);
    frame.zoom = 6;
    const std::array<Image, 2> images{Cut(*scene, {&scene->first}, 0).contextual(lab, frame),
                                      Cut(*scene, {&scene->first}).contextual(lab, frame)};
    return save(lab, "cutting_figure8", images,
                std::array<std::string, 2>{"voxels' centres alone", "9 + 32 samples a voxel"});
}

void write_figure8(const Json& all, bench::Page& page) {
    page.heading(3, "Figure 8: anti-aliased clipping");
    link(all["figure8"], page, "cutting_figure8", "A cut surface without and with anti-aliased opacities",
         "The engine's cut surface; without anti-aliasing the steps of the voxels show in the factors.");
}

Json draw_figure9(Lab& lab) {
    std::vector<Image> whole, close;
    std::vector<std::string> names;
    for (const char* name : kSceneNames) {
        const std::optional<Scene> scene = make_scene(lab, name);
        if (!scene) continue;
        const Cut cut(*scene, {&scene->first});
        whole.push_back(cut.contextual(lab, {scene->to_eye, kPixels, kPixels}));
        close.push_back(cut.contextual(lab, close_up(*scene)));
        names.push_back(std::string(name) + ", " + scene->cutter_name);
    }
    if (whole.empty()) return Json::object();
    const std::array<Image, 2> rows{image_row(whole), image_row(close, names)};
    lab.page.save_picture("cutting_figure9", image_column(rows));
    return {{"drawn", true}};
}

void write_figure9(const Json& all, bench::Page& page) {
    page.heading(3, "Figure 9: the scenes");
    link(all["figure9"], page, "cutting_figure9", "The three scenes and close-ups of what was cut",
         "54 rays; the scenes of table 2.");
}

Json draw_figure11(Lab& lab) {
    const std::optional<Scene> scene = make_scene(lab, "engine");
    if (!scene) return Json::object();
    const Cut cut(*scene, {&scene->first, &scene->second});
    const std::array<Image, 2> images{cut.contextual(lab, {scene->to_eye, kPixels, kPixels}),
                                      cut.contextual(lab, close_up(*scene))};
    return save(lab, "cutting_figure11", images,
                std::array<std::string, 2>{"two spheres", "what they have in common"});
}

void write_figure11(const Json& all, bench::Page& page) {
    page.heading(3, "Figure 11: two clips");
    link(all["figure11"], page, "cutting_figure11", "The engine cut by two spheres that overlap",
         "The engine with the second mesh of table 4.");
}

Json draw_surfaces(Lab& lab) {
    std::vector<Image> rows;
    for (const char* name : {"engine", "beetle"}) {
        const std::optional<Scene> scene = make_scene(lab, name);
        if (!scene) continue;
        const Cut cut(*scene, {&scene->first});
        const Frame frame = close_up(*scene);
        const std::array<Image, 3> images{cut.contextual(lab, frame), cut.of_the_whole(lab, frame),
                                          cut.unshaded(lab, frame)};
        const std::array<std::string, 3> names{"contextual", "factors of the whole volume", "none"};
        rows.push_back(image_row(images, names));
    }
    if (rows.empty()) return Json::object();
    lab.page.save_picture("cutting_surfaces", image_column(rows));
    return {{"drawn", true}};
}

void write_surfaces(const Json& all, bench::Page& page) {
    page.heading(3, "Cut surfaces, and the common mistakes");
    link(all["surfaces"], page, "cutting_surfaces",
         "Cut surfaces with contextual factors, with those of the whole volume, and with none",
         "What other tools show at clip planes: factors of the volume before it was cut leave surfaces black "
         "that now lie open; none at all leave them without shape.");
}

}  // namespace dfield::cutting
