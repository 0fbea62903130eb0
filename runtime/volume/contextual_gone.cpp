// Voxels that nothing is left of and that no trilinear reading of what is left meets: their factor is 1.
#include <algorithm>
#include <cstring>

#include "volume/contextual.hpp"

namespace dfield::runtime::volume {
namespace {

// Whether anything is left in rows y - 1 .. y + 1 of slices z - 1 .. z + 1 at x - 1 .. x + 1.
bool any_left(const Grid& grid, const std::uint8_t* left, std::size_t x, std::size_t y, std::size_t z,
              std::size_t end_x, std::size_t end_y, std::size_t end_z) {
    const auto low = [](std::size_t i) { return i > 0 ? i - 1 : 0; };
    const std::size_t x0 = low(x), x1 = std::min(end_x + 1, grid.nx);
    for (std::size_t k = low(z); k < std::min(end_z + 1, grid.nz); ++k)
        for (std::size_t j = low(y); j < std::min(end_y + 1, grid.ny); ++j) {
            const std::uint8_t* const row = left + grid.index(0, j, k);
            std::uint8_t all = 0;
            for (std::size_t i = x0; i < x1; ++i) all |= row[i];
            if (all != 0) return true;
        }
    return false;
}

}  // namespace

bool block_is_gone(const Grid& grid, const std::uint8_t* left, std::size_t x, std::size_t y, std::size_t z) {
    return !any_left(grid, left, x, y, z, std::min(x + kBlockX, grid.nx), std::min(y + kBlockY, grid.ny),
                     std::min(z + kBlockZ, grid.nz));
}

void open_gone_voxels(const Grid& grid, const std::uint8_t* left, std::size_t x, std::size_t y, std::size_t z,
                      float* visibility) {
    const std::size_t end_x = std::min(x + kBlockX, grid.nx);
    for (std::size_t k = z; k < std::min(z + kBlockZ, grid.nz); ++k)
        for (std::size_t j = y; j < std::min(y + kBlockY, grid.ny); ++j) {
            const std::uint8_t* const row = left + grid.index(0, j, k);
            if (std::memchr(row + x, 0, end_x - x) == nullptr) continue;
            for (std::size_t i = x; i < end_x; ++i)
                if (row[i] == 0 && !any_left(grid, left, i, j, k, i + 1, j + 1, k + 1))
                    visibility[grid.index(i, j, k)] = 1;
        }
}

}  // namespace dfield::runtime::volume
