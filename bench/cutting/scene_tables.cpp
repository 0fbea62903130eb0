// Tables 2, 3 and 4, figure 10's break-down and memory, of the scenes that were measured.
#include <map>

#include "bench/cutting/pieces.hpp"
#include "bench/cutting/scenes.hpp"

namespace dfield::cutting {
namespace {

// The paper's: a Radeon RX 6700 XT. Seconds are 1 over frames a second, rendering included.
struct PaperRow {
    double lao_fps, cao_fps, slowdown;
};
const std::map<std::string, std::map<std::string, PaperRow>> kPaper{{"engine",
                                                                     {{"6", {111.549, 184.902, 14.3}},
                                                                      {"14", {67.910, 155.245, 14.6}},
                                                                      {"26", {42.831, 126.378, 15.3}},
                                                                      {"54", {22.543, 85.363, 15.7}}}},
                                                                    {"beetle",
                                                                     {{"6", {15.497, 42.581, 11.5}},
                                                                      {"14", {7.509, 25.581, 9.7}},
                                                                      {"26", {4.192, 16.063, 11.9}},
                                                                      {"54", {2.012, 8.526, 12.2}}}},
                                                                    {"skeleton",
                                                                     {{"6", {4.316, 17.514, 10.3}},
                                                                      {"14", {2.020, 9.594, 8.3}},
                                                                      {"26", {1.107, 5.729, 9.7}},
                                                                      {"54", {0.529, 2.825, 10.5}}}}};
constexpr std::array kRays{"6", "14", "26", "54"};

using Scenes = std::vector<std::pair<std::string, Json>>;
Scenes scenes_of(const Json& all) {
    Scenes scenes;
    for (const char* name : kSceneNames)
        if (all.contains(name) && !all[name].empty()) scenes.emplace_back(name, all[name]);
    return scenes;
}

double number(const Json& json, const char* key) {
    return json[key].get<double>();
}

std::string size_of(const Json& size) {
    return text("%u × %u × %u", size[0].get<unsigned>(), size[1].get<unsigned>(), size[2].get<unsigned>());
}

void write_table2(const Scenes& scenes, bench::Page& page) {
    page.heading(3, "Table 2: the scenes");
    bench::Table table({"scene", "voxels", "made of", "transfer function", "M", "clipping mesh", "dilated",
                        "paper: dilated", "computed anew here"});
    for (const auto& [name, scene] : scenes)
        table.row({name, size_of(scene["size"]), scene["made_of"], scene["transfer"],
                   text("%u", scene["samples"].get<unsigned>()), scene["cutter"],
                   text("%.2f%%", number(scene, "dilated")), text("%.2f%%", number(scene, "asked_dilated")),
                   text("%.2f%%", number(scene["rays"]["54"], "recomputed"))});
    page.table(table);
    page.paragraph(
        "Of the paper's scans the engine alone was at hand. Meshes are as large as makes the paper's mask, "
        "its "
        "dilation maps without what is clipped away, cover the paper's share of the voxels; \"computed "
        "anew\" "
        "is what our own mask covers, in blocks of 16 × 4 × 2: where rays meet matter that the mesh took "
        "away. "
        "In every scene the factors were compared with LAO of the clipped volume from scratch, 54 rays, bit "
        "for "
        "bit.");
    for (const auto& [name, scene] : scenes)
        if (!scene["identical"].get<bool>()) page.paragraph("**" + name + ": they differ.**");
}

void write_table3(const Scenes& scenes, bench::Page& page) {
    page.heading(3, "Table 3: seconds a frame");
    page.paragraph(
        "One core, no rendering. LAO: all of the volume. CAO: the mesh appears in the whole volume, so that "
        "all "
        "that it has an effect on is computed, as in the paper in every frame. The paper's columns are a "
        "GPU's, with its rendering. G samples count K (M - 1) a voxel, taken or skipped.");
    bench::Table table({"scene", "rays", "LAO, s", "G samples/s", "CAO, s", "of it finding what changed, s",
                        "speedup", "paper: LAO, s", "CAO, s", "speedup"});
    for (const auto& [name, scene] : scenes)
        for (const char* rays : kRays) {
            const Json& row = scene["rays"][rays];
            const PaperRow& paper = kPaper.at(name).at(rays);
            table.row({name, rays, text("%.3f", number(row, "lao")), text("%.1f", number(row, "gsamples")),
                       text("%.4f", number(row, "cao")), text("%.4f", number(row, "clipping")),
                       text("%.2f", number(row, "speedup")), text("%.3f", 1 / paper.lao_fps),
                       text("%.4f", 1 / paper.cao_fps), text("%.2f", paper.cao_fps / paper.lao_fps)});
        }
    page.table(table);
}

void write_table4(const Scenes& scenes, bench::Page& page) {
    page.heading(3, "Table 4: a second mesh");
    page.paragraph(
        "How much longer the frame of table 3 takes beside a sphere that overlaps the mesh and was there "
        "before, and where that sphere appears in the same frame, with all that it alone has an effect on. "
        "Against the frame just before, the median of a few turns.");
    bench::Table table({"scene", "rays", "at rest", "appears too", "paper"});
    for (const auto& [name, scene] : scenes)
        for (const char* rays : kRays)
            table.row({name, rays, text("%+.1f%%", number(scene["rays"][rays], "slowdown")),
                       text("%+.1f%%", number(scene["rays"][rays], "slowdown_both")),
                       text("+%.1f%%", kPaper.at(name).at(rays).slowdown)});
    page.table(table);
}

void write_breakdown(const Scenes& scenes, bench::Page& page) {
    page.heading(3, "Figure 10: where a frame's time goes");
    page.paragraph(
        "Milliseconds on one core, except rendering: a picture of 256 × 256 pixels by the ray caster, 2 × 2 "
        "rays "
        "a pixel, all cores. LAO of a clipped volume needs the clipping of CAO too.");
    bench::Table table(
        {"scene", "rays", "clipping", "rays: LAO", "rays: CAO", "rendering", "memory, volumes"});
    for (const auto& [name, scene] : scenes)
        for (const char* rays : {"6", "54"}) {
            const Json& row = scene["rays"][rays];
            table.row({name, rays, text("%.1f", 1e3 * number(row, "clipping")),
                       text("%.1f", 1e3 * number(row, "lao")),
                       text("%.1f", 1e3 * (number(row, "cao") - number(row, "clipping"))),
                       text("%.0f", 1e3 * number(scene, "rendering")),
                       text("%.2f", number(scene, "memory"))});
        }
    page.table(table);
    page.paragraph(
        "Memory is the most that a session holds through the context's allocation hooks, and the caller's "
        "volume, here bytes, in volumes of floats; the paper's five are its volume, opacities, mask, "
        "factors before clipping and factors.");
}

}  // namespace

void write_scenes(const Json& all, bench::Page& page) {
    const Scenes scenes = scenes_of(all);
    if (scenes.empty())
        return page.paragraph("**No scan was there: tables 2, 3, 4 and figure 10 are left out.**");
    write_table2(scenes, page);
    write_table3(scenes, page);
    write_table4(scenes, page);
    write_breakdown(scenes, page);
}

}  // namespace dfield::cutting
