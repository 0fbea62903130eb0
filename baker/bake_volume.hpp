// Baking occlusion volumes (format/occlusion_volume.hpp): the mesh as a distance field, its occlusion swept,
// and the balls that stand for it from afar.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "baker/bounding_sphere.hpp"
#include "baker/mesh.hpp"
#include "format/occlusion_volume.hpp"

namespace dfield {

struct VolumeParameters {
    std::uint32_t size = 32;  // samples along the grid's longest side, kSmallestVolume..kMaxVolumeSize

    bool operator==(const VolumeParameters&) const = default;
};
inline constexpr std::uint32_t kSmallestVolume = 12;

// Empty when such a volume can be baked, otherwise what is wrong and what is allowed.
std::string volume_parameters_error(const VolumeParameters& parameters);

// Bytes of a volume of a cube-shaped object, the most that one can have.
std::uint64_t volume_parameters_bytes(const VolumeParameters& parameters);

struct VolumeBakeOptions {
    VolumeParameters parameters;
    int threads = 0;                            // 0 = all cores; the result does not depend on it
    const std::atomic<bool>* cancel = nullptr;  // when set and true: ends early with Error(kInterrupted)
};

struct VolumeBakeReport {
    std::uint64_t rays = 0;  // and closest-point queries
    double build_seconds = 0, trace_seconds = 0;
};

// `sphere` is the mesh's bounding sphere. Matter is what samples_inside() (mesh_distance.hpp) holds for
// inside, and around every triangle a layer that a grid of this spacing can hold: so closed meshes are solid,
// and what is open, or thinner than a sample, is a shell. Throws InputError for parameters beyond the limits.
OcclusionVolume bake_volume(const TriangleMesh& mesh, const BoundingSphere& sphere,
                            const VolumeBakeOptions& options, VolumeBakeReport* report = nullptr);

}  // namespace dfield
