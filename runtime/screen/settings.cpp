#include <algorithm>

#include "screen/checks.hpp"
#include "screen/estimate.hpp"

namespace dfield::runtime::screen {
namespace {

Measure measure_of(const dfield_screen_desc& desc) {
    Measure measure{static_cast<dfield_fuzzy_measure>(desc.measure), desc.sigma * desc.radius};
    constexpr float kLeast = 1e-3f, kMost = 1e3f;  // a straight line, and a step
    if (measure.kind == DFIELD_MEASURE_EXPONENTIAL && measure.sigma < kLeast)
        measure.kind = DFIELD_MEASURE_LINEAR;
    measure.sigma = std::min(measure.sigma, kMost);
    return measure;
}

}  // namespace

Settings::Settings(const dfield_screen_desc* given) : desc(checked_desc(given)), measure(measure_of(desc)) {}

SampleSets<DiskSample> Settings::disk_sets(std::pmr::memory_resource* memory) const {
    return {memory, desc.interleave, disk() ? desc.samples : 0, [this](std::uint32_t index) {
                const auto point = sobol_point(index, desc.seed);
                const glm::vec2 uniform = concentric_disk(point[0], point[1]);
                if (!ratio()) return DiskSample{uniform.x, uniform.y, 1};
                // A density of 1 - rho^2, as the pipes above an open plane have it: rho^2 = 1 - sqrt(1 - u).
                const float u = uniform.x * uniform.x + uniform.y * uniform.y, inner = std::sqrt(1 - u);
                const float scale = std::sqrt(1 / (1 + inner));  // sqrt((1 - inner) / u)
                return DiskSample{uniform.x * scale, uniform.y * scale, 1 / inner};
            }};
}

}  // namespace dfield::runtime::screen
