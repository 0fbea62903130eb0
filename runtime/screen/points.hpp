// The samples of the estimators that look up points of space: sections 4.1 to 4.4, and the ray march of 3.2.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <vector>

#include "screen/lattice.hpp"
#include "screen/measure.hpp"

namespace dfield::runtime::screen {

struct EstimateJob;
struct Settings;

// A point around s, its z along the normal, in units of R; and what the sample adds where the camera sees it:
// the integrand mu'(r) / r^2 (N.w)+ over the density, but for a factor that all samples share. MARCH: the end
// of a ray.
struct PointSample {
    glm::vec3 at;
    float weight;
};
PointSample point_sample(const Settings& settings, std::uint32_t index);

// A set for every pixel of the interleaved square. Rows of values of the columns of a square that go on for
// as many lanes as there may be: pixels side by side find theirs side by side, wherever they begin.
class PointSets {
  public:
    // None for DISK.
    PointSets(std::pmr::memory_resource* memory, const Settings& settings);

    std::uint32_t side() const { return side_; }
    std::uint32_t count() const { return count_; }
    // For pixels of a row of the picture from column 0 on: x, y, z and weight of every sample, each `width`
    // floats.
    const float* values(std::int32_t row) const {
        return values_.data() + static_cast<std::uint32_t>(row) % side_ * count_ * 4 * width_;
    }
    std::size_t width() const { return width_; }
    // What the sum of the weights of what is seen is divided by. 0: all is open.
    const float* divisors(std::int32_t row) const {
        return divisors_.data() + static_cast<std::uint32_t>(row) % side_ * width_;
    }
    // MARCH: how far along its ray each step is, and mu half a step before it.
    struct Step {
        float share, value;
    };
    const std::pmr::vector<Step>& steps() const { return steps_; }

  private:
    std::uint32_t side_, count_;
    std::size_t width_;
    std::pmr::vector<float> values_, divisors_;
    std::pmr::vector<Step> steps_;
};

// Rows of pixels of a lattice of side 1. Any threads. The reference is estimate_reference().
using PointsFunction = void(const EstimateJob& job, const Lattice& lattice, std::int32_t begin,
                            std::int32_t end);
// Null where there is none: the reference.
PointsFunction* points_function(std::int64_t targets);

}  // namespace dfield::runtime::screen
