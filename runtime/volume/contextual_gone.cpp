// Voxels that nothing is left of and that no trilinear reading of what is left meets: their factor is 1.
#include <algorithm>
#include <cstring>

#include "volume/contextual.hpp"

namespace dfield::runtime::volume {
bool block_is_gone(const Grid& grid, const std::uint8_t* left, std::size_t x, std::size_t y, std::size_t z) {
    const auto before = [](std::size_t i) { return i > 0 ? i - 1 : 0; };
    const std::size_t begin = before(x), count = std::min(x + kBlockX + 1, grid.nx) - begin;
    for (std::size_t k = before(z); k < std::min(z + kBlockZ + 1, grid.nz); ++k)
        for (std::size_t j = before(y); j < std::min(y + kBlockY + 1, grid.ny); ++j) {
            const std::uint8_t* const row = left + grid.index(begin, j, k);
            std::uint8_t all = 0;
            for (std::size_t i = 0; i < count; ++i) all |= row[i];
            if (all != 0) return false;
        }
    return true;
}

void open_gone_voxels(const Grid& grid, const std::uint8_t* left, std::size_t x, std::size_t y, std::size_t z,
                      float* visibility) {
    const std::size_t nx = std::min(kBlockX, grid.nx - x);
    for (std::size_t k = z; k < std::min(z + kBlockZ, grid.nz); ++k)
        for (std::size_t j = y; j < std::min(y + kBlockY, grid.ny); ++j) {
            if (std::memchr(left + grid.index(x, j, k), 0, nx) == nullptr) continue;
            // What is left of the nine rows around, from x - 1 on; then of three voxels along x.
            std::uint8_t column[kBlockX + 2] = {};
            const std::size_t before = x > 0 ? 1 : 0, count = std::min(nx + 1, grid.nx - x) + before;
            for (std::size_t kk = k > 0 ? k - 1 : 0; kk < std::min(k + 2, grid.nz); ++kk)
                for (std::size_t jj = j > 0 ? j - 1 : 0; jj < std::min(j + 2, grid.ny); ++jj) {
                    const std::uint8_t* const row = left + grid.index(x - before, jj, kk);
                    for (std::size_t i = 0; i < count; ++i) column[i + 1 - before] |= row[i];
                }
            float* const out = visibility + grid.index(x, j, k);
            for (std::size_t i = 0; i < nx; ++i)
                if ((column[i] | column[i + 1] | column[i + 2]) == 0) out[i] = 1;
        }
}

}  // namespace dfield::runtime::volume
