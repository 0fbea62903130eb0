// Dilation maps: depth maps of all points that are nearer to what a clip takes away than rays reach
// (algorithm 1 of the paper), and the mask of the voxels in between.
#pragma once

#include "volume/clip_coverage.hpp"

namespace dfield::runtime::volume {

class Dilation {
  public:
    // radius: of the camera's unit, as far as voxels can be that a clipped voxel has an influence on. The
    // maps of a probe tell the contraction: the inside of what they tell is out of reach of all that is
    // outside the mesh.
    Dilation(dfield_context* context, const dfield_clip_mesh& mesh, bool probe, double radius);

    // For this radius and no other.
    double radius() const { return radius_; }
    const dfield_clip_mesh* mesh() const { return mesh_; }
    bool probe() const { return probe_; }
    // Lines 26 and 27 of algorithm 2.
    bool affected(const CameraPoint& p) const {
        const DepthPixel* const pixel = maps_.at(p);
        return (pixel && pixel->between(p.z)) != probe_;
    }

  private:
    const dfield_clip_mesh* mesh_;
    bool probe_;
    double radius_;
    DepthMaps maps_;
};

// How far a clipped voxel's influence reaches in the camera of a clip: the rays' reach and what algorithm 1
// leaves out, the voxels around a sample and the anti-aliasing's samples; the pixels' size is the dilation's
// own affair.
double dilation_radius(const PlacedClip& clip, const Grid& grid, float reach, bool anti_aliased);

}  // namespace dfield::runtime::volume
