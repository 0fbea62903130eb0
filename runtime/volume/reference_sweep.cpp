// The job of sweep.hpp by the reference algorithms.
#include <algorithm>
#include <cmath>
#include <limits>

#include "volume/occlusion.hpp"
#include "volume/reference.hpp"
#include "volume/sweep.hpp"

namespace dfield::runtime::volume {

SweepResult sweep_distance_reference(const DistanceJob& job) {
    const Grid& grid = job.grid;
    if (job.samples.type == SampleType::kF32)
        for (std::size_t z = 0; z < grid.nz; ++z)
            for (std::size_t y = 0; y < grid.ny; ++y)
                for (std::size_t x = 0; x < grid.nx; ++x)
                    if (!std::isfinite(job.samples.above(x, y, z))) return SweepResult::kNotFinite;

    reference::Distances field = reference::initialise(grid, job.samples);
    const reference::Ordinate even{1.0f / 3, 1.0f / 3, 1.0f / 3};
    std::vector<float> visibility(job.carried == Carried::kNone ? 0 : grid.size()), tau(visibility.size());
    if (job.carried == Carried::kCombined) std::fill_n(job.combined, grid.size(), 0.0f);
    for (const std::size_t s : kSweepOrder) {
        reference::sweep_distance(field, kSweeps[s]);
        if (job.carried == Carried::kNone) continue;
        // Embedded: the transmittance needs no more of the field than its first step has set.
        for (std::size_t i = 0; i < grid.size(); ++i)
            tau[i] = reference::transmittance(field.signed_at(i) / grid.h(), kPaperShift, job.alpha);
        reference::sweep_visibility(grid, kSweeps[s], even, tau.data(), visibility.data());
        for (std::size_t i = 0; i < grid.size(); ++i) {
            if (job.carried == Carried::kCombined)
                job.combined[i] += job.intensities[s] * visibility[i];
            else
                job.octants[4 * (s / 4 * grid.size() + i) + s % 4] =
                    static_cast<std::uint8_t>(std::lround(255 * visibility[i]));
        }
    }
    for (std::size_t i = 0; i < grid.size(); ++i) {
        const float far = std::numeric_limits<float>::infinity();
        const float d = std::min(field.d[i] >= kFar ? far : field.d[i], job.band);
        job.distance[i] = field.inside[i] ? -d : d;
    }
    return SweepResult::kDone;
}

}  // namespace dfield::runtime::volume
