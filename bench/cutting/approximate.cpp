// The approximate mode for long rays, against the exact one.
#include <algorithm>
#include <cmath>

#include "bench/cutting/pieces.hpp"
#include "bench/cutting/stage.hpp"

namespace dfield::cutting {
namespace {

Stage stage_of(const Scene& scene, float step, bool approximate, int threads) {
    cli::LocalOptions options;
    options.samples = std::max(scene.samples, 20u);  // long enough also with --quick
    options.step = step;
    options.approximate = approximate;
    return Stage(scene, options, threads);
}

Json compared(const Lab& lab, const Scene& scene, float step = 1) {
    std::vector<float> exact, approximate;
    double seconds[2] = {INFINITY, INFINITY}, two_threads[2];
    for (int round = 0; round < rounds_of(lab, scene); ++round) {
        seconds[0] = std::min(seconds[0], stage_of(scene, step, false, 1).lao(exact));
        seconds[1] = std::min(seconds[1], stage_of(scene, step, true, 1).lao(approximate));
    }
    double squares = 0, matter_squares = 0, largest = 0;
    std::size_t in_matter = 0;
    const auto bytes = scene.volume.voxels<std::uint8_t>();
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const double miss = static_cast<double>(approximate[i]) - static_cast<double>(exact[i]);
        squares += miss * miss;
        largest = std::max(largest, std::abs(miss));
        if (scene.transfer.opacity(bytes[i]) > 0) matter_squares += miss * miss, ++in_matter;
    }
    two_threads[0] = stage_of(scene, step, false, 2).lao(exact);
    two_threads[1] = stage_of(scene, step, true, 2).lao(approximate);
    return {{"size", size_text(scene.volume.grid.size)},
            {"samples", std::max(scene.samples, 20u)},
            {"step", step},
            {"exact", seconds[0]},
            {"approximate", seconds[1]},
            {"speedup", seconds[0] / seconds[1]},
            {"two_threads", {{"exact", two_threads[0]}, {"approximate", two_threads[1]}}},
            {"rms", std::sqrt(squares / static_cast<double>(exact.size()))},
            {"rms_of_matter", in_matter ? std::sqrt(matter_squares / static_cast<double>(in_matter)) : 0.0},
            {"largest", largest}};
}

}  // namespace

Json measure_approximate(Lab& lab) {
    Json figures = Json::object();
    for (const char* name : kSceneNames)
        if (const std::optional<Scene> scene = make_scene(lab, name)) figures[name] = compared(lab, *scene);
    // Scans as they are, whose voxels differ more from their neighbours, and steps of two voxels.
    for (const char* name : {"bonsai", "engine"})
        if (const volumes::Subject* scan = lab.stock.shared(name)) {
            const Scene scene = plain_scene(lab, name, name, scan->volume, 50);
            for (const float step : {1.0f, 2.0f})
                figures[text(step > 1 ? "%s, longer steps" : "%s, longer rays", name)] =
                    compared(lab, scene, step);
        }
    return figures;
}

void write_approximate(const Json& all, bench::Page& page) {
    const Json& figures = all["approximate"];
    page.heading(3, "Approximate long rays");
    if (figures.empty()) return page.paragraph("**No scan was there: this table is left out.**");
    page.paragraph(
        "`--approximate`: a ray's first samples (3, or 150 / M) are taken singly, then five or six pairs, "
        "then fours, or pairs where a step is longer than a voxel; where the first ones meet nothing rays "
        "are walked for every second row and slice alone. "
        "The scenes of table 2, unclipped, and scans as they are; 54 rays, one core unless said otherwise. "
        "Errors are of all voxels, of those that have an opacity, and the largest one.");
    bench::Table table({"scene", "voxels", "M", "step", "exact, s", "approximate, s", "speedup",
                        "two threads: exact, s", "approximate, s", "RMS", "of matter", "largest"});
    for (const auto& [name, row] : figures.items())
        table.row({name, row["size"], text("%u", row["samples"].get<unsigned>()),
                   text("%g", row["step"].get<double>()), text("%.3f", row["exact"].get<double>()),
                   text("%.3f", row["approximate"].get<double>()), text("%.2f", row["speedup"].get<double>()),
                   text("%.3f", row["two_threads"]["exact"].get<double>()),
                   text("%.3f", row["two_threads"]["approximate"].get<double>()),
                   text("%.1e", row["rms"].get<double>()), text("%.1e", row["rms_of_matter"].get<double>()),
                   text("%.1e", row["largest"].get<double>())});
    page.table(table);
}

}  // namespace dfield::cutting
