#include "bench/common/machine.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <thread>

namespace dfield::bench {
namespace {

// Enough independent chains in registers to keep every multiplier and adder busy. The result depends on all.
double arithmetic() {
    std::array<double, 24> chains{};
    for (int i = 0; i < 4000000; ++i)
        for (double& chain : chains) chain = chain * 0.999 + 1;
    double sum = 0;
    for (const double chain : chains) sum += chain;
    return sum;
}

double seconds_of_arithmetic(int threads) {
    const auto start = std::chrono::steady_clock::now();
    std::array<double, 2> results{};
    std::thread other;
    if (threads == 2) other = std::thread([&] { results[1] = arithmetic(); });
    results[0] = arithmetic();
    if (other.joinable()) other.join();
    volatile double used = results[0] + results[1];
    (void)used;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

double gain_of_two_threads() {
    double one = seconds_of_arithmetic(1), two = seconds_of_arithmetic(2);
    for (int i = 0; i < 4; ++i) {
        one = std::min(one, seconds_of_arithmetic(1));
        two = std::min(two, seconds_of_arithmetic(2));
    }
    return 2 * one / two;
}

std::string processor_name() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);)
        if (line.starts_with("model name"))
            if (const auto colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
    return "unnamed processor";
}

std::string compiler_version() {
#if defined(__clang__)
    return std::string("clang++ ") + __clang_version__;
#elif defined(__GNUC__)
    return std::string("g++ ") + __VERSION__;
#else
    return "unnamed compiler";
#endif
}

std::string embree_version() {
    const RTCDevice device = rtcNewDevice(nullptr);
    if (!device) return "unknown";
    const auto part = [&](RTCDeviceProperty property) {
        return std::to_string(rtcGetDeviceProperty(device, property));
    };
    const std::string version = part(RTC_DEVICE_PROPERTY_VERSION_MAJOR) + "." +
                                part(RTC_DEVICE_PROPERTY_VERSION_MINOR) + "." +
                                part(RTC_DEVICE_PROPERTY_VERSION_PATCH);
    rtcReleaseDevice(device);
    return version;
}

}  // namespace dfield::bench
