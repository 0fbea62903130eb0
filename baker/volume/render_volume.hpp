// Pictures of volumes by marching rays: isosurfaces out of a distance field, and direct volume rendering.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <span>

#include "baker/picture/camera.hpp"
#include "baker/volume/transfer_function.hpp"
#include "baker/volume/volume.hpp"

namespace dfield {

// Values of a grid's voxels, x fastest, trilinear in between; nothing lies beyond the outermost voxels. The
// grid may be anisotropic, oblique and mirrored. Kept by the caller; finite.
struct ScalarField {
    const VolumeGrid& grid;
    std::span<const float> values;
};

// The camera of frame_bounds() around the grid's outermost voxels.
Camera frame_volume(const VolumeGrid& grid, const glm::vec3& direction_to_eye = {0.6f, -1, 0.45f},
                    const glm::vec3& up = {0, 0, 1}, float fov_degrees = 35, float aspect = 4.0f / 3);

struct IsosurfaceStyle {
    bool local = true;      // Lambert: ambient + (1 - ambient) max(0, n.l)
    float ambient = 0.25f;  // 0..1
    glm::vec3 light{0};     // towards the light, in the world; 0: from the eye
    glm::vec3 albedo{1};
    // Per voxel of the distance field's grid, 0..1: multiplies the colour, but where the grid's border cuts
    // the matter: all is open there. Empty: 1 everywhere.
    std::span<const float> visibility{};
    float visibility_offset = 0;  // voxels along the normal at which visibility is sampled
    // Instead of a volume: visibility at a point of the surface, told in voxels. Called from several threads.
    std::function<float(const glm::vec3& index)> visibility_at{};
    // Visibility is that of one light, whose shadows leave the ambient part: ambient + (1 - ambient) v max(0,
    // n.l), without the last factor where `local` is false.
    bool shadows = false;
    // Rays towards the light that meet the surface: the light's own share is 0 there. With `local`.
    bool hard_shadows = false;
};

// The surface where `distance` is 0 and falls below along the ray: positive outside, in world units, an
// overestimate by no more than a quarter. Sphere tracing with steps of at least a fifth of a voxel, so
// surfaces thinner than that may be missed; the hit is refined to a thousandth of a voxel. Normals are the
// gradient's. A ray that enters the grid inside the matter sees it cut there. The same at any thread count.
// Throws std::invalid_argument where counts do not match the grid, or for the camera.
Image render_isosurface(const ScalarField& distance, const Camera& camera, const IsosurfaceStyle& style = {},
                        const RenderOptions& options = {});

struct VolumeStyle {
    // Length in world units that the transfer function's opacity a is of: what lies behind a layer so thick
    // of one value is seen by 1 - a. 0: the smallest spacing.
    double reference_length = 0;
    double step =
        0;  // world units between samples, a hundredth of the smallest spacing or more; 0: half of it
    bool local = false;  // two-sided Lambert by the gradient of the values, where there is one
    float ambient = 0.25f;
    glm::vec3 light{0};                   // as in IsosurfaceStyle
    std::span<const float> visibility{};  // per voxel, 0..1, multiplies colours; empty: 1 everywhere
    float visibility_gain = 1;            // times it, 1 at most
    // Whether a point, in voxels, is clipped away; called from several threads. Empty: nothing is.
    std::function<bool(const glm::vec3& voxel)> clipped{};
};

// Emission and absorption, composited front to back (Max 1995): each step's opacity is 1 - (1 - a)^(step /
// reference length), so that the picture does not depend on the step where values are constant. Ends where
// less than a thousandth of the background would be seen. Otherwise as render_isosurface().
Image render_volume(const ScalarField& volume, const TransferFunction& transfer, const Camera& camera,
                    const VolumeStyle& style = {}, const RenderOptions& options = {});

}  // namespace dfield
