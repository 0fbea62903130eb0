// The page's chapter about screen space.
#pragma once

#include "bench/screen/pieces.hpp"

namespace dfield::screens {

// Measures everything and writes it.
void write_screen(const Lab& lab, bench::Page& page);

}  // namespace dfield::screens
