// A signed distance field on a grid, read between its voxels.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "volume/grid.hpp"

namespace dfield::runtime::volume {

// Where a point lies among eight voxels: that of the lowest corner and the fractions to the highest. Points
// beyond the grid are moved to its border; an axis of one voxel has both corners in it.
struct Cell {
    std::size_t corner[2][3];
    float fraction[3];

    Cell(const Grid& grid, const glm::vec3& point) {
        place(0, point.x / grid.hx, grid.nx);
        place(1, point.y / grid.hy, grid.ny);
        place(2, point.z / grid.hz, grid.nz);
    }
    // The trilinear blend of value(x, y, z) at the corners.
    template<class Value>
    float blend(const Value& value) const {
        const auto along_x = [&](int j, int k) {
            const float low = value(corner[0][0], corner[j][1], corner[k][2]);
            const float high = value(corner[1][0], corner[j][1], corner[k][2]);
            return low + fraction[0] * (high - low);
        };
        const auto along_y = [&](int k) {
            const float low = along_x(0, k);
            return low + fraction[1] * (along_x(1, k) - low);
        };
        const float low = along_y(0);
        return low + fraction[2] * (along_y(1) - low);
    }

  private:
    void place(int axis, float at, std::size_t n) {
        const float inside = std::clamp(at, 0.0f, static_cast<float>(n - 1));
        const std::size_t low = std::min(static_cast<std::size_t>(inside), n > 1 ? n - 2 : 0);
        corner[0][axis] = low;
        corner[1][axis] = std::min(low + 1, n - 1);
        fraction[axis] = inside - static_cast<float>(low);
    }
};

struct SignedField {
    Grid grid;
    const float* distance = nullptr;  // > 0 outside

    float at(std::size_t x, std::size_t y, std::size_t z) const { return distance[grid.index(x, y, z)]; }
    // Trilinear.
    float at(const glm::vec3& point) const {
        return Cell(grid, point).blend([this](auto x, auto y, auto z) { return at(x, y, z); });
    }
    // The gradient at a voxel by central differences, one-sided at the border.
    glm::vec3 gradient(std::size_t x, std::size_t y, std::size_t z) const {
        const auto slope = [](std::size_t i, std::size_t n, float h, const auto& value) {
            const std::size_t low = i > 0 ? i - 1 : 0, high = std::min(i + 1, n - 1);
            return high > low ? (value(high) - value(low)) / (static_cast<float>(high - low) * h) : 0.0f;
        };
        return {slope(x, grid.nx, grid.hx, [&](std::size_t i) { return at(i, y, z); }),
                slope(y, grid.ny, grid.hy, [&](std::size_t i) { return at(x, i, z); }),
                slope(z, grid.nz, grid.hz, [&](std::size_t i) { return at(x, y, i); })};
    }
    // Trilinear between the voxels' gradients.
    glm::vec3 gradient(const glm::vec3& point) const {
        const Cell cell(grid, point);
        glm::vec3 result;
        for (int axis = 0; axis < 3; ++axis)
            result[axis] = cell.blend([&](auto x, auto y, auto z) { return gradient(x, y, z)[axis]; });
        return result;
    }
};

}  // namespace dfield::runtime::volume
