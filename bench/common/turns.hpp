// Times that a busy machine does not spoil.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace dfield::bench {

double seconds_of(const std::function<void()>& run);

// The contestants take turns, and the seconds of each one's fastest turn are returned.
std::vector<double> fastest_turns(std::span<const std::function<void()>> contestants, int rounds);

}  // namespace dfield::bench
