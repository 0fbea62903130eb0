// The estimators of sections 3.2 and 4 as they stand, lengths in units of R.
#include <algorithm>
#include <array>
#include <cmath>

#include "screen/estimate.hpp"
#include "screen/pipe.hpp"

namespace dfield::runtime::screen {
namespace {

// T and B of a frame around a normal (T. Duff et al.: Building an Orthonormal Basis, Revisited, 2017).
struct Tangents {
    glm::vec3 t, b;
    explicit Tangents(const glm::vec3& n) {
        const float sign = n.z < 0 ? -1.0f : 1.0f, c = -1 / (sign + n.z), d = n.x * n.y * c;
        t = {1 + sign * n.x * n.x * c, sign * d, -sign * n.x};
        b = {d, sign + n.y * n.y * c, -n.y};
    }
};

float dot(const glm::vec3& a, const glm::vec3& b) {
    return a.x * b.x + (a.y * b.y + a.z * b.z);
}

class Reference {
  public:
    Reference(const EstimateJob& job, const Shaded& s)
        : job_(job), s_(s), estimator_(job.settings->desc.estimator) {
        const Tangents tangents(s.normal);
        t_ = in_pixels(s, tangents.t);
        b_ = in_pixels(s, tangents.b);
        n_ = in_pixels(s, s.normal);
    }

    Estimate estimate() {
        if (estimator_ == DFIELD_ESTIMATOR_DISK) {
            const DiskSample* const samples =
                job_.disk->at(static_cast<std::uint32_t>(s_.column), static_cast<std::uint32_t>(s_.row));
            for (std::uint32_t k = 0; k < job_.disk->count; ++k) disk(samples[k]);
            if (!job_.settings->ratio()) sum_.open = static_cast<float>(job_.disk->count) / area();
            return sum_;
        }
        const PointSets& points = *job_.points;
        const std::uint32_t x = static_cast<std::uint32_t>(s_.column) % points.side();
        const float* values = points.values(s_.row) + x;
        for (std::uint32_t k = 0; k < points.count(); ++k, values += 4 * points.width()) {
            const auto value = [&](std::size_t i) { return values[i * points.width()]; };
            // Of a point around the normal: its place around s, in pixels.
            const glm::vec3 at = value(0) * t_ + value(1) * b_ + value(2) * n_;
            if (estimator_ == DFIELD_ESTIMATOR_MARCH)
                march(at);
            else
                point(at, value(3));
        }
        sum_.open = points.divisors(s_.row)[x];
        return sum_;
    }

  private:
    // 4.1 to 4.4: v times the integrand over the density. The pixel's radiance is added on the way.
    void point(const glm::vec3& at, float weight) {
        const Seen seen = look_up(*job_.frame, s_, at.x, at.y);
        if (job_.indirect) add_radiance(job_, s_, seen, sum_);
        if (at.z > seen.rise) sum_.seen += weight;
    }
    // 3.2: steps along a ray until one is hidden; the occluder then lies half a step before it.
    void march(const glm::vec3& end) {
        for (const PointSets::Step& step : job_.points->steps()) {
            const glm::vec3 at = step.share * end;
            const Seen seen = look_up(*job_.frame, s_, at.x, at.y);
            if (at.z > seen.rise) continue;
            if (job_.indirect) add_radiance(job_, s_, seen, sum_);
            sum_.seen += step.value;
            return;
        }
        sum_.seen += 1;
    }
    // 4.5: h over the seen part of a pipe.
    void disk(const DiskSample& at) {
        const Pattern pattern(s_);
        const float columns = pattern.columns(at), rows = pattern.rows(at);
        const Seen seen = look_up(*job_.frame, s_, columns, rows);
        if (job_.indirect) add_radiance(job_, s_, seen, sum_);
        Pipe pipe(s_, columns, rows, seen.rise);
        const Measure& measure = job_.settings->measure;
        if (measure.kind != DFIELD_MEASURE_QUARTIC)
            pipe.rho2 = std::max(pipe.rho2, own_rho2(s_.pixel_x, s_.pixel_y));
        const float ground = std::clamp(pipe.ground, pipe.low, pipe.high);
        if (job_.settings->ratio())
            sum_.open += at.weight * pipe_integral(measure, pipe, pipe.low, pipe.high);
        sum_.seen += at.weight * pipe_integral(measure, pipe, ground, pipe.high);
    }
    // Of the pattern, across the ray of sight, over pi.
    float area() const {
        const Pattern pattern(s_);
        return pattern.radius_x * s_.pixel_x * (pattern.radius_y * s_.pixel_y) / std::sqrt(s_.sight_2);
    }

    const EstimateJob& job_;
    const Shaded& s_;
    const std::uint32_t estimator_;
    glm::vec3 t_, b_, n_;  // the axes around the normal
    Estimate sum_;
};

}  // namespace

void add_radiance(const EstimateJob& job, const Shaded& s, const Seen& seen, Estimate& sum) {
    if (!(seen.rise > -kSky)) return;
    constexpr float kFade = 16;  // the tests fade in over a 16th of R
    const Frame& frame = *job.frame;
    const glm::vec3 point(seen.x - seen.rise * s.sight_x, seen.y - seen.rise * s.sight_y, seen.rise);
    const float r2 = dot(point, point);
    const float ahead = kFade * dot(s.normal, point);
    if (!(r2 < 1 && ahead > 0)) return;
    const float turned = -kFade * dot(shaded_at(frame, seen.column, seen.row).normal, point);
    if (!(turned > 0)) return;
    const float weight = (1 - r2 * r2) * std::min(ahead, 1.0f) * std::min(turned, 1.0f);
    const float* const radiance =
        frame.radiance.at(static_cast<std::size_t>(seen.column), static_cast<std::size_t>(seen.row));
    for (int i = 0; i < 3; ++i)
        if (radiance[i] > 0) sum.radiance[i] += weight * radiance[i];
    sum.radiance_weight += weight;
}

void estimate_reference(const EstimateJob& job, std::int32_t row) {
    const Frame& frame = *job.frame;
    const Layout& layout = frame.layout;
    const auto plane = static_cast<std::ptrdiff_t>(layout.size());
    for (std::int32_t column = 0; column < layout.width; ++column) {
        const std::ptrdiff_t at = layout.index(column, row);
        float visibility = 1;
        std::array<float, 4> light{};
        glm::vec2 slopes(0);
        if (frame.depth[at] < kSky && frame.radius > 0) {
            const Shaded s = shaded_at(frame, column, row);
            slopes = slopes_of(frame, s);
            if (!empty(s)) {
                const Estimate sum = Reference(job, s).estimate();
                if (sum.open > 0) visibility = sum.seen / sum.open;
                light = {sum.radiance.x, sum.radiance.y, sum.radiance.z,
                         sum.radiance_weight + kDarkness * static_cast<float>(job.settings->desc.samples)};
            }
        }
        job.visibility[at] = visibility;
        for (std::size_t i = 0; job.indirect && i < 4; ++i)
            job.light[static_cast<std::ptrdiff_t>(i) * plane + at] = light[i];
        for (int i = 0; job.slopes && i < 2; ++i) job.slopes[i * plane + at] = slopes[i];
    }
}

}  // namespace dfield::runtime::screen
