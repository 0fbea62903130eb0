#include "baker/cli/volume_clip_pictures.hpp"

#include <filesystem>

#include "baker/cli/arguments.hpp"
#include "baker/cli/report.hpp"

namespace dfield::cli {

void add_clip_picture_options(CLI::App& command, ClipPictureOptions& options) {
    add_local_options(command, options.local);
    add_clip_options(command, options.clip);
    command
        .add_option(
            "--ao", options.ao,
            "--clip, --probe: ambient occlusion that is contextual, of the unclipped volume (as if nothing "
            "had been cut), or none")
        ->capture_default_str()
        ->transform(CLI::IsMember({"contextual", "unclipped", "none"}, CLI::ignore_case))
        ->group("Clipping");
}

std::vector<std::string> draw_clipped(const ClipPictureOptions& options, const std::string& name,
                                      const Volume& volume, const TransferFunction& transfer, int threads,
                                      const std::string& output, const DrawFrame& draw) {
    const LocalSettings settings(options.local, transfer);
    const RuntimeVolume runtime(name, volume, threads);
    const ClipScene scene(options.clip, runtime.context(), volume.grid);
    dfield_contextual_desc desc = contextual_defaults();
    desc.samples = runtime.samples();
    desc.opacity = settings.opacity();
    desc.local = settings.local();
    desc.clip_samples = options.clip.samples;
    if (options.ao == "none") desc.local.samples = 1;
    std::optional<Contextual> session;
    std::vector<float> unclipped;
    runtime.timed([&] {
        session.emplace(runtime.context(), desc);
        session->update();
        if (options.ao == "unclipped")
            unclipped.assign(session->visibility(), session->visibility() + runtime.voxels());
    });
    const glm::vec3 spacing(volume.grid.spacing());
    const auto clipped = [&](const glm::vec3& voxel) {
        const glm::vec3 point = voxel * spacing;
        std::uint8_t away = 0;
        check(dfield_contextual_test_points(session->get(), 1, &point.x, 0, &away));
        return away != 0;
    };
    std::vector<std::optional<std::uint32_t>> ids;
    std::vector<std::string> files;
    for (std::size_t frame = 0; frame < scene.frames(); ++frame) {
        runtime.timed([&] {
            show_frame(scene, frame, *session, ids);
            session->update();
        });
        std::string file = output;
        if (!options.clip.frames_file.empty()) {
            const std::filesystem::path path(output);
            file = (path.parent_path() /
                    (path.stem().string() + text("-%04zu", frame) + path.extension().string()))
                       .string();
        }
        std::span<const float> visibility;
        if (options.ao == "contextual") visibility = {session->visibility(), runtime.voxels()};
        if (options.ao == "unclipped") visibility = unclipped;
        draw(clipped, visibility, file);
        files.push_back(file);
    }
    return files;
}

}  // namespace dfield::cli
