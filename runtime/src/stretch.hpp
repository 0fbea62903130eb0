// Bounds of linear maps.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

namespace dfield::runtime {

// Of `m`, by how much it stretches at most; exact for rotation times even scale.
inline float stretch(const glm::mat3& m) {
    float bound = 0;
    for (int i = 0; i < 3; ++i) {
        float row = 0;
        for (int j = 0; j < 3; ++j) row += std::fabs(glm::dot(m[i], m[j]));
        bound = std::max(bound, row);
    }
    return std::sqrt(bound);
}

}  // namespace dfield::runtime
