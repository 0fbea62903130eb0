// Cells around a clipping mesh that say how far its boundary is at least: most boxes of voxels need no test
// of their own.
#include <algorithm>
#include <cmath>

#include "volume/clip_mesh.hpp"

using namespace dfield::runtime;
using namespace dfield::runtime::volume;

namespace {
constexpr std::int32_t kCells = 96;      // along the longest side
constexpr double kSlack = 1e-6;          // of a cell: more than rounding errors
constexpr std::uint8_t kFarthest = 255;  // cells
}  // namespace

// Whether a triangle may touch a box: its own box, and its plane.
bool dfield_clip_mesh::touches(const Corner& triangle, const CameraPoint& centre, double half) const {
    const CameraPoint a = points_[triangle.vertex[0]] - centre, b = points_[triangle.vertex[1]] - centre,
                      c = points_[triangle.vertex[2]] - centre;
    for (int axis = 0; axis < 3; ++axis)
        if (std::min({a[axis], b[axis], c[axis]}) > half || std::max({a[axis], b[axis], c[axis]}) < -half)
            return false;
    const glm::dvec3 u = b - a, v = c - a,
                     n(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
    return std::abs(n.x * a.x + n.y * a.y + n.z * a.z) <=
           half * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) * (1 + kSlack);
}

void dfield_clip_mesh::make_cells() {
    const glm::dvec3 size = high_ - low_;
    // A whole number of pixels a cell, so that a column of cells sees its own pixels only.
    cell_ = std::max({size.x, size.y, size.z}) / kCells;
    const std::int32_t pixels = std::max(1, static_cast<std::int32_t>(std::ceil(cell_ / maps_.pixel)));
    if (!exact_) cell_ = pixels * maps_.pixel;
    for (int axis = 0; axis < 3; ++axis) cells_[axis] = static_cast<std::int32_t>(size[axis] / cell_) + 3;
    const auto nx = static_cast<std::size_t>(cells_[0]), ny = static_cast<std::size_t>(cells_[1]),
               nz = static_cast<std::size_t>(cells_[2]);
    cell_sides_.assign(nx * ny * nz, {Side::kOutside, kFarthest});
    const auto at = [&](std::size_t x, std::size_t y, std::size_t z) -> Cell& {
        return cell_sides_[(y * nx + x) * nz + z];  // columns along z
    };
    const auto centre = [&](std::size_t x, std::size_t y, std::size_t z) {
        return low_ + (glm::dvec3(x, y, z) - 0.5) * cell_;
    };
    if (exact_) {
        for (const Corner& t : triangles_) {
            std::size_t box[2][3];
            for (int axis = 0; axis < 3; ++axis) {
                double low = points_[t.vertex[0]][axis], high = low;
                for (const std::uint32_t v : t.vertex) {
                    low = std::min(low, points_[v][axis]);
                    high = std::max(high, points_[v][axis]);
                }
                box[0][axis] = static_cast<std::size_t>((low - low_[axis]) / cell_ + 1 - kSlack);
                box[1][axis] = std::min(static_cast<std::size_t>((high - low_[axis]) / cell_ + 1 + kSlack),
                                        static_cast<std::size_t>(cells_[axis]) - 1);
            }
            for (std::size_t y = box[0][1]; y <= box[1][1]; ++y)
                for (std::size_t x = box[0][0]; x <= box[1][0]; ++x)
                    for (std::size_t z = box[0][2]; z <= box[1][2]; ++z)
                        if (touches(t, centre(x, y, z), (0.5 + kSlack) * cell_))
                            at(x, y, z).side = Side::kMixed;
        }
        // The rest of a column changes sides at mixed cells only.
        context()->for_ranges(nx * ny, [&](std::size_t begin, std::size_t end) {
            for (std::size_t column = begin; column < end; ++column) {
                Side side = Side::kMixed;
                for (std::size_t z = 0; z < nz; ++z) {
                    Cell& cell = cell_sides_[column * nz + z];
                    if (cell.side == Side::kMixed) {
                        side = Side::kMixed;
                        continue;
                    }
                    if (side == Side::kMixed)
                        side = inside_exactly(centre(column % nx, column / nx, z)) ? Side::kInside
                                                                                   : Side::kOutside;
                    cell.side = side;
                }
            }
        });
    } else {
        constexpr float kNone = std::numeric_limits<float>::infinity();
        for (std::size_t y = 1; y + 1 < ny; ++y)
            for (std::size_t x = 1; x + 1 < nx; ++x) {
                float front[2] = {kNone, -kNone}, back[2] = {kNone, -kNone};  // least and greatest
                bool gaps = false;
                const auto i0 = static_cast<std::int32_t>(x - 1) * pixels,
                           j0 = static_cast<std::int32_t>(y - 1) * pixels;
                for (std::int32_t j = j0; j < j0 + pixels; ++j)
                    for (std::int32_t i = i0; i < i0 + pixels; ++i) {
                        const bool beyond = i >= maps_.width || j >= maps_.height;
                        const DepthPixel pixel =
                            beyond ? DepthPixel{}
                                   : maps_.pixels[static_cast<std::size_t>(j) *
                                                      static_cast<std::size_t>(maps_.width) +
                                                  static_cast<std::size_t>(i)];
                        if (pixel.front > pixel.back) {
                            gaps = true;
                            continue;
                        }
                        front[0] = std::min(front[0], pixel.front);
                        front[1] = std::max(front[1], pixel.front);
                        back[0] = std::min(back[0], pixel.back);
                        back[1] = std::max(back[1], pixel.back);
                    }
                for (std::size_t z = 0; z < nz; ++z) {
                    const double middle = centre(x, y, z).z, half = (0.5 + kSlack) * cell_;
                    const auto above = [&](float depth) {
                        return middle - half > static_cast<double>(depth);
                    };
                    const auto below = [&](float depth) {
                        return middle + half < static_cast<double>(depth);
                    };
                    Side& side = at(x, y, z).side;
                    if (below(front[0]) || above(back[1]))
                        side = Side::kOutside;
                    else if (!gaps && above(front[1]) && below(back[0]))
                        side = Side::kInside;
                    else
                        side = Side::kMixed;
                }
            }
    }
    // Clearances: one more than the least of the 26 neighbours', in two sweeps. Neighbours on other sides
    // without a mixed cell in between (depth maps may jump from pixel to pixel) count as mixed.
    const auto sweep = [&](bool up) {
        for (std::size_t i = 0; i < cell_sides_.size(); ++i) {
            const std::size_t index = up ? i : cell_sides_.size() - 1 - i, z = index % nz,
                              x = index / nz % nx, y = index / (nz * nx);
            Cell& cell = cell_sides_[index];
            if (cell.side == Side::kMixed) {
                cell.clearance = 0;
                continue;
            }
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx)
                    for (int dz = -1; dz <= 1; ++dz) {
                        const std::size_t ox = x + static_cast<std::size_t>(dx),
                                          oy = y + static_cast<std::size_t>(dy),
                                          oz = z + static_cast<std::size_t>(dz);
                        if (ox >= nx || oy >= ny || oz >= nz) continue;
                        const Cell& other = at(ox, oy, oz);
                        const std::uint8_t clear =
                            other.side == cell.side ? other.clearance : std::uint8_t{0};
                        cell.clearance =
                            std::min(cell.clearance, static_cast<std::uint8_t>(std::min(clear + 1, 255)));
                    }
        }
    };
    sweep(true);
    sweep(false);
}

dfield_clip_mesh::Side dfield_clip_mesh::side(const CameraPoint& centre, const glm::dvec3& half_size) const {
    std::size_t index[3];
    bool within = true;
    for (int axis = 0; axis < 3; ++axis) {
        if (centre[axis] + half_size[axis] < low_[axis] || centre[axis] - half_size[axis] > high_[axis])
            return Side::kOutside;
        const double cell = (centre[axis] - low_[axis]) / cell_ + 1;
        within = within && cell >= 0 && cell < cells_[axis];
        index[axis] = within ? static_cast<std::size_t>(cell) : 0;
    }
    if (!within) return Side::kMixed;
    const Cell& cell = cell_sides_[(index[1] * static_cast<std::size_t>(cells_[0]) + index[0]) *
                                       static_cast<std::size_t>(cells_[2]) +
                                   index[2]];
    const double reach = std::max({half_size.x, half_size.y, half_size.z});
    return reach < (cell.clearance - 1) * cell_ * (1 - kSlack) ? cell.side : Side::kMixed;
}
