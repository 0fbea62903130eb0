// From the octants' visibility to one number a voxel: equations 3 and 4 with the field's gradient as normal.
#pragma once

#include <array>
#include <cstdint>

#include "context.hpp"
#include "volume/grid.hpp"

namespace dfield::runtime::volume {

struct EvaluationJob {
    dfield_context* context = nullptr;
    Grid grid;
    const float* distance = nullptr;
    const std::uint8_t* octants = nullptr;  // as DistanceJob::octants
    std::array<float, kOctants> intensities{1, 1, 1, 1, 1, 1, 1, 1};
    bool through = false;         // |N.w| for the geometry term (section 4.2)
    float* visibility = nullptr;  // out, a float a voxel: sum of intensity V_s G_s(N) over the sum of G_s(N)
};

using EvaluationFunction = void(const EvaluationJob& job);
// Within kEvaluationError of the reference.
EvaluationFunction* evaluation_function(std::int64_t targets);
void evaluate_reference(const EvaluationJob& job);
constexpr float kEvaluationError = 1e-3f;

// A <- A^(1 / gamma) (section 3).
void apply_gamma(const dfield_context& context, float gamma, float* visibility, std::size_t count);

}  // namespace dfield::runtime::volume
