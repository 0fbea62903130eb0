// Forms of sweeping side by side, at points of one volume's isosurface.
#pragma once

#include <vector>

#include "baker/cli/volume_sweep.hpp"

namespace dfield::cli {

// Points as 3 floats each, without normals.
dfield_volume_points points_at(const std::vector<float>& positions);

// What each form finds at the points: the paper's by its octants there, the others in their volumes.
class FormRunner {
  public:
    // The sweeper is the caller's. The fastest of `repetitions` sweeps counts.
    FormRunner(const VolumeSweeper& sweeper, int repetitions);

    const std::vector<float>& distance() const { return distance_; }      // of the last sweep
    const std::vector<float>& visibility() const { return visibility_; }  // likewise

    double sweep(const dfield_sweep_desc& desc);  // the seconds of the fastest
    // After a sweep by the same form.
    std::vector<float> at(const dfield_sweep_desc& desc, const dfield_volume_points& points) const;

  private:
    const VolumeSweeper& sweeper_;
    int repetitions_;
    std::vector<float> distance_, visibility_;
    std::vector<std::uint8_t> octants_;
};

}  // namespace dfield::cli
