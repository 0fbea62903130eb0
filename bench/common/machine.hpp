// What the figures were measured on.
#pragma once

#include <string>

namespace dfield::bench {

std::string processor_name();    // as the system states it
std::string compiler_version();  // that built this program
std::string embree_version();    // of the library that runs

// How many times the arithmetic of one thread two threads do at once: about 2 on two cores, about 1 where
// they are hyperthreads of one core, whatever the system calls them. A tenth of a second; on a quiet machine.
double gain_of_two_threads();

}  // namespace dfield::bench
