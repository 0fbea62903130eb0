// A scene under a sun: what rays hit, and the direct light that it reflects. Surfaces are diffuse and seen
// from both sides.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "baker/embree_scene.hpp"
#include "baker/scene.hpp"
#include "baker/screen/gbuffer.hpp"

namespace dfield {

struct Sun {
    glm::vec3 direction{0.3f, 1, 0.5f};  // towards it, world; any length but 0
    glm::vec3 colour{1};                 // the radiance that a white surface which faces it reflects
};

struct SurfaceHit {
    float distance;  // in lengths of the ray's direction
    glm::vec3 position;
    glm::vec3 normal;  // world, unit, interpolated, on the side that the ray comes from
    glm::vec3 albedo;
    std::uint32_t instance;  // of the imported scene
};

class LitScene {
  public:
    // Keeps a reference to the scene. Throws InputError where it has no triangle. Surfaces without an albedo
    // of their own get kAlbedo.
    explicit LitScene(const ImportedScene& scene);
    LitScene(const LitScene&) = delete;

    static constexpr float kAlbedo = 0.8f;

    void set_sun(const Sun& sun) { sun_ = sun; }
    const Bounds& bounds() const { return bounds_; }  // of what is drawn, world
    float longest_side() const;
    // Rays that leave a surface begin this far above it.
    float lift() const { return 1e-5f * longest_side(); }

    std::optional<SurfaceHit> nearest(const glm::vec3& origin, const glm::vec3& direction, float near,
                                      float far) const;
    // The sun's light that the surface reflects, shadows included.
    glm::vec3 direct_light(const SurfaceHit& hit) const;

  private:
    const ImportedScene& scene_;
    Sun sun_;
    Bounds bounds_;
    std::vector<std::unique_ptr<EmbreeScene>> meshes_;
    std::vector<std::uint32_t> drawn_;         // Embree's instance id -> instance of the scene
    std::vector<glm::mat3> normals_to_world_;  // of the same
    EmbreeScene whole_{EmbreeUse::kBake};  // its instruction set is fixed: the same buffers on every machine
};

// All buffers, through pixel centres. Equal at any thread count. `background`: radiance of the sky;
// `instances`, where not null, gets the instance that each pixel shows (~0u: none). Throws
// Error(kInterrupted) when *cancel becomes true.
GBuffer trace_gbuffer(const LitScene& scene, const ScreenCamera& camera, std::uint32_t width,
                      std::uint32_t height, const glm::vec3& background, int threads,
                      std::vector<std::uint32_t>* instances = nullptr,
                      const std::atomic<bool>* cancel = nullptr);

}  // namespace dfield
