// OpenVDB's fast sweeping, the peer of distance fields.
#pragma once

#include <string>
#include <vector>

#include "bench/volume/subjects.hpp"

namespace dfield::volumes {

// The library's version; empty where this program was built without it.
std::string openvdb_version();

struct PeerDistances {
    double seconds = 0;           // of the fastest call of fogToSdf, in one thread
    std::vector<float> distance;  // a float a voxel, in voxels, < 0 inside
};

// openvdb::tools::fogToSdf on all voxels as a grid of floats, one round of eight sweeps. Making that grid out
// of the volume and a volume out of its result is not counted. Calls are repeated until `enough_seconds` have
// been spent. Spacing is not looked at. Throws std::logic_error without the library.
PeerDistances openvdb_distances(const Subject& subject, double enough_seconds);

}  // namespace dfield::volumes
