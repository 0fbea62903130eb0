// How much of a voxel is left: anti-aliased shadow test clipping (algorithm 2 of the paper), for blocks of
// voxels.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "volume/clip_mesh.hpp"
#include "volume/grid.hpp"
#include "volume/opacity.hpp"

namespace dfield::runtime::volume {

// A mesh at its place, from voxels to its camera: camera = column[0] x + column[1] y + column[2] z + origin.
struct PlacedClip {
    const dfield_clip_mesh* mesh = nullptr;
    bool probe = false;
    glm::dvec3 column[3], origin;

    // Throws Failure where the transform is not affine and invertible.
    PlacedClip(const dfield_clip& clip, const Grid& grid);

    CameraPoint to_camera(double x, double y, double z) const {
        return column[0] * x + column[1] * y + column[2] * z + origin;
    }
    // Half the size of the camera's box around a box of voxels.
    glm::dvec3 half_box(double x, double y, double z) const {
        return glm::abs(column[0]) * x + glm::abs(column[1]) * y + glm::abs(column[2]) * z;
    }
    bool clips(const CameraPoint& p) const { return mesh->inside(p) != probe; }
    // The voxels that can be on the mesh's inside: [low, high), within the grid; a margin wider than samples
    // reach.
    void bounds(const Grid& grid, std::size_t low[3], std::size_t high[3]) const;
};

// Points between voxels, in voxels.
struct ClipPoints {
    const double *x, *y, *z;
    std::size_t count;
};
// Sets seen[i] to 0 where the clip takes point i away. Every level has the same results, to the last bit.
using ClipFunction = void(const PlacedClip& clip, const ClipPoints& points, std::uint8_t* seen);
ClipFunction* clip_function(std::int64_t targets);
void clip_reference(const PlacedClip& clip, const ClipPoints& points, std::uint8_t* seen);

// A voxel's byte: of `all` samples so many are left.
class Coverage {
  public:
    // samples: N; 0: by voxels' centres.
    Coverage(dfield_context* context, std::size_t samples);

    std::uint8_t all() const { return all_; }
    float share(std::uint8_t left) const { return shares_[left]; }

    // Algorithm 2 at one voxel, as it stands.
    std::uint8_t of_voxel(std::span<const PlacedClip> clips, std::size_t x, std::size_t y,
                          std::size_t z) const;
    // The same for the block of voxels from (x, y, z) on, rows of kBlockX; false where it is full all over
    // (and `left` not written).
    bool of_block(std::span<const PlacedClip> clips, std::size_t x, std::size_t y, std::size_t z,
                  std::uint8_t* left) const;

  private:
    void of_brick(std::span<const PlacedClip* const> clips, std::size_t x, std::size_t y, std::size_t z,
                  std::uint8_t* left) const;

    std::size_t samples_;
    std::uint8_t all_;
    ClipFunction* clip_;
    std::pmr::vector<double> offsets_[3];  // of the N further samples
    std::pmr::vector<float> shares_;
};

}  // namespace dfield::runtime::volume
