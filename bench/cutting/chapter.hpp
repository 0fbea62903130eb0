// The page's chapter "Cutting volumes".
#pragma once

#include "bench/volume/chapter.hpp"

namespace dfield::cutting {

const volumes::Chapter& cutting_chapter();

}  // namespace dfield::cutting
