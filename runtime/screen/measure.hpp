// Fuzzy measures of distances in units of R: mu(0) = 0, mu(1) = 1.
#pragma once

#include <cmath>

#include "dfield/screen.h"

namespace dfield::runtime::screen {

struct Measure {
    dfield_fuzzy_measure kind = DFIELD_MEASURE_QUARTIC;
    float sigma = 1;  // EXPONENTIAL: extinction a radius

    float value(float r) const {
        if (r >= 1) return 1;
        switch (kind) {
            case DFIELD_MEASURE_QUARTIC:
                return r * r * (r * r);
            case DFIELD_MEASURE_QUADRATIC:
                return r * r;
            case DFIELD_MEASURE_LINEAR:
                return r;
            default:
                return std::expm1(-sigma * r) / std::expm1(-sigma);
        }
    }

    // d mu / dr
    float derivative(float r) const {
        switch (kind) {
            case DFIELD_MEASURE_QUARTIC:
                return 4 * r * r * r;
            case DFIELD_MEASURE_QUADRATIC:
                return 2 * r;
            case DFIELD_MEASURE_LINEAR:
                return 1;
            default:
                return -sigma * std::exp(-sigma * r) / std::expm1(-sigma);
        }
    }

    float inverse(float value) const {
        switch (kind) {
            case DFIELD_MEASURE_QUARTIC:
                return std::sqrt(std::sqrt(value));
            case DFIELD_MEASURE_QUADRATIC:
                return std::sqrt(value);
            case DFIELD_MEASURE_LINEAR:
                return value;
            default:
                return -std::log1p(value * std::expm1(-sigma)) / sigma;
        }
    }

    // What section 4.4's integral over the tangent sphere gives where all is open:
    // 1/pi integral of mu(cos) dw = 2 integral_0^1 mu(c) dc.
    float tangent_total() const {
        switch (kind) {
            case DFIELD_MEASURE_QUARTIC:
                return 0.4f;
            case DFIELD_MEASURE_QUADRATIC:
                return 2.0f / 3;
            case DFIELD_MEASURE_LINEAR:
                return 1;
            default:
                return static_cast<float>(
                    2 * (-1 / std::expm1(-static_cast<double>(sigma)) - 1 / static_cast<double>(sigma)));
        }
    }
};

}  // namespace dfield::runtime::screen
