// What the project asks of local and contextual ambient occlusion.
#pragma once

#include "bench/volume/asked.hpp"

namespace dfield::cutting {

std::span<const volumes::Asked> asked();

}  // namespace dfield::cutting
