// A peer: Malmer, Malmer, Assarsson and Holzschuch, "Fast Precomputed Ambient Occlusion for Proximity
// Shadows" (Journal of Graphics Tools 12(2), 2007). A grid round one object whose nodes hold what the object
// hides of the sphere of directions as a spherical cap: its middle and its size. A receiver's whole occlusion
// is one trilinear read. A baseline of the measurements only.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "baker/mesh.hpp"
#include "bench/paper/lab.hpp"

namespace dfield::kinds {

struct OcclusionGridParameters {
    std::uint32_t size = 32;   // nodes along each axis, 2 or more
    float margin = 0.6f;       // of the grid around the object's box, in longest sides of it
    std::uint32_t rays = 512;  // a node's, over the whole sphere
};

class OcclusionGrid {
  public:
    OcclusionGrid(const TriangleMesh& mesh, const OcclusionGridParameters& parameters);

    std::uint64_t memory_bytes() const { return nodes_.size() * sizeof(std::uint32_t); }

    // On the calling thread, with the machine's widest vectors. Beyond the grid a cap is that of the nearest
    // place in it, shrunk by the square of the distance from the object's middle.
    std::vector<float> visibility(const paper::Receivers& receivers) const;

    // Sines of half a cap's opening angle, and cosines between its middle and a normal, at the table's
    // entries.
    static constexpr std::int32_t kCapSizes = 64, kCapCosines = 65;

    // What the reading needs. Node coordinates: (point - origin) * to_nodes, 0 .. size - 1.
    struct View {
        const std::uint32_t*
            nodes;  // x fastest; bytes from the lowest: middle (x, y, z) * 127 + 128, size * 255
        std::int32_t size;
        glm::vec3 origin, to_nodes, middle;
        const float* table;  // occlusion by cap, sizes fastest
    };
    View view() const;

  private:
    std::uint32_t size_;
    glm::vec3 origin_, spacing_, middle_;
    std::vector<std::uint32_t> nodes_;
};

}  // namespace dfield::kinds
