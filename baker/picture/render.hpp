// Small built-in renderer: smooth-shaded per-vertex visibility, anti-aliased, over Embree. For pictures in
// reports.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "baker/mesh.hpp"
#include "baker/picture/camera.hpp"
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

// The same picture at any thread count. Which side of a triangle is its front follows glTF: the winding as
// seen in object space, so a mirrored instance keeps its front. Throws std::invalid_argument for a visibility
// count other than the vertex count, a singular transform or a camera without direction, Error when Embree
// runs out of memory.
Image render(std::span<const RenderObject> objects, const Camera& camera, const RenderOptions& options = {});

}  // namespace dfield
