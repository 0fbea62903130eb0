// Lines of a slab as one caster's maps see them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>

#include "batch/chunk.hpp"
#include "batch/confirm.hpp"

namespace dfield::runtime {

// For each line: texel coordinates u = row[0] x + row[1] y + row[2] z + row[3] of a world position.
struct PreparedLines {
    using Row = std::array<float, kSlab>;
    std::uint32_t clusters = 0;  // that have been prepared; 0 it with every caster and slab
    alignas(64) std::array<Row, 4> u, v;
    alignas(64) std::array<Row, 3> direction;  // the stored one, unit space
    alignas(64) std::array<std::uint32_t, kSlab> index;

    MapPlace place(std::size_t k, const glm::vec3& position, const Instance& instance) const {
        const auto coordinate = [&](const std::array<Row, 4>& row) {
            return row[0][k] * position.x + row[1][k] * position.y + row[2][k] * position.z + row[3][k];
        };
        const glm::vec3 d(direction[0][k], direction[1][k], direction[2][k]);
        return {index[k], std::max(coordinate(u), 0.0f), std::max(coordinate(v), 0.0f),
                glm::dot(d, instance.carry_point(position)), d};
    }
};

}  // namespace dfield::runtime
