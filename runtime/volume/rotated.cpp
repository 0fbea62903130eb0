#include "volume/rotated.hpp"

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "status.hpp"
#include "volume/buffer.hpp"

namespace dfield::runtime::volume {
namespace {

constexpr std::size_t kOctant = 7;  // its light comes along (1, 1, 1)

// Orthonormal axes whose sum is along `diagonal`.
glm::mat3 axes_around(const glm::vec3& diagonal) {
    const glm::vec3 helper = std::abs(diagonal.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0);
    const glm::vec3 p = glm::normalize(glm::cross(helper, diagonal)), q = glm::cross(diagonal, p);
    glm::mat3 axes;
    for (int i = 0; i < 3; ++i) {
        const float angle = 2.0943951f * static_cast<float>(i);  // a third of a turn
        axes[i] = diagonal * std::sqrt(1.0f / 3) +
                  (p * std::cos(angle) + q * std::sin(angle)) * std::sqrt(2.0f / 3);
    }
    return axes;
}

}  // namespace

void sweep_light(dfield_context* context, const SignedField& field, const glm::vec3& light, bool improved,
                 float alpha, float* visibility) {
    const Grid& grid = field.grid;
    const glm::mat3 axes = axes_around(light), to_turned = glm::transpose(axes);
    const glm::vec3 extent(static_cast<float>(grid.nx - 1) * grid.hx,
                           static_cast<float>(grid.ny - 1) * grid.hy,
                           static_cast<float>(grid.nz - 1) * grid.hz);
    glm::vec3 low(std::numeric_limits<float>::infinity()), high = -low;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 at = to_turned * (extent * glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2));
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    const float h = grid.h();
    const auto count = [&](int axis) {
        return static_cast<std::size_t>(std::ceil((high[axis] - low[axis]) / h)) + 1;
    };
    const Grid turned{count(0), count(1), count(2), h, h, h};

    Buffer<float> distance(context, turned.size());
    context->for_ranges(turned.ny * turned.nz, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
            for (std::size_t x = 0; x < turned.nx; ++x) {
                const glm::vec3 at = low + h * glm::vec3(x, row % turned.ny, row / turned.ny), p = axes * at;
                const bool within = glm::all(glm::greaterThanEqual(p, glm::vec3(-0.5f * h))) &&
                                    glm::all(glm::lessThanEqual(p, extent + 0.5f * h));
                distance.get()[row * turned.nx + x] = within ? field.at(p) : 4 * h;
            }
    });

    Buffer<std::uint8_t> octants(context, 8 * turned.size());
    OcclusionJob job;
    job.context = context;
    job.grid = turned;
    job.distance = distance.get();
    job.ordinates = improved ? 3 : 1;
    if (!improved) {
        job.shift = kPaperShift;
        job.thin = 0;
    }
    job.alpha = alpha;
    job.octants = octants.get();
    job.only = kOctant;
    occlusion_function(context->simd_targets)(job);

    const std::uint8_t* const lit = octants.get() + 4 * (kOctant / 4) * turned.size() + kOctant % 4;
    context->for_ranges(grid.ny * grid.nz, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
            for (std::size_t x = 0; x < grid.nx; ++x) {
                const glm::vec3 p(static_cast<float>(x) * grid.hx,
                                  static_cast<float>(row % grid.ny) * grid.hy,
                                  static_cast<float>(row / grid.ny) * grid.hz);
                const Cell cell(turned, to_turned * p - low);
                visibility[row * grid.nx + x] = cell.blend([&](auto i, auto j, auto k) {
                    return static_cast<float>(lit[4 * turned.index(i, j, k)]) / 255;
                });
            }
    });
}

}  // namespace dfield::runtime::volume
