// Angles without trigonometric library calls: what the inverses of both parameterizations need, cheap enough
// for every ray. Only inverses may use these; sample points and directions come from exact formulas
// (FORMAT.md).
#pragma once

#include <cmath>

namespace dfield {

// atan(x) * 2/pi for x in [-1, 1]: the fraction of a quarter turn. Odd minimax polynomial, |error| < 1.1e-6
// quarter turns.
inline float quarter_turns_of_slope(float x) {
    const float y = x * x;
    return x * (0.636605296f +
                y * (-0.211754678f +
                     y * (0.123213593f + y * (-0.0741234672f + y * (0.0335201446f + y * -0.00746194768f)))));
}

// The angle of (x, y) in quarter turns, in [0, 4). (0, 0) gives 0.
inline float quarter_turns(float x, float y) {
    const float ax = std::fabs(x), ay = std::fabs(y);
    const float larger = ax > ay ? ax : ay;
    const float slope = larger > 0 ? (ax > ay ? ay : ax) / larger : 0.0f;
    float turns = quarter_turns_of_slope(slope);
    if (ay > ax) turns = 1 - turns;
    if (x < 0) turns = 2 - turns;
    if (y < 0) turns = 4 - turns;
    return turns < 4 ? turns : 0.0f;
}

}  // namespace dfield
