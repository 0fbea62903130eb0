#include "baker/volume/teem.hpp"

#include <teem/biff.h>

#include <cstdlib>
#include <sstream>

namespace dfield {
namespace {

std::mutex teem_mutex;

}  // namespace

TeemLock::TeemLock() : lock_(teem_mutex) {}

TeemLock::~TeemLock() {
    if (biffCheck(NRRD) != 0) biffDone(NRRD);  // what nobody asked for
}

std::string TeemLock::error() const {
    std::string reason = "teem does not say why";
    if (biffCheck(NRRD) == 0) return reason;  // asked for messages that are not there, teem prints a warning
    const std::unique_ptr<char, decltype(&std::free)> said(biffGetDone(NRRD), &std::free);
    if (said == nullptr) return reason;
    std::istringstream lines(said.get());
    for (std::string line; std::getline(lines, line);) {
        if (const std::size_t name = line.find(": "); name != line.npos && line.starts_with("[nrrd]"))
            line.erase(0, name + 2);
        if (!line.empty() && line != "trouble") reason = line;
    }
    return reason;
}

}  // namespace dfield
