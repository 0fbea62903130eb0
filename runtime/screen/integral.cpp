// What the estimators converge to, by brute force: regular grids of thousands of points, sharing with the
// estimators nothing but what a frame is, where a point is looked up and what a pipe holds.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "screen/estimate.hpp"
#include "screen/pipe.hpp"
#include "screen/screen.hpp"

using namespace dfield::runtime;
using namespace dfield::runtime::screen;

namespace {

struct Answer {
    float visibility = 1;
    glm::vec3 indirect{0};
};

// Of a unit disk, how much of the rectangle of this size around (x, y) lies in it.
double covered(double x, double y, double width, double height) {
    if (std::hypot(std::abs(x) + width / 2, std::abs(y) + height / 2) <= 1) return 1;
    constexpr int kSteps = 16;
    int inside = 0;
    for (int j = 0; j < kSteps; ++j)
        for (int i = 0; i < kSteps; ++i) {
            const double at_x = x + width * ((i + 0.5) / kSteps - 0.5),
                         at_y = y + height * ((j + 0.5) / kSteps - 0.5);
            inside += at_x * at_x + at_y * at_y <= 1;
        }
    return inside / static_cast<double>(kSteps * kSteps);
}

// Terms in doubles: tens of thousands of them.
struct Sum {
    double seen = 0, open = 0, weight = 0;
    std::array<double, 3> radiance{};

    void add_light(const Estimate& light, double density) {
        for (int i = 0; i < 3; ++i)
            radiance[static_cast<std::size_t>(i)] += density * static_cast<double>(light.radiance[i]);
        weight += density * static_cast<double>(light.radiance_weight + kDarkness);
    }
    Answer answer(double visibility) const {
        Answer result{static_cast<float>(visibility), {}};
        if (weight > 0)
            for (int i = 0; i < 3; ++i)
                result.indirect[i] = static_cast<float>(radiance[static_cast<std::size_t>(i)] / weight *
                                                        std::max(0.0, 1 - visibility));
        return result;
    }
};

// Every pixel of the pattern, by its area in it. Of patterns wider than 2 kMost pixels, one of some pixels.
Answer disk_integral(const EstimateJob& job, const Shaded& s) {
    constexpr float kMost = 256;
    const Settings& settings = *job.settings;
    const Pattern pattern(s);
    const float across = std::ceil(pattern.radius_x / kMost), down = std::ceil(pattern.radius_y / kMost);
    const float last_column = std::ceil(pattern.radius_x / across),
                last_row = std::ceil(pattern.radius_y / down);
    Sum sum;
    for (float row = -last_row; row <= last_row; ++row)
        for (float column = -last_column; column <= last_column; ++column) {
            const float columns = column * across, rows = row * down;
            const double x = static_cast<double>(columns / pattern.radius_x),
                         y = static_cast<double>(rows / pattern.radius_y);
            const double area = covered(x, y, static_cast<double>(across / pattern.radius_x),
                                        static_cast<double>(down / pattern.radius_y));
            if (area == 0) continue;
            const Seen seen = look_up(*job.frame, s, columns, rows);
            Pipe pipe(s, columns, rows, seen.rise);
            if (settings.measure.kind != DFIELD_MEASURE_QUARTIC)
                pipe.rho2 = std::max(pipe.rho2, own_rho2(s.pixel_x, s.pixel_y));
            const float ground = std::clamp(pipe.ground, pipe.low, pipe.high);
            sum.open +=
                area * static_cast<double>(pipe_integral(settings.measure, pipe, pipe.low, pipe.high));
            sum.seen += area * static_cast<double>(pipe_integral(settings.measure, pipe, ground, pipe.high));
            if (!job.indirect) continue;
            Estimate light;
            add_radiance(job, s, seen, light);
            sum.add_light(light, area * (settings.ratio() ? std::max(0.0, 1 - x * x - y * y) : 1));
        }
    if (settings.ratio()) return sum.answer(sum.open > 0 ? sum.seen / sum.open : 1);
    const double cell = static_cast<double>(across * s.pixel_x) * static_cast<double>(down * s.pixel_y) /
                        std::sqrt(static_cast<double>(s.sight_2));
    return sum.answer(sum.seen * cell / std::numbers::pi);
}

Seen look_up(const EstimateJob& job, const Shaded& s, const glm::vec3& point) {
    const glm::vec3 at = in_pixels(s, point);
    return screen::look_up(*job.frame, s, at.x, at.y);
}

// Directions by the height c = N.w and the angle around N, both in equal steps.
template<class Body>
void for_directions(const Shaded& s, int heights, int angles, const Body& body) {
    const glm::vec3 n = s.normal;
    const glm::vec3 other = std::abs(n.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 t = glm::normalize(glm::cross(other, n)), b = glm::cross(n, t);
    for (int j = 0; j < heights; ++j)
        for (int i = 0; i < angles; ++i) {
            // A third of a step farther around from a height to the next: no spokes.
            const double c = (j + 0.5) / heights, phi = 2 * std::numbers::pi * (i + 0.5 + j / 3.0) / angles;
            const double across = std::sqrt(1 - c * c);
            body(static_cast<float>(c), static_cast<float>(across * std::cos(phi)) * t +
                                            static_cast<float>(across * std::sin(phi)) * b +
                                            static_cast<float>(c) * n);
        }
}

// Equation 2 with dV = r^2 dr dc dphi and, for each direction, equal steps of mu up to that at its end: 1, or
// where it leaves the tangent sphere, whose terms have no N.w (section 4.4).
Answer volume_integral(const EstimateJob& job, const Shaded& s) {
    constexpr int kHeights = 32, kAngles = 64, kDistances = 32;
    const Settings& settings = *job.settings;
    const std::uint32_t estimator = settings.desc.estimator;
    const bool tangent = estimator == DFIELD_ESTIMATOR_TANGENT;
    Sum sum;
    for_directions(s, kHeights, kAngles, [&](float c, const glm::vec3& direction) {
        const float end = tangent ? settings.measure.value(c) : 1;
        const double term = static_cast<double>(tangent ? end : c);
        for (int k = 0; k < kDistances; ++k) {
            const float share = (static_cast<float>(k) + 0.5f) / kDistances;
            const glm::vec3 point = settings.measure.inverse(end * share) * direction;
            const Seen seen = look_up(job, s, point);
            sum.open += term;
            if (point.z > seen.rise) sum.seen += term;
            if (!job.indirect) continue;
            // Radiance is averaged over what the estimator's samples are spread over.
            Estimate light;
            const float uniform = std::cbrt(share);
            if (estimator == DFIELD_ESTIMATOR_IMPORTANCE) {
                add_radiance(job, s, seen, light);
                sum.add_light(light, static_cast<double>(c));
            } else if (tangent) {
                add_radiance(job, s, look_up(job, s, c * uniform * direction), light);
                sum.add_light(light, static_cast<double>(c * c * c));
            } else {
                add_radiance(job, s, look_up(job, s, uniform * direction), light);
                sum.add_light(light, 1);
                if (estimator == DFIELD_ESTIMATOR_SPHERE) {
                    Estimate behind;
                    add_radiance(job, s, look_up(job, s, -uniform * direction), behind);
                    sum.add_light(behind, 1);
                }
            }
        }
    });
    const bool printed = tangent && !settings.ratio() && settings.desc.tangent_as_printed != 0;
    return sum.answer(printed ? sum.seen * 2 / (kHeights * kAngles * kDistances) : sum.seen / sum.open);
}

// Section 3.2 with so many rays that their number does not matter, of as many steps as the estimator's.
Answer march_integral(const EstimateJob& job, const Shaded& s) {
    constexpr int kHeights = 64, kAngles = 64;
    const auto steps = static_cast<float>(job.settings->desc.march_steps);
    Sum sum;
    for_directions(s, kHeights, kAngles, [&](float c, const glm::vec3& direction) {
        float value = 1;
        Estimate light;
        for (float m = 1; m <= steps; ++m) {
            const glm::vec3 point = m / steps * direction;
            const Seen seen = look_up(job, s, point);
            if (point.z > seen.rise) continue;
            value = job.settings->measure.value((m - 0.5f) / steps);
            if (job.indirect) add_radiance(job, s, seen, light);
            break;
        }
        sum.add_light(light, static_cast<double>(c));
        sum.open += static_cast<double>(c);
        sum.seen += static_cast<double>(c * value);
    });
    return sum.answer(sum.seen / sum.open);
}

Answer integral_at(const EstimateJob& job, const Shaded& s) {
    switch (job.settings->desc.estimator) {
        case DFIELD_ESTIMATOR_DISK:
            return disk_integral(job, s);
        case DFIELD_ESTIMATOR_MARCH:
            return march_integral(job, s);
        default:
            return volume_integral(job, s);
    }
}

}  // namespace

void dfield_screen::integral(const dfield_screen_buffers& buffers, const std::uint32_t* pixels,
                             std::size_t count, float* visibility, float* indirect) {
    const Layout layout(buffers.width, buffers.height);
    const Frame frame = decoded(buffers, memory_of(layout.size()));
    EstimateJob job;
    job.frame = &frame;
    job.settings = &settings_;
    job.indirect = indirect != nullptr;
    context()->for_ranges(count, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto pixel = static_cast<std::int32_t>(pixels ? pixels[i] : i);
            const std::int32_t column = pixel % layout.width, row = pixel / layout.width;
            Answer answer;
            if (frame.depth[layout.index(column, row)] < kSky && frame.radius > 0) {
                const Shaded s = shaded_at(frame, column, row);
                if (!empty(s)) answer = integral_at(job, s);
            }
            visibility[i] = answer.visibility;
            for (int k = 0; indirect && k < 3; ++k)
                indirect[3 * i + static_cast<std::size_t>(k)] = answer.indirect[k];
        }
    });
}
