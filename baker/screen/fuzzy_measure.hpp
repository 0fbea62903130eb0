// The fuzzy measure mu: how much a direction whose first surface lies at distance r belongs to the open ones.
// L. Szirmay-Kalos et al., "GPU-based Ambient Occlusion and Indirect Illumination", section 2.
#pragma once

#include <algorithm>
#include <cmath>

namespace dfield {

enum class MeasureShape { kQuartic, kQuadratic, kLinear, kExponential };

struct FuzzyMeasure {
    MeasureShape shape = MeasureShape::kQuartic;
    double radius = 1;  // world units: mu is 1 from here on
    double sigma = 1;   // exponential: extinction a world unit, above 0

    // 0 at 0, 1 at the radius and beyond, never falling. The exponential is divided by its value at the
    // radius, where it is cut off.
    double operator()(double r) const {
        if (!(radius > 0)) return 1;
        const double x = std::clamp(r / radius, 0.0, 1.0);
        switch (shape) {
            case MeasureShape::kQuartic:
                return x * x * x * x;
            case MeasureShape::kQuadratic:
                return x * x;
            case MeasureShape::kLinear:
                return x;
            case MeasureShape::kExponential:
                return std::expm1(-sigma * radius * x) / std::expm1(-sigma * radius);
        }
        return x;
    }
};

}  // namespace dfield
