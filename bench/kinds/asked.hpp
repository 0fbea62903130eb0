// What the project asks of its kinds of section, as data: every measured figure is printed beside it.
#pragma once

#include <map>
#include <span>

#include "bench/common/asked.hpp"

namespace dfield::kinds {

enum class Figure {
    kMapsSpeedup,
    kLinesSpeedup,
    kDirectionsSpeedup,
    kDirectionsSpeedupAvx2,
    kDirectionsSpeedupHole,
    kDirectionsSpeedupMillion,
    kSmallErrorBunny,
    kSmallErrorIgea,
    kSmallErrorTree,
    kLargeErrorBunny,
    kLargeErrorIgea,
    kLargeErrorTree,
    kNonUniformScale,
    kMirroredScale,
    kCrowdSpeedup,
    kCrowdError,
    kSwarmSpeedup,
    kOneMoved,
    kFileBytes,
    kTwoThreads
};

inline constexpr double kSmallBytes = 160e3, kLargeBytes = 600e3;  // budgets in memory
inline constexpr double kLinesGrey = 2.2, kDirectionsGrey = 2.0;   // errors that speeds are asked at

struct Asked {
    Figure figure;
    const char* what;
    bench::Bound bound;
};
std::span<const Asked> asked();

// Figures that were measured; those of models that are missing are not.
using Measured = std::map<Figure, double>;

}  // namespace dfield::kinds
