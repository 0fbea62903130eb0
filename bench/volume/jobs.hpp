// What is timed: sweeps of a volume into memory at hand.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "baker/cli/volume_sweep.hpp"
#include "bench/volume/subjects.hpp"

namespace dfield::volumes {

enum class Job {
    kDistance,  // the distance field alone
    kCombined,  // and the paper's combined visibility
    kOctants,   // and the paper's eight octants, as its textures
    kPaper,     // and from these the visibility by the gradient
    kImproved,  // and visibility in the improved form, 24 ordinates
};
const char* name_of(Job job);

// Outputs of all jobs, touched once so that no job pays for fresh pages. Sweepers of other volumes may use
// them too, if they have no more voxels.
class JobOutputs {
  public:
    explicit JobOutputs(std::size_t voxels);

    // Runs the job; the subject's isovalue is the caller's affair.
    void run(const cli::VolumeSweeper& sweeper, float isovalue, Job job);
    static std::size_t bytes_a_voxel(Job job);
    const std::vector<float>& distance() const { return distance_; }

  private:
    std::vector<float> distance_, visibility_;
    std::vector<std::uint8_t> octants_;
};

// No hooks, and a cap on the instruction set.
dfield_context_desc capped(dfield_simd simd);

// Seconds of each job on the subject, one thread; jobs take turns.
std::vector<double> job_seconds(const Subject& subject, std::span<const Job> jobs, int rounds);

}  // namespace dfield::volumes
