// Small built-in renderer: smooth-shaded per-vertex visibility, anti-aliased, over Embree. For pictures in
// reports.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "baker/mesh.hpp"
#include "baker/picture/image.hpp"

namespace dfield {

struct RenderObject {
    const TriangleMesh* mesh = nullptr;  // kept by the caller during render
    glm::mat4 transform{1};              // object to world, invertible
    std::vector<float> visibility{};  // per vertex, 0..1, interpolated over triangles; empty = 1 everywhere
    glm::vec3 albedo{1};              // linear factor on the grey
    bool shade =
        false;  // additionally a soft headlight-free hemisphere shading (0.6 + 0.4 n.up) so that form reads
    bool cull_back = false;  // do not draw triangles seen from behind (room walls towards the camera)
};

struct Camera {
    glm::vec3 eye{0}, target{0}, up{0, 0, 1};  // up: also the zenith of the hemisphere shading
    float vertical_fov_degrees = 35;
};

struct RenderOptions {
    std::uint32_t width = 640, height = 480;
    std::uint32_t samples = 4;  // per pixel and axis: 4 = 16 stratified samples a pixel, box filter
    glm::vec3 background{1};
    int threads = 0;  // 0 = all
};

// The camera that looks from a direction (towards the eye) and stands as near as it may while all eight
// corners of the box stay in view, with a margin of 2% of the picture. aspect = width / height.
Camera frame_bounds(const Bounds& bounds, const glm::vec3& direction_to_eye, const glm::vec3& up,
                    float fov_degrees, float aspect);

// The same picture at any thread count. Which side of a triangle is its front follows glTF: the winding as
// seen in object space, so a mirrored instance keeps its front. Throws std::invalid_argument for a visibility
// count other than the vertex count, a singular transform or a camera without direction, Error when Embree
// runs out of memory.
Image render(std::span<const RenderObject> objects, const Camera& camera, const RenderOptions& options = {});

}  // namespace dfield
