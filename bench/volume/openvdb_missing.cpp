// In place of openvdb_peer.cpp where the library is missing.
#include <stdexcept>

#include "bench/volume/openvdb_peer.hpp"

namespace dfield::volumes {

std::string openvdb_version() {
    return "";
}

PeerDistances openvdb_distances(const Subject&, double) {
    throw std::logic_error("built without OpenVDB");
}

}  // namespace dfield::volumes
