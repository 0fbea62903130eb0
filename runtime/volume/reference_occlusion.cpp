#include <algorithm>

#include "volume/reference.hpp"

namespace dfield::runtime::volume::reference {

float transmittance(float distance_in_h, float shift, float alpha) {
    const float tau = std::clamp(distance_in_h + shift, 0.0f, 1.0f);  // equation 7
    return 1 - (1 - tau) * alpha;                                     // equation 8
}

void sweep_visibility(const Grid& g, const Sweep& sweep, const Ordinate& ordinate, const float* transmittance,
                      float* visibility) {
    // V tau of the neighbour one step back along an axis of n vertices.
    const auto light = [&](std::size_t at, int direction, std::size_t n, std::size_t stride, std::size_t p) {
        if (at == (direction > 0 ? 0 : n - 1)) return 1.0f;
        const std::size_t neighbour = direction > 0 ? p - stride : p + stride;
        return visibility[neighbour] * transmittance[neighbour];
    };
    for (std::size_t k = 0; k < g.nz; ++k)
        for (std::size_t j = 0; j < g.ny; ++j)
            for (std::size_t i = 0; i < g.nx; ++i) {
                const std::size_t x = sweep.x > 0 ? i : g.nx - 1 - i;
                const std::size_t y = sweep.y > 0 ? j : g.ny - 1 - j;
                const std::size_t z = sweep.z > 0 ? k : g.nz - 1 - k;
                const std::size_t p = g.index(x, y, z);
                visibility[p] = ordinate.wx * light(x, sweep.x, g.nx, 1, p) +
                                ordinate.wy * light(y, sweep.y, g.ny, g.nx, p) +
                                ordinate.wz * light(z, sweep.z, g.nz, g.nx * g.ny, p);  // equation 6
            }
}

}  // namespace dfield::runtime::volume::reference
