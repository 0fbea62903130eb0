// What tables 2, 3 and 4, figure 10 and the memory's figures are made of: one scene after the other.
#include <algorithm>
#include <cstring>

#include "bench/common/meter.hpp"
#include "bench/common/turns.hpp"
#include "bench/cutting/pieces.hpp"
#include "bench/cutting/stage.hpp"

namespace dfield::cutting {
namespace {

constexpr std::array<std::uint32_t, 4> kRays{6, 14, 26, 54};

struct Update {
    double seconds = 0, clip_seconds = 0, recomputed = 0;
};
Update update(Contextual& session, std::size_t voxels) {
    const dfield_update_result result = session.update();
    return {result.seconds, result.clip_seconds,
            100 * static_cast<double>(result.recomputed) / static_cast<double>(voxels)};
}
double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}
void keep_faster(Update& best, const Update& other, int turn) {
    if (turn == 0 || other.seconds < best.seconds) best = other;
}

// The clip appears in a volume that was whole, as often as there are rounds: alone, beside a second one that
// was there before, and together with it. LAO of the whole volume takes its turns in between.
Json times(const Scene& scene, const Stage& stage, int rounds) {
    Contextual session = stage.session();
    const ClipMesh first_mesh = stage.mesh(scene.first), second_mesh = stage.mesh(scene.second);
    const dfield_clip first = stage.clip(first_mesh, scene.first),
                      second = stage.clip(second_mesh, scene.second);
    Update alone;
    // Against the update alone just before: machines slow down for seconds at a time.
    std::vector<double> slowdowns, slowdowns_both;
    const auto slowdown = [](const Update& more, const Update& less) {
        return 100 * (more.seconds / less.seconds - 1);
    };
    double lao = 0;
    std::vector<float> visibility;
    constexpr int kTurns = 2;  // an update is soon over, and easily disturbed
    for (int turn = 0; turn < kTurns * rounds; ++turn) {
        if (turn % kTurns == 0) {
            const double seconds = stage.lao(visibility);
            lao = turn ? std::min(lao, seconds) : seconds;
        }
        std::vector<std::uint32_t> ids;
        const auto add = [&](const dfield_clip& clip) { ids.push_back(session.add(clip)); };
        const auto remove_all = [&] {
            for (const std::uint32_t id : ids) session.remove(id);
            ids.clear();
            session.update();
        };
        add(first);
        const Update alone_now = update(session, stage.voxels());
        keep_faster(alone, alone_now, turn);
        remove_all();
        add(second);
        session.update();
        add(first);
        slowdowns.push_back(slowdown(update(session, stage.voxels()), alone_now));
        remove_all();
        add(first);
        add(second);
        slowdowns_both.push_back(slowdown(update(session, stage.voxels()), alone_now));
        remove_all();
    }
    return {{"lao", lao},
            {"gsamples", stage.gsamples() / lao},
            {"cao", alone.seconds},
            {"clipping", alone.clip_seconds},
            {"recomputed", alone.recomputed},
            {"speedup", lao / alone.seconds},
            {"slowdown", median(slowdowns)},
            {"slowdown_both", median(slowdowns_both)}};
}

// Volumes' worth of floats that a session holds at most, with the volume that the caller keeps for it; and
// whether its factors are those of the clipped volume computed from scratch.
Json memory_and_identity(const Scene& scene) {
    bench::Meter meter;
    const Stage stage(scene, 54, 1, meter.hooks());  // threads would have hooks of their own
    std::size_t peak;
    bool identical;
    const ClipMesh mesh = stage.mesh(scene.first);
    const dfield_clip clip = stage.clip(mesh, scene.first);
    {
        Contextual session = stage.session();
        session.add(clip);
        session.update();
        peak = meter.peak;
        const std::vector<float> truth = stage.lao_clipped(std::span(&clip, 1));
        identical = std::memcmp(truth.data(), session.visibility(), truth.size() * sizeof(float)) == 0;
    }
    const double volume = static_cast<double>(stage.voxels()) * sizeof(float);
    return {{"identical", identical},
            {"memory", (static_cast<double>(peak) + static_cast<double>(scene.volume.data.size())) / volume}};
}

double picture_seconds(const Scene& scene, const Lab& lab) {
    const Stage stage(scene, 6);
    Contextual session = stage.session();
    const ClipMesh mesh = stage.mesh(scene.first);
    session.add(stage.clip(mesh, scene.first));
    session.update();
    return bench::seconds_of([&] {
        draw(scene, session, {session.visibility(), stage.voxels()}, {scene.to_eye, 256, 256}, lab);
    });
}

Json measure(Lab& lab, const char* name) {
    std::optional<Scene> scene = make_scene(lab, name);
    if (!scene) return Json::object();
    Json figures{{"made_of", scene->made_of},
                 {"transfer", scene->transfer_file},
                 {"size", scene->volume.grid.size},
                 {"samples", scene->samples},
                 {"cutter", scene->cutter_name},
                 {"dilated", scene->dilated},
                 {"asked_dilated", scene->asked_dilated}};
    for (const std::uint32_t rays : kRays)
        figures["rays"][std::to_string(rays)] = times(*scene, Stage(*scene, rays), rounds_of(lab, *scene));
    std::vector<float> visibility;
    figures["two_threads"] = Stage(*scene, 54, 2).lao(visibility);
    figures["rendering"] = picture_seconds(*scene, lab);
    figures.update(memory_and_identity(*scene));
    return figures;
}

}  // namespace

Json measure_engine(Lab& lab) {
    return measure(lab, "engine");
}
Json measure_beetle(Lab& lab) {
    return measure(lab, "beetle");
}
Json measure_skeleton(Lab& lab) {
    return measure(lab, "skeleton");
}

}  // namespace dfield::cutting
