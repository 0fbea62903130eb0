#include "bench/common/turns.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

namespace dfield::bench {

double seconds_of(const std::function<void()>& run) {
    const auto start = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<double> fastest_turns(std::span<const std::function<void()>> contestants, int rounds) {
    std::vector<double> seconds(contestants.size(), std::numeric_limits<double>::infinity());
    for (int round = 0; round < rounds; ++round)
        for (std::size_t i = 0; i < contestants.size(); ++i)
            seconds[i] = std::min(seconds[i], seconds_of(contestants[i]));
    return seconds;
}

}  // namespace dfield::bench
