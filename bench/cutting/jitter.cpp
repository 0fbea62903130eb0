// Tables 5 and 6 with rays turned at random.
#include <algorithm>

#include "bench/cutting/pieces.hpp"
#include "bench/cutting/ray_sets.hpp"
#include "bench/cutting/stage.hpp"

namespace dfield::cutting {

Json measure_jitter(Lab& lab) {
    Json figures = Json::object();
    for (const char* name : kSceneNames) {
        std::optional<Scene> scene = make_scene(lab, name);
        if (!scene) continue;
        const std::array<std::size_t, 3> size = scene->volume.grid.size;
        std::array<std::size_t, 3> low, crop;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            crop[axis] = std::min<std::size_t>(size[axis], lab.stock.quick() ? 20 : 96);
            low[axis] = (size[axis] - crop[axis]) / 2;
        }
        scene->volume = resampled(scene->volume, low, crop, crop);
        std::vector<float> truth, found;
        Stage(*scene, kTruth, 0).lao(truth);
        Json& of_scene = figures[name];
        of_scene["size"] = size_text(crop);
        for (const std::uint32_t rays : kRays) {
            cli::LocalOptions options = options_of(*scene, rays);
            Json& row = of_scene["rays"][std::to_string(rays)];
            for (const float jitter : {0.0f, 0.5f, 1.0f}) {
                options.jitter = jitter;
                Stage(*scene, options, 0).lao(found);
                row.push_back(rms(found, truth));
            }
        }
    }
    return figures;
}

void write_jitter(const Json& all, bench::Page& page) {
    page.heading(3, "The same with jitter");
    const Json& figures = all["jitter"];
    if (figures.empty()) return page.paragraph("**No scan was there: this table is left out.**");
    page.paragraph(
        "RMS by voxels with rays turned at random, other ones at every voxel, by up to so many times half "
        "the "
        "angle between neighbours; the scenes' middles, unclipped.");
    bench::Table table({"scene", "voxels", "rays", "no jitter", "0.5", "1"});
    for (const auto& [name, scene] : figures.items())
        for (const std::uint32_t rays : kRays) {
            const Json& row = scene["rays"][std::to_string(rays)];
            table.row({name, scene["size"], std::to_string(rays), text("%.5f", row[0].get<double>()),
                       text("%.5f", row[1].get<double>()), text("%.5f", row[2].get<double>())});
        }
    page.table(table);
}

}  // namespace dfield::cutting
