#include "bench/cutting/stage.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "baker/volume/render_volume.hpp"

namespace dfield::cutting {
namespace {

cli::LocalOptions options_of(const Scene& scene, std::uint32_t rays) {
    cli::LocalOptions options;
    options.rays = rays;
    options.samples = scene.samples;
    return options;
}

}  // namespace

Stage::Stage(const Scene& scene, std::uint32_t rays, int threads, dfield_context_desc hooks)
    : Stage(scene, options_of(scene, rays), threads, hooks) {}

Stage::Stage(const Scene& scene, const cli::LocalOptions& options, int threads, dfield_context_desc hooks)
    : settings_(options, scene.transfer), runtime_(scene.name, scene.volume, threads, hooks) {}

double Stage::lao(std::vector<float>& visibility) const {
    visibility.resize(voxels());
    return runtime_.timed([&] {
        local_ao_volume(runtime_.context(), runtime_.samples(), settings_.opacity(), settings_.local(),
                        visibility.data());
    });
}

std::vector<float> Stage::lao_clipped(std::span<const dfield_clip> clips) const {
    std::vector<float> visibility(voxels());
    local_ao_volume_clipped(runtime_.context(), runtime_.samples(), settings_.opacity(), settings_.local(),
                            clips.data(), clips.size(), DFIELD_CLIP_SAMPLES, visibility.data());
    return visibility;
}

Contextual Stage::session(dfield_update_mask mask, std::uint32_t clip_samples) const {
    dfield_contextual_desc desc = contextual_defaults();
    desc.samples = runtime_.samples();
    desc.opacity = settings_.opacity();
    desc.local = settings_.local();
    desc.clip_samples = clip_samples;
    desc.mask = mask;
    Contextual session(runtime_.context(), desc);
    session.update();
    return session;
}

ClipMesh Stage::mesh(const Cutter& cutter) const {
    dfield_clip_mesh_desc desc = clip_mesh_defaults();
    desc.positions = &cutter.mesh.positions.front().x;
    desc.vertex_count = cutter.mesh.positions.size();
    desc.indices = &cutter.mesh.triangles.front().x;
    desc.triangle_count = cutter.mesh.triangles.size();
    return ClipMesh(runtime_.context(), desc);
}

dfield_clip Stage::clip(const ClipMesh& mesh, const Cutter& cutter) const {
    const glm::dmat4 pose =
        glm::scale(glm::rotate(glm::translate(glm::dmat4(1), cutter.centre), glm::radians(cutter.degrees),
                               glm::normalize(glm::dvec3(1))),
                   glm::dvec3(cutter.scale));
    dfield_clip clip{};
    clip.mesh = mesh.get();
    clip.mode = DFIELD_CLIP_SUBTRACT;
    for (int i = 0; i < 16; ++i) clip.mesh_to_world[i] = static_cast<float>(pose[i / 4][i % 4]);
    return clip;
}

Image draw(const Scene& scene, const Contextual& session, std::span<const float> visibility,
           const Frame& frame, const Lab& lab) {
    const std::vector<float> values = float_values(scene.volume);
    Camera camera = frame_volume(scene.volume.grid, frame.to_eye, frame.up, frame.fov_degrees,
                                 static_cast<float>(frame.width) / static_cast<float>(frame.height));
    const glm::vec3 eye = camera.eye - camera.target;
    camera.target += glm::vec3(frame.towards);
    camera.eye = camera.target + eye;
    const double half = std::tan(glm::radians(static_cast<double>(frame.fov_degrees)) / 2) / frame.zoom;
    camera.vertical_fov_degrees = static_cast<float>(glm::degrees(2 * std::atan(half)));
    RenderOptions options;
    options.width = lab.stock.pixels(frame.width);
    options.height = lab.stock.pixels(frame.height);
    options.samples = lab.stock.quick() ? 1 : 2;
    VolumeStyle style;
    style.visibility = visibility;
    style.visibility_gain = frame.gain;
    style.clipped = [&](const glm::vec3& voxel) {
        std::uint8_t away = 0;
        check(dfield_contextual_test_points(session.get(), 1, &voxel.x, 0, &away));
        return away != 0;
    };
    return render_volume({scene.volume.grid, values}, scene.transfer, camera, style, options);
}

void fit_cutter(Scene& scene) {
    // The paper's mask is the geometry's affair: nothing needs to be seen, and six rays reach as far as more.
    const Scene empty{.name = scene.name,
                      .volume = scene.volume,
                      .transfer = TransferFunction({{0, 0.0f}}),
                      .samples = scene.samples};
    const Stage stage(empty, 6, 0);
    const ClipMesh mesh = stage.mesh(scene.first);
    Contextual session = stage.session(DFIELD_UPDATE_DILATED);
    const std::uint32_t id = session.add(stage.clip(mesh, scene.first));
    const auto miss = [&](double scale) {
        scene.first.scale = scale;
        session.move(id, stage.clip(mesh, scene.first).mesh_to_world);
        scene.dilated =
            100 * static_cast<double>(session.update().masked) / static_cast<double>(stage.voxels());
        return scene.dilated - scene.asked_dilated;
    };
    // The share grows with the mesh while there is room: some steps of regula falsi (the Illinois algorithm).
    constexpr double kClose = 0.02;
    double low = 0, high = 0.25 * static_cast<double>(scene.volume.grid.size[0]);
    double below = -scene.asked_dilated, above = miss(high), found = above;
    for (int step = 0; step < 12 && std::abs(found) > kClose; ++step) {
        const double middle = above > 0 ? (low * above - high * below) / (above - below) : 1.3 * high;
        found = miss(middle);
        if (above > 0 && found < 0) {
            low = middle, below = found, above /= 2;
        } else {
            if (above <= 0) low = high, below = above;
            high = middle, above = found, below /= 2;
        }
    }
}

}  // namespace dfield::cutting
