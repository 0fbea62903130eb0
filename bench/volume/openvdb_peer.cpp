#include "bench/volume/openvdb_peer.hpp"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/FastSweeping.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>

#include "bench/common/turns.hpp"

namespace dfield::volumes {

std::string openvdb_version() {
    return openvdb::getLibraryVersionString();
}

PeerDistances openvdb_distances(const Subject& subject, double enough_seconds) {
    using Layout = openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ>;
    openvdb::initialize();
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    const auto last = [&](std::size_t axis) { return static_cast<int>(subject.volume.grid.size[axis]) - 1; };
    const openvdb::CoordBBox box(openvdb::Coord(0), openvdb::Coord(last(0), last(1), last(2)));
    std::vector<float> values = float_values(subject.volume);

    // Every voxel active: a value that none has stands for the background.
    const auto background = std::numeric_limits<float>::lowest();
    openvdb::FloatGrid fog(background);
    openvdb::tools::copyFromDense(Layout(box, values.data()), fog, 0.0f);

    PeerDistances result;
    result.seconds = std::numeric_limits<double>::infinity();
    openvdb::FloatGrid::Ptr distance;
    for (double spent = 0; spent == 0 || spent < enough_seconds;) {
        const double seconds =
            bench::seconds_of([&] { distance = openvdb::tools::fogToSdf(fog, subject.isovalue, 1); });
        result.seconds = std::min(result.seconds, seconds);
        spent += seconds;
    }
    result.distance = std::move(values);
    Layout out(box, result.distance.data());
    openvdb::tools::copyToDense(*distance, out);
    return result;
}

}  // namespace dfield::volumes
