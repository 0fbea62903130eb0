#include "bench/paper/machine.hpp"

#include <embree3/rtcore.h>

#include <fstream>

namespace dfield::paper {

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

}  // namespace dfield::paper
