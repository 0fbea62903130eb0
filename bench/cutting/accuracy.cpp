// Tables 5 and 6 and figure 12: how many rays it takes.
#include <algorithm>

#include "bench/cutting/pieces.hpp"
#include "bench/cutting/ray_sets.hpp"
#include "bench/cutting/stage.hpp"

namespace dfield::cutting {
namespace {

double rms_of_pictures(const Image& a, const Image& b) {
    const std::vector<float> x(a.rgb.begin(), a.rgb.end()), y(b.rgb.begin(), b.rgb.end());
    return rms(x, y);
}

// The factors of the clipped scene, and the picture that they make.
struct Result {
    std::vector<float> visibility;
    Image picture;
};
Result result_of(const Lab& lab, const Scene& scene, const cli::LocalOptions& options, bool drawn) {
    const Stage stage(scene, options, 0);
    Contextual session = stage.session();
    const ClipMesh mesh = stage.mesh(scene.first);
    session.add(stage.clip(mesh, scene.first));
    session.update();
    Result result{{session.visibility(), session.visibility() + stage.voxels()}, {}};
    // As they are: a gain would be one of the errors too.
    const Frame frame{.to_eye = scene.to_eye, .width = 320, .height = 320, .gain = 1};
    if (drawn) result.picture = draw(scene, session, result.visibility, frame, lab);
    return result;
}

// Grey: the mean difference of a pixel's components, white 0, black a fifth of the range.
Image error_picture(const Image& a, const Image& b) {
    Image image = image_difference(a, b, 5);
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
        const int mean = (image.rgb[i] + image.rgb[i + 1] + image.rgb[i + 2]) / 3;
        std::fill_n(image.rgb.begin() + static_cast<std::ptrdiff_t>(i), 3,
                    static_cast<std::uint8_t>(255 - mean));
    }
    return image;
}

Json accuracy_of(Lab& lab, const Scene& scene) {
    const Result truth = result_of(lab, scene, options_of(scene, kTruth), true);
    Json figures{{"size", size_text(scene.volume.grid.size)}, {"samples", scene.samples}};
    std::vector<Image> errors;
    for (const std::uint32_t rays : kRays) {
        Json row;
        const Result paper = result_of(lab, scene, options_of(scene, rays), true);
        row["paper_set"] = rms(paper.visibility, truth.visibility);
        row["picture"] = rms_of_pictures(paper.picture, truth.picture);
        if (scene.name == "engine" && (rays == 6 || rays == 54))
            errors.push_back(error_picture(paper.picture, truth.picture));
        cli::LocalOptions weighted = options_of(scene, rays), fibonacci = options_of(scene, rays);
        weighted.weights = better_weights(rays);
        fibonacci.fibonacci = true;
        row["weighted"] = rms(result_of(lab, scene, weighted, false).visibility, truth.visibility);
        row["fibonacci"] = rms(result_of(lab, scene, fibonacci, false).visibility, truth.visibility);
        figures["rays"][std::to_string(rays)] = row;
    }
    if (!errors.empty()) {
        const std::array<std::string, 2> names{"6 rays", "54 rays"};
        lab.page.save_picture("cutting_figure12", image_row(errors, names));
    }
    return figures;
}

struct PaperRow {
    const char* scene;
    std::array<double, 4> voxels, pixels;
};
constexpr std::array<PaperRow, 3> kPaper{
    {{"engine", {0.03907, 0.01203, 9.759e-3, 6.937e-3}, {11.771, 2.755, 1.936, 1.032}},
     {"beetle", {0.01746, 8.765e-3, 5.144e-3, 3.438e-3}, {4.485, 1.950, 1.072, 0.848}},
     {"skeleton", {0.02520, 0.01205, 7.910e-3, 5.208e-3}, {5.292, 1.603, 1.134, 0.956}}}};

}  // namespace

Json measure_accuracy(Lab& lab) {
    Json figures = Json::object();
    for (const char* name : kSceneNames) {
        const std::optional<Scene> scene = make_scene(lab, name);
        if (!scene) continue;
        const Json found = accuracy_of(lab, *scene);
        figures["scenes"][name] = found;
        for (const auto& [rays, row] : found["rays"].items()) {
            Json& worst = figures["worst"][rays];
            worst = std::max(worst.is_null() ? 0.0 : worst.get<double>(), row["paper_set"].get<double>());
            const double better = std::min(row["weighted"].get<double>(), row["fibonacci"].get<double>()) /
                                  row["paper_set"].get<double>();
            Json& gain = figures["better"][rays];
            gain = std::max(gain.is_null() ? 0.0 : gain.get<double>(), better);
        }
    }
    return figures;
}

void write_accuracy(const Json& all, bench::Page& page) {
    page.heading(3, "Tables 5 and 6: how many rays");
    const Json& figures = all["accuracy"];
    if (figures.empty()) return page.paragraph("**No scan was there: tables 5 and 6 are left out.**");
    page.paragraph(text(
        "RMS differences to %u spherical Fibonacci rays, the clipped scenes of table 2: of all voxels' "
        "factors (0 to 1), and of the pictures' colours (0 to 255), 320 × 320 pixels. Weighted: the "
        "paper's directions with Lebedev's weights (14, 26) or the solid angles of the stickers (54). The "
        "paper's volumes, functions and jitter are not these; table by voxels without jitter, which has its "
        "own below.",
        kTruth));
    bench::Table table(
        {"scene", "rays", "voxels", "weighted", "Fibonacci", "paper: voxels", "pixels", "paper: pixels"});
    for (const PaperRow& paper : kPaper) {
        if (!figures["scenes"].contains(paper.scene)) continue;
        for (std::size_t i = 0; i < kRays.size(); ++i) {
            const Json& row = figures["scenes"][paper.scene]["rays"][std::to_string(kRays[i])];
            table.row({paper.scene, std::to_string(kRays[i]), text("%.5f", row["paper_set"].get<double>()),
                       text("%.5f", row["weighted"].get<double>()),
                       text("%.5f", row["fibonacci"].get<double>()), text("%.5f", paper.voxels[i]),
                       text("%.3f", row["picture"].get<double>()), text("%.3f", paper.pixels[i])});
        }
    }
    page.table(table);
    page.heading(3, "Figure 12: where the errors are");
    page.link_picture("cutting_figure12", "Errors of pictures made with 6 and with 54 rays");
    page.paragraph(text(
        "The engine's picture with 6 and with 54 rays against %u: white is equal, black a fifth of the range "
        "or more.",
        kTruth));
}

}  // namespace dfield::cutting
