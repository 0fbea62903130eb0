// Figure 8: models of growing size.
#include <algorithm>
#include <array>
#include <limits>

#include "baker/cli/report.hpp"
#include "bench/paper/corner_picture.hpp"
#include "bench/paper/figures.hpp"

namespace dfield::paper {
namespace {

using cli::text;

struct PaperColumn {
    const char* model;
    std::uint32_t triangles;
    std::uint64_t rays;
    double ray_casting, preprocessing, ao;  // seconds
};
// Machine type 1, an Intel Pentium 4 at 3.4 GHz.
constexpr std::array<PaperColumn, 4> kPaper{{{"lemon tree", 26300, 836352, 196.20, 99.54, 0.240},
                                             {"bunny", 39000, 836352, 331.10, 54.79, 0.228},
                                             {"igea", 67200, 836352, 616.35, 243.76, 0.204},
                                             {"multiple objects", 142300, 26444800, 4286.8, 334.6, 4.692}}};

void write_paper_table(Page& page) {
    page.paragraph("The paper's own figures:");
    Table table({"model", "triangles", "rays", "ray casting, s", "bake, s", "AO by lookup, s", "speedup, ×"});
    for (const PaperColumn& column : kPaper)
        table.row({column.model, grouped(column.triangles), grouped(column.rays),
                   text("%.2f", column.ray_casting), text("%.2f", column.preprocessing),
                   text("%.3f", column.ao), text("%.0f", column.ray_casting / column.ao)});
    page.table(table);
}

void add_row(Table& table, const std::string& name, std::size_t triangles, const Duel& times,
             double bake_seconds, double rms) {
    table.row({name, grouped(triangles), grouped(times.rays), text("%.4f", times.embree_seconds),
               text("%.2f", bake_seconds), text("%.4f", times.lookup_seconds), text("%.2f", times.speedup()),
               text("%.2f", rms)});
}

}  // namespace

void write_figure8(Lab& lab, const Million& million, Page& page) {
    page.heading(2, "Figure 8: models");
    page.paragraph(
        maps_text(lab.parameters()) +
        ", 8 bits. All times are of one core. Ray casting is Embree's any-hit query against the caster alone "
        "in the fastest of seven modes, packets prepared beforehand, acceleration structure built "
        "beforehand. The lookup's time is the whole call, rays made from vertices included.");
    Table table(
        {"model", "triangles", "rays", "ray casting, s", "bake, s", "AO by lookup, s", "speedup, ×", "RMS"});
    std::vector<const Model*> models;
    for (const Model& model : lab.models()) models.push_back(&model);
    std::sort(models.begin(), models.end(), [](const Model* a, const Model* b) {
        return a->mesh.triangles.size() < b->mesh.triangles.size();
    });
    std::vector<Image> rows, images;
    std::vector<std::string> captions;
    double slowest = std::numeric_limits<double>::infinity();
    for (const Model* model : models) {
        const Baked& field = lab.baked(*model, lab.parameters());
        const Receivers& receivers = lab.receivers(*model, Room::kGap);
        const Directions& rays = lab.directions(Rays::kConcentric);
        const Duel times = duel(model->mesh, field.bytes, receivers, rays, lab.rounds(7));
        slowest = std::min(slowest, static_cast<double>(times.rays) / times.embree_seconds);
        Lookup lookup(field.bytes, receivers, rays);
        lookup.run();
        const double rms =
            errors_of(lookup.visibility(), lab.ray_cast(*model, Room::kGap, Rays::kConcentric)).rms;
        add_row(table, model->name, model->mesh.triangles.size(), times, field.seconds(), rms);
        images.push_back(
            corner_images(lab, *model, Room::kGap, Rays::kConcentric, lookup.visibility(), 220, 187)[1]);
        captions.push_back(model->name + text(": %.2f", rms));
        if (images.size() == 4 || model == models.back()) {
            rows.push_back(image_row(images, captions));
            images.clear();
            captions.clear();
        }
    }
    add_row(table, million.model->name + ", subdivided", million.triangles, million.duel,
            million.bake_seconds, million.rms);
    page.table(table);
    page.picture("figure8", image_column(rows), "Each model in its corner, by lookup, with its RMS");
    page.paragraph(
        "The last row is the surface of " + million.model->name + " (" +
        grouped(million.model->mesh.triangles.size()) +
        " triangles), every triangle cut into four by its edges' midpoints. Looked up in turns with the "
        "original, its ambient occlusion takes " +
        text("%.3f", million.lookup_ratio()) +
        " times as long: a lookup does not know how many triangles there were. Times differ between models "
        "with the number of rays that meet their bounding spheres.");
    write_paper_table(page);
    const double paper_rate = static_cast<double>(kPaper[1].rays) / kPaper[1].ray_casting;
    page.paragraph(
        text("Why the speedups are so different: the paper's own ray caster traces %.0f rays a second "
             "(bunny), "
             "Embree at least %.1f million on one core here. ",
             paper_rate, slowest * 1e-6) +
        "Against that a lookup gains with the triangles, and can lose against a handful of them. The paper's "
        "bunny, igea and tree are other, smaller meshes than those here.");
}

}  // namespace dfield::paper
