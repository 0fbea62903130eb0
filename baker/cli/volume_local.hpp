// Local ambient occlusion from the command line: its flags, and clip meshes with their poses and frames.
#pragma once

#include <filesystem>
#include <glm/mat4x4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "baker/cli/app_fwd.hpp"
#include "baker/cli/runtime_volume.hpp"
#include "baker/volume/transfer_function.hpp"

namespace dfield::cli {

// --rays --fibonacci --samples --step --world-steps --weights --jitter --seed --approximate
struct LocalOptions {
    std::uint32_t rays = 54, samples = 20;
    float step = 1, jitter = 0;
    double opacity_length = 0;
    bool fibonacci = false, world = false, approximate = false;
    std::vector<float> weights;  // or those of weights_file
    std::string weights_file;
    std::uint64_t seed = 0;
};
void add_local_options(CLI::App& command, LocalOptions& options);

// What they say, and the transfer function, as the runtime takes them.
class LocalSettings {
  public:
    LocalSettings(const LocalOptions& options, const TransferFunction& transfer);
    LocalSettings(const LocalSettings&) = delete;
    LocalSettings& operator=(const LocalSettings&) = delete;

    const dfield_local_desc& local() const { return local_; }
    const dfield_opacity_desc& opacity() const { return opacity_; }
    // Samples whose opacity a whole volume's factors depend on: M - 1 a ray.
    double samples(std::size_t voxels) const {
        return static_cast<double>(voxels) * local_.ray_count * (local_.samples - 1);
    }

  private:
    std::vector<float> weights_;
    std::vector<dfield_opacity_point> points_;
    dfield_local_desc local_;
    dfield_opacity_desc opacity_{};
};

// --clip --pose --probe --frames --clip-samples --clip-method --clip-resolution
struct ClipOptions {
    std::vector<std::string> meshes, poses, probes;
    std::string frames_file, method = "auto";
    std::uint32_t samples = DFIELD_CLIP_SAMPLES, resolution = 512;
};
void add_clip_options(CLI::App& command, ClipOptions& options);

// Meshes in a volume, and where they are from frame to frame.
class ClipScene {
  public:
    // Throws Error of usage and InputError.
    ClipScene(const ClipOptions& options, const Context& context, const VolumeGrid& grid);

    std::size_t frames() const { return frames_.size(); }
    // Every mesh, at its place in the runtime's frame; those that a frame hides are left out.
    std::vector<dfield_clip> clips(std::size_t frame) const;
    // The same for one mesh, or nothing.
    std::optional<dfield_clip> clip(std::size_t frame, std::size_t mesh) const;
    std::size_t meshes() const { return meshes_.size(); }
    const ClipMesh& mesh(std::size_t i) const { return meshes_[i]; }

  private:
    using Poses = std::vector<std::optional<glm::dmat4>>;  // a mesh, to the world
    void read_frames(const std::string& file);

    glm::dmat4 to_frame_;
    std::vector<ClipMesh> meshes_;
    std::vector<bool> probes_;
    std::vector<glm::dvec3> centres_;
    std::vector<Poses> frames_;
};

// Brings a session's clips to those of a frame; `ids` are the session's, one a mesh.
void show_frame(const ClipScene& scene, std::size_t frame, Contextual& session,
                std::vector<std::optional<std::uint32_t>>& ids);

}  // namespace dfield::cli
