// A clip that moves a voxel and a half a frame.
#include <algorithm>
#include <cstring>

#include "bench/cutting/pieces.hpp"
#include "bench/cutting/shapes.hpp"
#include "bench/cutting/stage.hpp"

namespace dfield::cutting {
namespace {

constexpr int kFrames = 12;
const glm::dvec3 kStep = glm::dvec3(0.9, 0.8, 0.9);  // 1.5 voxels

Json moving(const Scene& scene, const Lab& lab) {
    const Stage stage(scene, 54);
    std::vector<float> visibility;
    double lao = stage.lao(visibility);
    for (int round = 1; round < lab.stock.rounds(3); ++round) lao = std::min(lao, stage.lao(visibility));
    Contextual session = stage.session();
    const ClipMesh mesh = stage.mesh(scene.first);
    Cutter cutter = scene.first;
    const std::uint32_t id = session.add(stage.clip(mesh, cutter));
    session.update();
    double seconds = 0, recomputed = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
        cutter.centre += kStep;
        session.move(id, stage.clip(mesh, cutter).mesh_to_world);
        const dfield_update_result result = session.update();
        seconds += result.seconds / kFrames;
        recomputed += 100 * static_cast<double>(result.recomputed) / kFrames;
    }
    const dfield_clip last = stage.clip(mesh, cutter);
    const std::vector<float> truth = stage.lao_clipped(std::span(&last, 1));
    return {
        {"size", size_text(scene.volume.grid.size)},
        {"transfer", scene.transfer_file},
        {"lao", lao},
        {"seconds", seconds},
        {"recomputed", recomputed / static_cast<double>(stage.voxels())},
        {"speedup", lao / seconds},
        {"identical", std::memcmp(truth.data(), session.visibility(), truth.size() * sizeof(float)) == 0}};
}

}  // namespace

Json measure_moving(Lab& lab) {
    Json figures = Json::object();
    const auto add = [&](const std::string& name, const char* transfer, const Volume& volume) {
        const std::array<std::size_t, 3> size = volume.grid.size;
        Scene scene = plain_scene(lab, name, transfer, volume, lab.stock.quick() ? 5u : 20u);
        scene.first.mesh = unit_sphere();
        for (int axis = 0; axis < 3; ++axis)
            scene.first.centre[axis] = 0.5 * static_cast<double>(size[static_cast<std::size_t>(axis)]);
        scene.first.scale = 0.2 * static_cast<double>(size[0]);
        figures[name] = moving(scene, lab);
    };
    const std::uint32_t n = lab.stock.size(256);
    add("vessels", "bonsai", volumes::as_bytes("vessels", models::vessels_volume({n, n, n}, 1), 30).volume);
    double sparse = figures["vessels"]["speedup"];
    if (const volumes::Subject* bonsai = lab.stock.shared("bonsai")) {
        add("bonsai", "bonsai", bonsai->volume);
        sparse = std::min(sparse, figures["bonsai"]["speedup"].get<double>());
    }
    if (const volumes::Subject* engine = lab.stock.shared("engine")) add("engine", "engine", engine->volume);
    figures["sparse"] = sparse;
    return figures;
}

void write_moving(const Json& all, bench::Page& page) {
    page.heading(3, "A clip on the move");
    page.paragraph(
        text("A sphere of a fifth of the volume's width moves 1.5 voxels a frame, %d frames, through the "
             "volume's middle; 54 rays of 20 samples, one core. Vessels and bonsai are the sparse ones.",
             kFrames));
    bench::Table table({"volume", "voxels", "transfer function", "LAO, s", "a frame, s", "computed anew",
                        "speedup", "identical to LAO"});
    for (const auto& [name, row] : all["moving"].items())
        if (row.is_object())
            table.row({name, row["size"], row["transfer"], text("%.3f", row["lao"].get<double>()),
                       text("%.4f", row["seconds"].get<double>()),
                       text("%.2f%%", row["recomputed"].get<double>()),
                       text("%.1f", row["speedup"].get<double>()),
                       row["identical"].get<bool>() ? "yes" : "**no**"});
    page.table(table);
}

}  // namespace dfield::cutting
