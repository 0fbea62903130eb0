// What screen space approximates, by rays in world space: the same integrals with the same measure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baker/screen/fuzzy_measure.hpp"
#include "baker/screen/lit_scene.hpp"

namespace dfield {

struct RayReferenceOptions {
    FuzzyMeasure measure;
    std::uint32_t rays = 256;  // cosine-weighted, turned about the normal by each pixel's index
    bool indirect = false;     // the light that hits reflect is wanted: a shadow ray for each
    bool unbounded = false;    // visibility at any distance is wanted: rays do not end at the radius
    int threads = 0;
    const std::atomic<bool>* cancel = nullptr;  // as trace_gbuffer
};

// One entry for each pixel that was asked for.
struct RayReference {
    std::vector<float> visibility;    // the ambient occlusion O(s) = 1/pi integral mu(D) cos
    std::vector<glm::vec3> indirect;  // I(s) = 1/pi integral (1 - mu(D)) L(o) cos, L by the sun alone
    std::vector<float> sky;           // 1/pi integral [no surface at all] cos
};

// `pixels` index the buffers. Where there is no surface visibility is 1 and no light comes. Surfaces begin
// where the depth says. Equal at any thread count.
RayReference trace_reference(const LitScene& scene, const GBuffer& buffer,
                             std::span<const std::uint32_t> pixels, const RayReferenceOptions& options);

// At most `count` of the pixels that show a surface, spread over them evenly and out of step with any
// pattern of the picture's; the same for the same depths. Errors over all of them are estimated by those over
// these.
std::vector<std::uint32_t> surface_pixels(const GBuffer& buffer, std::size_t count);

// Where a pixel's surface lies in the world, and its unit normal there.
struct ScreenPoint {
    glm::vec3 position, normal;
};
// The pixel shows a surface and the buffer has normals.
ScreenPoint world_point(const GBuffer& buffer, std::uint32_t pixel);

}  // namespace dfield
