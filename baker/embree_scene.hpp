// Embree behind one small class: meshes in, a committed scene out.
#pragma once

#include <embree3/rtcore.h>

#include <glm/mat4x4.hpp>
#include <memory>
#include <string>

#include "baker/mesh.hpp"

namespace dfield {

// What a scene is optimised for.
enum class EmbreeUse {
    kBake,  // fixed instruction set without fused multiply-add, robust edges: the same hits wherever it runs
    kFast   // the machine's best instruction set, high build quality: the peer in comparisons, pictures,
            // reference AO
};

// The instruction set that bakes are traced with; recorded in provenance.
std::string bake_instruction_set();

class EmbreeScene {
  public:
    explicit EmbreeScene(EmbreeUse use);
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;
    ~EmbreeScene();

    // Adds a mesh with its vertices transformed; returns Embree's geometry id. The mesh is copied.
    unsigned add_mesh(const TriangleMesh& mesh, const glm::mat4& transform = glm::mat4(1));

    // Adds an instance of another scene, which must be committed and outlive this one.
    unsigned add_instance(const EmbreeScene& scene, const glm::mat4& transform);

    void commit(int threads = 0);

    RTCScene get() const { return scene_; }
    // The instruction set that Embree was asked for, as recorded in provenance: "avx", or "native"
    const std::string& instruction_set() const { return instruction_set_; }

  private:
    EmbreeUse use_;
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    std::string instruction_set_;
};

// Fills one lane of a packet of any width (RTCRay4, RTCRay8, RTCRay16).
template<class Packet>
void set_ray(Packet& ray, std::size_t lane, const glm::vec3& origin, const glm::vec3& direction,
             float near_distance, float max_distance) {
    ray.org_x[lane] = origin.x;
    ray.org_y[lane] = origin.y;
    ray.org_z[lane] = origin.z;
    ray.dir_x[lane] = direction.x;
    ray.dir_y[lane] = direction.y;
    ray.dir_z[lane] = direction.z;
    ray.tnear[lane] = near_distance;
    ray.tfar[lane] = max_distance;
    ray.time[lane] = 0;
    ray.mask[lane] = ~0u;
    ray.id[lane] = 0;
    ray.flags[lane] = 0;
}

template<class Hits>
void clear_hit(Hits& hit, std::size_t lane) {
    hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
}

}  // namespace dfield
