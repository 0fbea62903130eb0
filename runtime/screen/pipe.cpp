#include "screen/pipe.hpp"

namespace dfield::runtime::screen {
namespace {

// Integral of sigma exp(-sigma r) / r^3 (a + b t) dt with t = rho tan(theta), which leaves the smooth
// sigma exp(-sigma rho / cos) (a cos + b rho sin) / rho^2 dtheta, by Gauss and Legendre's eight points.
float exponential_integral(float sigma, const Pipe& pipe, float low, float high) {
    const float rho = std::sqrt(pipe.rho2);
    const float from = std::atan(low / rho), to = std::atan(high / rho);
    const float middle = (from + to) / 2, half = (to - from) / 2;
    const auto at = [&](float theta) {
        const float cosine = std::cos(theta);
        return std::exp(-sigma * rho / cosine) * (pipe.a * cosine + pipe.b * rho * std::sin(theta));
    };
    float sum = 0;
    for (int i = 0; i < 4; ++i)
        sum += kGaussWeights[i] * (at(middle - kGaussNodes[i] * half) + at(middle + kGaussNodes[i] * half));
    return -sigma / std::expm1(-sigma) * sum * half / pipe.rho2;
}

}  // namespace

float pipe_integral(const Measure& measure, const Pipe& pipe, float low, float high) {
    const float rho2 = pipe.rho2, a = pipe.a, b = pipe.b;
    if (!(low < high)) return 0;
    const auto r = [&](float t) { return std::sqrt(rho2 + t * t); };
    switch (measure.kind) {
        case DFIELD_MEASURE_QUARTIC:  // mu' / r^3 = 4
            return 4 * (high - low) * (a + b * (high + low) / 2);
        case DFIELD_MEASURE_QUADRATIC: {  // 2 / r^2
            const float rho = std::sqrt(rho2);
            return 2 * (a / rho * (std::atan(high / rho) - std::atan(low / rho)) +
                        b * std::log(r(high) / r(low)));
        }
        case DFIELD_MEASURE_LINEAR:  // 1 / r^3
            return a / rho2 * (high / r(high) - low / r(low)) - b * (1 / r(high) - 1 / r(low));
        default:
            return exponential_integral(measure.sigma, pipe, low, high);
    }
}

}  // namespace dfield::runtime::screen
