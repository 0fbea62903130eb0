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
    // Vertices' own depths, floats.
    return {static_cast<float>(mesh.low().z), static_cast<float>(mesh.high().z)};
}

// Depths as floats that are not greater.
float round_down(double depth) {
    const auto nearest = static_cast<float>(depth);
    return static_cast<double>(nearest) > depth
               ? std::nextafter(nearest, -std::numeric_limits<float>::infinity())
               : nearest;
}

// Pixels along one axis that can have the mesh: [low, high).
struct Extent {
    std::size_t low, high;

    bool has(std::size_t i) const { return i >= low && i < high; }
};

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
    // Algorithm 1's radius, with room for where in their pixels both points are; and so many pixels around
    // the mesh.
    const double wide = radius + std::sqrt(2.0) * pixel;
    const auto reach = static_cast<std::ptrdiff_t>(wide / pixel) + 1;
    const auto pixels_of = [&](double length) { return static_cast<std::size_t>(length / pixel) + 1; };
    const auto margin = static_cast<std::size_t>(reach);
    const Extent across{margin, margin + pixels_of(size.x)}, along{margin, margin + pixels_of(size.y)};
    const std::size_t width = across.high + margin, height = along.high + margin;
    maps_.pixel = pixel;
    maps_.per_pixel = 1 / pixel;
    maps_.low = glm::dvec2(mesh.low()) - static_cast<double>(reach) * pixel;
    maps_.width = static_cast<std::int32_t>(width);
    maps_.height = static_cast<std::int32_t>(height);
    maps_.pixels.resize(width * height);

    // The mesh in the dilation's pixels: the least front and the greatest back of the mesh's own pixels
    // there, so that nothing is missed; of a probe, whose inside must not be overestimated, the other way
    // round. Depths of a probe are kept with the other sign, so that one rule serves both.
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const double sign = probe ? -1 : 1;
    std::pmr::vector<double> least(width * height, sign * kNone, context),
        greatest(width * height, -sign * kNone, context);
    const double fine = mesh.exact() ? pixel / 4 : std::min(mesh.maps().pixel, pixel / 2);
    const auto steps = static_cast<int>(std::ceil(pixel / fine));
    context->for_ranges(along.high - along.low, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = along.low + begin; y < along.low + end; ++y)
            for (std::size_t x = across.low; x < across.high; ++x) {
                const glm::dvec2 low = maps_.low + glm::dvec2(x, y) * pixel;
                double front = kNone, back = -kNone;
                for (int v = 0; v <= steps; ++v)
                    for (int u = 0; u <= steps; ++u) {
                        const DepthPixel d =
                            depth_at(mesh, probe, low.x + u * pixel / steps, low.y + v * pixel / steps);
                        front = std::min(front, sign * static_cast<double>(d.front));
                        back = std::max(back, sign * static_cast<double>(d.back));
                    }
                least[y * width + x] = front;
                greatest[y * width + x] = back;
            }
    });

    // Algorithm 1, a sphere around every point. Offset by offset and not pixel by pixel, so that a row is
    // loaded as vectors; of a dilation the pixels that have the mesh are looked for from all others, of a
    // contraction all others from the pixels that have the mesh.
    std::pmr::vector<double> fronts(width * height, kNone, context), backs(width * height, -kNone, context);
    context->for_ranges(height, [&](std::size_t begin, std::size_t end) {
        for (std::size_t to = begin; to < end; ++to) {
            const bool nothing = probe && !along.has(to);
            double *const front = &fronts[to * width], *const back = &backs[to * width];
            for (std::ptrdiff_t j = nothing ? reach + 1 : -reach; j <= reach; ++j) {
                const std::size_t from = to + static_cast<std::size_t>(j);
                if (!probe && !along.has(from)) continue;
                for (std::ptrdiff_t i = -reach; i <= reach; ++i) {
                    const double away = std::sqrt(static_cast<double>(i * i + j * j)) * pixel;
                    if (away >= wide) continue;
                    const double sphere = std::sqrt(wide * wide - away * away);
                    const std::size_t first = probe ? across.low : across.low - static_cast<std::size_t>(i);
                    const std::size_t source = from * width + first + static_cast<std::size_t>(i);
                    const double *const a = &least[source], *const b = &greatest[source];
                    double *const f = &front[first], *const g = &back[first];
                    for (std::size_t x = 0; x < across.high - across.low; ++x) {
                        f[x] = std::min(f[x], a[x] - sphere);
                        g[x] = std::max(g[x], b[x] + sphere);
                    }
                }
            }
            for (std::size_t x = 0; x < width; ++x) {
                const bool empty = probe && (nothing || !across.has(x));
                const float low = round_down(front[x]), high = -round_down(-back[x]);
                maps_.pixels[to * width + x] = empty   ? DepthPixel{}
                                               : probe ? DepthPixel{-low, -high}
                                                       : DepthPixel{low, high};
            }
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
