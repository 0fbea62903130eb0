// The lookup as the paper describes it, with each of this project's additions to be switched on: what the
// additions are worth is measured with it. Nothing here is fast.
#pragma once

#include <vector>

#include "bench/paper/lab.hpp"

namespace dfield::paper {

// What a ray that starts inside the bounding sphere makes of the first hit on its line when that lies behind
// it.
enum class Behind {
    kMiss,     // takes it for a miss
    kHit,      // takes it for a hit
    kBackward  // looks from the line's exit point back, which gives the last hit on the line, and decides by
               // that
};

struct LookupRules {
    bool pivot = false;  // aim from the sample at the middle of the chord, not along the ray
    Behind behind = Behind::kMiss;
};

// Visibility of the receivers past an object with an 8-bit field, unbounded.
std::vector<float> plain_visibility(const DisplacementField& field, const Receivers& receivers,
                                    const Directions& directions, const LookupRules& rules);

}  // namespace dfield::paper
