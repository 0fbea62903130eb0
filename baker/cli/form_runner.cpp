#include "baker/cli/form_runner.hpp"

#include <algorithm>

namespace dfield::cli {

dfield_volume_points points_at(const std::vector<float>& positions) {
    dfield_volume_points points{};
    points.count = positions.size() / 3;
    points.positions = positions.data();
    return points;
}

FormRunner::FormRunner(const VolumeSweeper& sweeper, int repetitions)
    : sweeper_(sweeper),
      repetitions_(repetitions),
      distance_(sweeper.voxels()),
      visibility_(sweeper.voxels()) {}

double FormRunner::sweep(const dfield_sweep_desc& desc) {
    const bool paper = desc.form == DFIELD_FORM_PAPER;
    if (paper) octants_.resize(8 * sweeper_.voxels());
    dfield_sweep_outputs outputs = no_sweep_outputs();
    outputs.distance = distance_.data();
    outputs.visibility = visibility_.data();
    if (paper) outputs.octants = octants_.data();
    double seconds = sweeper_.sweep(desc, outputs);
    for (int i = 1; i < repetitions_; ++i) seconds = std::min(seconds, sweeper_.sweep(desc, outputs));
    return seconds;
}

std::vector<float> FormRunner::at(const dfield_sweep_desc& desc, const dfield_volume_points& points) const {
    std::vector<float> found(points.count);
    const VolumeField field = sweeper_.field(distance_.data());
    if (desc.form == DFIELD_FORM_PAPER)
        field.gather_octants(octants_.data(), points, found.data());
    else
        field.interpolate(visibility_.data(), points, found.data());
    return found;
}

}  // namespace dfield::cli
