#include <algorithm>
#include <cmath>

#include "screen/estimate.hpp"
#include "screen/points.hpp"

namespace dfield::runtime::screen {
namespace {

// What the sum of n weights is divided by where they are not normalised by themselves: the domain's volume,
// and 1/pi of equation 2, are left out of the weights.
float plain_divisor(const Settings& settings) {
    const auto n = static_cast<float>(settings.desc.samples);
    switch (settings.desc.estimator) {
        case DFIELD_ESTIMATOR_SPHERE:
            return 3 * n / 4;
        case DFIELD_ESTIMATOR_HEMISPHERE:
            return 3 * n / 2;
        default:  // TANGENT
            return 6 * n * (settings.desc.tangent_as_printed ? 1 : settings.measure.tangent_total());
    }
}

}  // namespace

PointSample point_sample(const Settings& settings, std::uint32_t index) {
    const auto uniform = sobol_point(index, settings.desc.seed);
    const auto term = [&](float r) { return settings.measure.derivative(r) / (r * r); };
    switch (settings.desc.estimator) {
        case DFIELD_ESTIMATOR_SPHERE: {
            const glm::vec3 point = uniform_ball(uniform);
            const float r = glm::length(point);
            return {point, term(r) * std::max(0.0f, point.z / r)};
        }
        case DFIELD_ESTIMATOR_HEMISPHERE: {  // what is behind the tangent plane is mirrored into the visible
                                             // half
            const glm::vec3 point = uniform_ball(uniform);
            const float r = glm::length(point);
            return {point.z < 0 ? -point : point, term(r) * std::abs(point.z / r)};
        }
        case DFIELD_ESTIMATOR_TANGENT: {  // the sphere of radius 1/2 around N/2; no N.w
            const glm::vec3 point = 0.5f * (glm::vec3(0, 0, 1) + uniform_ball(uniform));
            return {point, term(std::max(glm::length(point), 1e-6f))};
        }
        default: {  // IMPORTANCE: directions by the cosine, distances by mu'. MARCH: directions
            const glm::vec2 disk = concentric_disk(uniform[0], uniform[1]);
            const glm::vec3 direction(disk,
                                      std::sqrt(std::max(0.0f, 1 - (disk.x * disk.x + disk.y * disk.y))));
            const bool march = settings.desc.estimator == DFIELD_ESTIMATOR_MARCH;
            return {(march ? 1 : settings.measure.inverse(uniform[2])) * direction, 1};
        }
    }
}

PointSets::PointSets(std::pmr::memory_resource* memory, const Settings& settings)
    : side_(settings.desc.interleave),
      count_(settings.disk() ? 0 : settings.desc.samples),
      width_(side_ + static_cast<std::uint32_t>(Lattice::kBorder) - 1),
      values_(memory),
      divisors_(memory),
      steps_(memory) {
    if (settings.disk()) return;
    const std::uint32_t estimator = settings.desc.estimator;
    const bool by_sum =
        settings.ratio() || estimator == DFIELD_ESTIMATOR_IMPORTANCE || estimator == DFIELD_ESTIMATOR_MARCH;
    values_.resize(std::size_t{side_} * count_ * 4 * width_);
    divisors_.resize(side_ * width_);
    for (std::uint32_t y = 0; y < side_; ++y)
        for (std::uint32_t x = 0; x < side_; ++x) {
            float sum = 0;
            for (std::uint32_t k = 0; k < count_; ++k) {
                const PointSample sample = point_sample(settings, block_of(x, y, side_) * count_ + k);
                const float values[4] = {sample.at.x, sample.at.y, sample.at.z, sample.weight};
                for (std::uint32_t i = 0; i < 4; ++i)
                    for (std::size_t lane = x; lane < width_; lane += side_)
                        values_[((std::size_t{y} * count_ + k) * 4 + i) * width_ + lane] = values[i];
                sum += sample.weight;
            }
            for (std::size_t lane = x; lane < width_; lane += side_)
                divisors_[y * width_ + lane] = by_sum ? sum : plain_divisor(settings);
        }
    if (estimator != DFIELD_ESTIMATOR_MARCH) return;
    const auto count = static_cast<float>(settings.desc.march_steps);
    for (float m = 1; m <= count; ++m)
        steps_.push_back({m / count, settings.measure.value((m - 0.5f) / count)});
}

}  // namespace dfield::runtime::screen
