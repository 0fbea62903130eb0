#include "volume/clip_dilation.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace dfield::runtime::volume {
namespace {

// A mesh with exact inside tests has no depth maps to dilate: its bounds stand for it, and of a probe, that
// has to be underestimated, nothing.
DepthPixel depth_at(const dfield_clip_mesh& mesh, bool probe, double x, double y) {
    if (!mesh.exact()) {
        const DepthPixel* const pixel = mesh.maps().at({x, y, 0});
        return pixel ? *pixel : DepthPixel{};
    }
    if (probe || x < mesh.low().x || x > mesh.high().x || y < mesh.low().y || y > mesh.high().y) return {};
    return {mesh.low().z, mesh.high().z};
}

}  // namespace

Dilation::Dilation(dfield_context* context, const dfield_clip_mesh& mesh, bool probe, double radius)
    : mesh_(&mesh), probe_(probe), radius_(radius), maps_{glm::dvec2(0),
                                                          1,
                                                          1,
                                                          0,
                                                          0,
                                                          std::pmr::vector<DepthPixel>(context)} {
    // Pixels of the dilation may be larger than the mesh's: a hundred a side are enough, since each takes the
    // most of all points of those that it looks at.
    constexpr double kPixels = 160;
    const glm::dvec3 size = mesh.high() - mesh.low();
    const double pixel = (std::max(size.x, size.y) + 2 * radius) / kPixels;
    maps_.pixel = pixel;
    maps_.per_pixel = 1 / pixel;
    maps_.low = glm::dvec2(mesh.low()) - radius - pixel;
    maps_.width = static_cast<std::int32_t>((size.x + 2 * radius) / pixel) + 4;
    maps_.height = static_cast<std::int32_t>((size.y + 2 * radius) / pixel) + 4;
    maps_.pixels.resize(static_cast<std::size_t>(maps_.width) * static_cast<std::size_t>(maps_.height));

    // The mesh in the dilation's pixels: the least front and the greatest back of the mesh's own pixels
    // there, so that nothing is missed; of a probe, whose inside must not be overestimated, the other way
    // round.
    std::pmr::vector<DepthPixel> depths(maps_.pixels.size(), DepthPixel{}, context);
    const double fine = mesh.exact() ? pixel / 4 : std::min(mesh.maps().pixel, pixel / 2);
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const auto width = static_cast<std::size_t>(maps_.width), height = static_cast<std::size_t>(maps_.height);
    context->for_ranges(height, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j)
            for (std::size_t i = 0; i < width; ++i) {
                DepthPixel all = probe ? DepthPixel{-kNone, kNone} : DepthPixel{};
                const glm::dvec2 low = maps_.low + glm::dvec2(i, j) * pixel;
                const auto steps = static_cast<int>(std::ceil(pixel / fine));
                for (int v = 0; v <= steps; ++v)
                    for (int u = 0; u <= steps; ++u) {
                        const DepthPixel d =
                            depth_at(mesh, probe, low.x + u * pixel / steps, low.y + v * pixel / steps);
                        all.front = probe ? std::max(all.front, d.front) : std::min(all.front, d.front);
                        all.back = probe ? std::min(all.back, d.back) : std::max(all.back, d.back);
                    }
                depths[j * width + i] = all;
            }
    });

    // Algorithm 1, with a radius that has room for where in their pixels both points are.
    const double wide = radius + std::sqrt(2.0) * pixel;
    const auto reach = static_cast<std::ptrdiff_t>(wide / pixel) + 1;
    context->for_ranges(height, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                DepthPixel found = probe ? DepthPixel{-kNone, kNone} : DepthPixel{};
                for (std::ptrdiff_t j = -reach; j <= reach; ++j)
                    for (std::ptrdiff_t i = -reach; i <= reach; ++i) {
                        const double away = std::sqrt(static_cast<double>(i * i + j * j)) * pixel;
                        if (away >= wide) continue;
                        const auto at_x = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(x) + i),
                                   at_y = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(y) + j);
                        const bool within = at_x < width && at_y < height;
                        const DepthPixel mesh_depth = within ? depths[at_y * width + at_x] : DepthPixel{};
                        const double sphere = std::sqrt(wide * wide - away * away);
                        if (probe) {
                            found.front = std::max(found.front, mesh_depth.front + sphere);
                            found.back = std::min(found.back, mesh_depth.back - sphere);
                        } else {
                            found.front = std::min(found.front, mesh_depth.front - sphere);
                            found.back = std::max(found.back, mesh_depth.back + sphere);
                        }
                    }
                maps_.pixels[y * width + x] = found;
            }
    });
}

double dilation_radius(const PlacedClip& clip, const Grid& grid, float reach, bool anti_aliased) {
    const glm::dvec3 spacing(grid.hx, grid.hy, grid.hz);
    // The most that the way from the world to the camera stretches a length: the root of the largest
    // eigenvalue of A^T A (O. Smith 1961).
    glm::dmat3 a;
    for (int axis = 0; axis < 3; ++axis) a[axis] = clip.column[axis] / spacing[axis];
    const glm::dmat3 m = glm::transpose(a) * a;
    const double mean = (m[0][0] + m[1][1] + m[2][2]) / 3;
    const glm::dmat3 rest = m - glm::dmat3(mean);
    double squares = 0;
    for (int axis = 0; axis < 3; ++axis) squares += glm::dot(rest[axis], rest[axis]);
    const double p = std::sqrt(squares / 6);
    double largest = mean;
    if (p > 1e-12 * mean) {
        const double angle = std::acos(std::clamp(glm::determinant(rest / p) / 2, -1.0, 1.0)) / 3;
        largest = mean + 2 * p * std::cos(angle);
    }
    const double voxel = glm::length(spacing);
    return std::sqrt(largest) * (1 + 1e-6) * (static_cast<double>(reach) + (anti_aliased ? 2 : 1) * voxel);
}

}  // namespace dfield::runtime::volume
