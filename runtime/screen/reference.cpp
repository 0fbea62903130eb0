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

// The point of the hemisphere above a point of the unit disk.
glm::vec3 cosine_direction(const Shaded& s, const Tangents& tangents, const PointSample& at) {
    const float height = std::sqrt(std::max(0.0f, 1 - (at.x * at.x + at.y * at.y)));
    return at.x * tangents.t + at.y * tangents.b + height * s.normal;
}

float dot(const glm::vec3& a, const glm::vec3& b) {
    return a.x * b.x + (a.y * b.y + a.z * b.z);
}

class Reference {
  public:
    Reference(const EstimateJob& job, const Shaded& s) : job_(job), s_(s), tangents_(s.normal) {}

    // v of a point. Its pixel's radiance is added on the way.
    bool open(const glm::vec3& point, bool lights = true) {
        const Seen seen = look_up(*job_.frame, s_, point);
        if (job_.indirect && lights) add_radiance(job_, s_, seen, sum_);
        return point.z > seen.rise;
    }
    void add(float term, bool open) {
        sum_.open += term;
        if (open) sum_.seen += term;
    }

    // 4.1 and 4.2: mu'(r) / r^2 (N.w)+ v. A point behind the tangent plane is mirrored into the visible half.
    void sphere(glm::vec3 point, bool half) {
        float cosine = dot(s_.normal, point);
        if (half && cosine < 0) {
            point = -point;
            cosine = -cosine;
        }
        const float r = glm::length(point);
        add(job_.settings->measure.derivative(r) / (r * r) * std::max(0.0f, cosine / r), open(point));
    }
    // 4.3: v.
    void importance(const PointSample& at) {
        add(1, open(job_.settings->measure.inverse(at.z) * cosine_direction(s_, tangents_, at)));
    }
    // 4.4: mu'(r) / r^2 v in the sphere of radius 1/2 around N/2.
    void tangent(const PointSample& at) {
        const glm::vec3 point = 0.5f * (s_.normal + at);
        const float r = std::max(glm::length(point), 1e-6f);
        add(job_.settings->measure.derivative(r) / (r * r), open(point));
    }
    // 4.5: h over the seen part of a pipe.
    void disk(const DiskSample& at) {
        const Pattern pattern(s_);
        const float columns = pattern.columns(at), rows = pattern.rows(at);
        const Seen seen = look_up(*job_.frame, s_, columns * s_.pixel_x, -rows * s_.pixel_y);
        if (job_.indirect) add_radiance(job_, s_, seen, sum_);
        Pipe pipe(s_, columns, rows, seen.rise);
        const Measure& measure = job_.settings->measure;
        if (measure.kind != DFIELD_MEASURE_QUARTIC) pipe.rho2 = std::max(pipe.rho2, own_rho2(s_));
        const float ground = std::clamp(pipe.ground, pipe.low, pipe.high);
        sum_.open += at.weight * pipe_integral(measure, pipe, pipe.low, pipe.high);
        sum_.seen += at.weight * pipe_integral(measure, pipe, ground, pipe.high);
    }
    // 3.2: steps along a ray until one is hidden; the occluder then lies half a step before it.
    void march(const PointSample& at) {
        const glm::vec3 direction = cosine_direction(s_, tangents_, at);
        const auto steps = static_cast<float>(job_.settings->desc.march_steps);
        sum_.open += 1;
        for (float m = 1; m <= steps; ++m) {
            const glm::vec3 point = m / steps * direction;
            if (open(point, false)) continue;
            if (job_.indirect) add_radiance(job_, s_, look_up(*job_.frame, s_, point), sum_);
            sum_.seen += job_.settings->measure.value((m - 0.5f) / steps);
            return;
        }
        sum_.seen += 1;
    }

    const Estimate& sum() const { return sum_; }

  private:
    const EstimateJob& job_;
    const Shaded& s_;
    const Tangents tangents_;
    Estimate sum_;
};

Estimate estimate(const EstimateJob& job, const Shaded& s) {
    Reference reference(job, s);
    const auto each = [&](const auto& sets, const auto& take) {
        const auto* const samples =
            sets.at(static_cast<std::uint32_t>(s.column), static_cast<std::uint32_t>(s.row));
        for (std::uint32_t k = 0; k < sets.count; ++k) take(samples[k]);
    };
    switch (job.settings->desc.estimator) {
        case DFIELD_ESTIMATOR_SPHERE:
            each(*job.points, [&](const PointSample& at) { reference.sphere(at, false); });
            break;
        case DFIELD_ESTIMATOR_HEMISPHERE:
            each(*job.points, [&](const PointSample& at) { reference.sphere(at, true); });
            break;
        case DFIELD_ESTIMATOR_IMPORTANCE:
            each(*job.points, [&](const PointSample& at) { reference.importance(at); });
            break;
        case DFIELD_ESTIMATOR_TANGENT:
            each(*job.points, [&](const PointSample& at) { reference.tangent(at); });
            break;
        case DFIELD_ESTIMATOR_DISK:
            each(*job.disk, [&](const DiskSample& at) { reference.disk(at); });
            break;
        default:
            each(*job.points, [&](const PointSample& at) { reference.march(at); });
    }
    return reference.sum();
}

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

float visibility_of(const Settings& settings, const Shaded& s, const Estimate& sum) {
    const dfield_screen_desc& desc = settings.desc;
    const auto n = static_cast<float>(desc.samples);
    switch (desc.estimator) {
        case DFIELD_ESTIMATOR_IMPORTANCE:
        case DFIELD_ESTIMATOR_MARCH:
            return sum.seen / n;
        default:
            if (settings.ratio()) return sum.open > 0 ? sum.seen / sum.open : 1;
    }
    switch (desc.estimator) {
        case DFIELD_ESTIMATOR_SPHERE:
            return 4 * sum.seen / (3 * n);
        case DFIELD_ESTIMATOR_HEMISPHERE:
            return 2 * sum.seen / (3 * n);
        case DFIELD_ESTIMATOR_TANGENT:
            return sum.seen / (6 * n) / (desc.tangent_as_printed ? 1 : settings.measure.tangent_total());
        default: {  // DISK: the pattern's area, across the ray of sight
            const Pattern pattern(s);
            return pattern.radius_x * s.pixel_x * (pattern.radius_y * s.pixel_y) / std::sqrt(s.sight_2) *
                   sum.seen / n;
        }
    }
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
                const Estimate sum = estimate(job, s);
                visibility = visibility_of(*job.settings, s, sum);
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
