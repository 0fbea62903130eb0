// Pictures of a volume while meshes clip it: local ambient occlusion at every frame, and samples tested one
// by one.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "baker/cli/volume_local.hpp"
#include "baker/volume/render_volume.hpp"

namespace dfield::cli {

// --ao, besides those of add_local_options() and add_clip_options().
struct ClipPictureOptions {
    std::string ao = "contextual";  // unclipped: factors of the whole volume; none
    LocalOptions local;
    ClipOptions clip;

    bool used() const { return !clip.meshes.empty() || !clip.probes.empty(); }
};
void add_clip_picture_options(CLI::App& command, ClipPictureOptions& options);

// Calls draw(clipped, visibility, file) for every frame: VolumeStyle's members, valid during the call, and
// the picture's name: `output`, with the frame's number before its ending where there is a script of frames.
// Returns the names.
using DrawFrame = std::function<void(const std::function<bool(const glm::vec3&)>& clipped,
                                     std::span<const float> visibility, const std::string& file)>;
std::vector<std::string> draw_clipped(const ClipPictureOptions& options, const std::string& name,
                                      const Volume& volume, const TransferFunction& transfer, int threads,
                                      const std::string& output, const DrawFrame& draw);

}  // namespace dfield::cli
