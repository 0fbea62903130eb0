// The page's chapter "Sweeping volumes".
#pragma once

#include "bench/volume/pieces.hpp"

namespace dfield::volumes {

// Measures the pieces that `wanted` names, all where it is empty, into `figures`; those of other pieces stay.
// What it is at goes to stderr. Throws std::invalid_argument for a name that no piece has.
void measure_pieces(Lab& lab, std::span<const std::string> wanted, Json& figures);

// The chapter from the figures; says what is missing.
void write_volumes(const Json& figures, bool quick, bench::Page& page);

}  // namespace dfield::volumes
