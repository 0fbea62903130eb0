// A scene, and the calls that are timed and drawn.
#pragma once

#include "baker/cli/runtime_volume.hpp"
#include "baker/cli/volume_local.hpp"
#include "baker/picture/camera.hpp"
#include "baker/picture/image.hpp"
#include "bench/cutting/scenes.hpp"

namespace dfield::cutting {

class Stage {
  public:
    // The scene is the caller's and outlives this. Rays: 6, 14, 26, 54 or any number of a Fibonacci set.
    Stage(const Scene& scene, std::uint32_t rays, int threads = 1, dfield_context_desc hooks = {});
    Stage(const Scene& scene, const cli::LocalOptions& options, int threads = 1,
          dfield_context_desc hooks = {});

    std::size_t voxels() const { return runtime_.voxels(); }
    double gsamples() const { return 1e-9 * settings_.samples(voxels()); }
    const dfield_local_desc& local() const { return settings_.local(); }

    // Seconds of the whole volume, unclipped.
    double lao(std::vector<float>& visibility) const;
    std::vector<float> lao_clipped(std::span<const dfield_clip> clips) const;
    Contextual session(dfield_update_mask mask = DFIELD_UPDATE_CHANGED,
                       std::uint32_t clip_samples = DFIELD_CLIP_SAMPLES) const;
    ClipMesh mesh(const Cutter& cutter) const;
    dfield_clip clip(const ClipMesh& mesh, const Cutter& cutter) const;

  private:
    cli::LocalSettings settings_;
    cli::RuntimeVolume runtime_;
};

struct Frame {
    glm::vec3 to_eye;
    std::uint32_t width = 300, height = 300;
    float fov_degrees = 30;
    double zoom = 1;        // of the picture's middle
    glm::dvec3 towards{0};  // voxels that the picture's middle moves from the volume's
    float gain = 2;         // of visibility, up to 1: a plane, half of whose sky is open, is not darkened
    glm::vec3 up{0, 0, 1};
};
// The scene through its transfer function as a session's clips leave it, darkened by `visibility`; empty: by
// nothing.
Image draw(const Scene& scene, const Contextual& session, std::span<const float> visibility,
           const Frame& frame, const Lab& lab);

// Makes the first cutter as large as has the paper's mask cover the share of the voxels that is asked for.
void fit_cutter(Scene& scene);

}  // namespace dfield::cutting
