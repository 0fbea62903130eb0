// DISK, vectorised. The reference is estimate_reference().
#pragma once

#include "screen/estimate.hpp"
#include "screen/lattice.hpp"

namespace dfield::runtime::screen {

// Pixels of some rows. Any threads.
using DiskFunction = void(const EstimateJob& job, const Lattice& lattice, std::int32_t begin,
                          std::int32_t end);
// Null where there is none: the reference.
DiskFunction* disk_function(std::int64_t targets, dfield_fuzzy_measure measure);
// Of all measures but the quartic one.
DiskFunction* disk_measures_function(std::int64_t targets);

}  // namespace dfield::runtime::screen
