// A peer: the signed distance field that game engines ship for soft occlusion (Unreal's mesh distance fields,
// Godot's SDFGI), a grid of 8-bit distances round one object, sphere traced. A baseline of the measurements
// only.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "baker/mesh.hpp"
#include "bench/paper/lab.hpp"

namespace dfield::kinds {

// What is inside. Closed surfaces have an inside; sheets, leaves and whatever else is open have none, and a
// field without a sign hits them where they are nearer than a third of a voxel.
enum class Inside {
    kVotes,  // where most of some rays around a node meet the back of a surface first, as Unreal decides it
    kNowhere,
    kNowhereThick  // and half a voxel: the sheet between two nodes is that far from both
};

struct DistanceFieldParameters {
    std::uint32_t size = 32;  // nodes along each axis of the box, 4 or more
    Inside inside = Inside::kVotes;
};

class DistanceField {
  public:
    // The grid covers the mesh's box and a voxel around it; distances by Embree's closest-point queries.
    DistanceField(const TriangleMesh& mesh, const DistanceFieldParameters& parameters);

    std::uint64_t memory_bytes() const { return nodes_.size(); }

    // Visibility of receivers past the object, unbounded: each direction (around the normal, of even weight)
    // is sphere traced from the receiver. On the calling thread, with the machine's widest vectors.
    std::vector<float> visibility(const paper::Receivers& receivers,
                                  std::span<const glm::vec3> directions) const;

    // What the tracing reads. Node coordinates: (point - origin) * to_nodes, 0 .. size - 1.
    struct View {
        const std::uint8_t* nodes;  // x fastest; 4 more bytes are readable behind the last
        std::int32_t size;
        glm::vec3 origin, to_nodes;
        float distance_scale, distance_offset;  // distance = scale * byte + offset
        float surface;                          // distances up to this are hits
        float least_step;
    };
    View view() const;

  private:
    float voxel_edge() const;  // of the longest axis

    std::uint32_t size_;
    Inside inside_;
    glm::vec3 origin_, spacing_;
    float range_ = 0;  // distances are stored from -range_ to range_
    std::vector<std::uint8_t> nodes_;
};

}  // namespace dfield::kinds
