#include <algorithm>
#include <cmath>

#include "volume/reference.hpp"

namespace dfield::runtime::volume::reference {
namespace {

// Steps along one axis in the order of a sweep.
struct Range {
    std::size_t first, count;
    std::ptrdiff_t step;
    Range(std::size_t n, int direction) : first(direction > 0 ? 0 : n - 1), count(n), step(direction) {}
    std::size_t at(std::size_t i) const { return first + static_cast<std::size_t>(step) * i; }
};

}  // namespace

Distances initialise(const Grid& grid, const Samples& samples) {
    Distances field{grid, {}, {}, {}};
    field.d.assign(grid.size(), kFar);
    field.inside.assign(grid.size(), 0);
    field.frozen.assign(grid.size(), 0);
    for (std::size_t z = 0; z < grid.nz; ++z)
        for (std::size_t y = 0; y < grid.ny; ++y)
            for (std::size_t x = 0; x < grid.nx; ++x) {
                const float here = samples.above(x, y, z);
                const bool inside = here >= 0;
                // What the values rise by along each axis, a unit of length. Across the isovalue, over
                // the edge that crosses it (the steeper of two): its crossing, by linear interpolation, is
                // |here| / slope away. Along an axis that no edge crosses: how the surface tilts.
                float sum = 0;
                bool crossed = false;
                const auto axis = [&](std::size_t at, std::size_t n, const auto& value, float h) {
                    const float low = at > 0 ? value(at - 1) : here, high = at + 1 < n ? value(at + 1) : here;
                    float rise = 0;
                    if ((low >= 0) != inside) rise = std::abs(here - low);
                    if ((high >= 0) != inside) rise = std::max(rise, std::abs(here - high));
                    if (rise > 0) {
                        crossed = true;
                    } else {
                        const bool border = at == 0 || at + 1 == n;  // one edge there, else two
                        // No more than what would still leave the axis uncrossed.
                        rise = std::min(std::abs(here), std::abs(high - low) * (border ? 1.0f : 0.5f));
                    }
                    sum += rise / h * (rise / h);
                };
                axis(
                    x, grid.nx, [&](std::size_t i) { return samples.above(i, y, z); }, grid.hx);
                axis(
                    y, grid.ny, [&](std::size_t i) { return samples.above(x, i, z); }, grid.hy);
                axis(
                    z, grid.nz, [&](std::size_t i) { return samples.above(x, y, i); }, grid.hz);
                const std::size_t i = grid.index(x, y, z);
                field.inside[i] = inside;
                // A value equal to the isovalue is inside; a crossing there lies at the vertex: distance 0.
                if (crossed) {
                    field.d[i] = std::abs(here) / std::sqrt(sum);
                    field.frozen[i] = 1;
                }
            }
    return field;
}

float estimate(const Grid& grid, float from_x, float from_y, float from_z) {
    struct Term {
        double a, h;
    };
    Term term[3] = {{from_x, grid.hx}, {from_y, grid.hy}, {from_z, grid.hz}};
    std::sort(term, term + 3, [](const Term& p, const Term& q) { return p.a < q.a; });
    // Equation 1: the root s of sum over the k smallest of ((s - a_i) / h_i)^2 = 1, for the k that leaves the
    // next one above s. With h_i = h these are the paper's s_1, s_2 and s_3.
    double s = term[0].a + term[0].h;
    for (int k = 2; k <= 3 && s > term[k - 1].a; ++k) {
        double w = 0, b = 0, c = -1;  // w t^2 - 2 b t + c = 0 for t = s - a_1, which keeps the digits
        for (int i = 0; i < k; ++i) {
            const double weight = 1 / (term[i].h * term[i].h), a = term[i].a - term[0].a;
            w += weight;
            b += weight * a;
            c += weight * a * a;
        }
        s = term[0].a + (b + std::sqrt(std::max(0.0, b * b - w * c))) / w;
    }
    return static_cast<float>(s);
}

void sweep_distance(Distances& field, const Sweep& sweep) {
    const Grid& g = field.grid;
    const Range xs(g.nx, sweep.x), ys(g.ny, sweep.y), zs(g.nz, sweep.z);
    for (std::size_t k = 0; k < g.nz; ++k)
        for (std::size_t j = 0; j < g.ny; ++j)
            for (std::size_t i = 0; i < g.nx; ++i) {
                const std::size_t x = xs.at(i), y = ys.at(j), z = zs.at(k), p = g.index(x, y, z);
                if (field.frozen[p]) continue;
                // P_s^x, P_s^y and P_s^z of Table 1; beyond the grid nothing is near.
                const float ax = i > 0 ? field.d[g.index(xs.at(i - 1), y, z)] : kFar;
                const float ay = j > 0 ? field.d[g.index(x, ys.at(j - 1), z)] : kFar;
                const float az = k > 0 ? field.d[g.index(x, y, zs.at(k - 1))] : kFar;
                field.d[p] = std::min(field.d[p], estimate(g, ax, ay, az));
            }
}

}  // namespace dfield::runtime::volume::reference
