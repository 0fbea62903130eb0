// A volume's isosurface, lit in the ways that the paper's figures compare, from one camera.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "baker/cli/form_runner.hpp"
#include "baker/volume/render_volume.hpp"
#include "bench/volume/subjects.hpp"

namespace dfield::volumes {

struct View {
    glm::vec3 to_eye{0.6f, -1, 0.6f}, up{0, 0, 1};
    std::uint32_t width = 300, height = 300;
    float fov_degrees = 30;
};

class Studio {
  public:
    // The subject is the caller's. The camera frames the matter, not the grid.
    Studio(const Subject& subject, const View& view, const Stock& stock);

    dfield_sweep_desc desc(dfield_occlusion_form form) const;  // with the subject's isovalue

    // Local shading with the light at the eye, or from elsewhere.
    Image local(const glm::vec3& light = glm::vec3(0)) const;
    // Visibility and nothing else. The paper's form is evaluated at every pixel, with its own normal, as the
    // paper's ray marcher does, unless light shines through or octants differ; the others from their volumes.
    Image swept(const dfield_sweep_desc& desc);
    // The reference, cast for every pixel, once: later calls change the gamma only.
    Image by_rays(std::uint32_t rays, float gamma);
    // Local shading of a light, without what lies in its shadow: rays are marched towards it.
    Image hard_shadows(const glm::vec3& light) const;
    // The share of the light that `desc` leaves, over the same ambient part. `gain`: of what is brightest.
    Image soft_shadows(const dfield_sweep_desc& desc, float gain);
    // With local shading of the light too.
    Image soft_shadows_of_light(dfield_sweep_desc desc, const glm::vec3& light);

  private:
    IsosurfaceStyle unlit() const;
    Image draw(const IsosurfaceStyle& style) const;
    // All points of the surface that the camera sees, in the frame that the runtime sweeps in, and a picture
    // of their values.
    dfield_volume_points points();
    Image draw_points(const std::vector<float>& values, float gamma) const;

    const Subject& subject_;
    cli::VolumeSweeper sweeper_;
    cli::FormRunner runner_;
    Camera camera_;
    RenderOptions options_;
    std::vector<float> distance_, truth_;
    std::vector<glm::vec3> indices_, positions_;  // of points(): in voxels, in order, and in the frame
};

// Of grey levels over the pixels that show more than the background: RMS of two pictures' differences, and a
// picture's mean.
double picture_rms(const Image& a, const Image& b);
double picture_mean(const Image& image);

inline constexpr float kGamma = 2;  // of all corrected pictures, as in the paper

}  // namespace dfield::volumes
