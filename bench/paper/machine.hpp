// What the figures were measured on.
#pragma once

#include <string>

namespace dfield::paper {

std::string processor_name();    // as the system states it
std::string compiler_version();  // that built this program
std::string embree_version();    // of the library that runs

}  // namespace dfield::paper
