// The C ABI of volume.h.
#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "context.hpp"
#include "desc.hpp"
#include "dfield/dfield.h"
#include "status.hpp"
#include "strided.hpp"
#include "volume/buffer.hpp"
#include "volume/checks.hpp"
#include "volume/evaluate.hpp"
#include "volume/field.hpp"
#include "volume/monte_carlo.hpp"
#include "volume/occlusion.hpp"
#include "volume/octant_geometry.hpp"
#include "volume/rotated.hpp"
#include "volume/sweep.hpp"

using namespace dfield::runtime;
using namespace dfield::runtime::volume;

namespace {

void check_sweep(const dfield_sweep_desc& desc, const dfield_sweep_outputs& outputs) {
    require(desc.form <= DFIELD_FORM_COMBINED, "dfield_volume_sweep: unknown form");
    require(desc.form != DFIELD_FORM_IMPROVED || desc.ordinates == 24 || desc.ordinates == 48,
            "dfield_volume_sweep: ordinates must be 24 or 48");
    require(desc.octants >= 1 && desc.octants <= DFIELD_ALL_OCTANTS,
            "dfield_volume_sweep: octants must name some of the eight");
    for (const float intensity : desc.intensities)
        require(std::isfinite(intensity) && intensity >= 0,
                "dfield_volume_sweep: intensities must be finite and not negative");
    require(std::isfinite(desc.gamma) && desc.gamma > 0, "dfield_volume_sweep: gamma must be above 0");
    require(desc.alpha >= 0 && desc.alpha <= 1, "dfield_volume_sweep: alpha must be 0..1");
    require(desc.band > 0, "dfield_volume_sweep: band must be above 0");
    const glm::vec3 light(desc.light[0], desc.light[1], desc.light[2]);
    require(finite(light), "dfield_volume_sweep: the light's direction is not finite");
    const bool whole = desc.form != DFIELD_FORM_COMBINED && light == glm::vec3(0);
    require(whole || !outputs.octants, "dfield_volume_sweep: COMBINED and lights leave no octants");
    require(outputs.distance || outputs.visibility || outputs.octants,
            "dfield_volume_sweep: no output is asked for");
}

class Stopwatch {
  public:
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
    }

  private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void sweep(dfield_context* context, const Grid& grid, const Samples& samples, const dfield_sweep_desc& desc,
           const dfield_sweep_outputs& outputs, dfield_sweep_times& times) {
    Stopwatch watch;
    const glm::vec3 light(desc.light[0], desc.light[1], desc.light[2]);
    const bool lit = light != glm::vec3(0), occlusion = outputs.visibility || outputs.octants;
    std::array<float, kOctants> intensities{};
    for (std::size_t s = 0; s < kOctants; ++s)
        if (desc.octants >> s & 1) intensities[s] = desc.intensities[s];

    Buffer<float> own_distance(context, outputs.distance ? 0 : grid.size());
    Buffer<std::uint8_t> own_octants;
    DistanceJob job;
    job.context = context;
    job.grid = grid;
    job.samples = samples;
    job.distance = outputs.distance ? outputs.distance : own_distance.get();
    job.alpha = desc.alpha;
    job.band = std::min(desc.band, std::numeric_limits<float>::infinity());
    // What reads the field afterwards reads it a few voxels deep.
    const bool afterwards = occlusion && (lit || desc.form == DFIELD_FORM_IMPROVED);
    if (afterwards) job.band = std::max(job.band, 8 * std::max({grid.hx, grid.hy, grid.hz}));
    if (occlusion && !lit && desc.form == DFIELD_FORM_PAPER) {
        job.carried = Carried::kOctants;
        if (!outputs.octants) own_octants = Buffer<std::uint8_t>(context, 8 * grid.size());
        job.octants = outputs.octants ? outputs.octants : own_octants.get();
    } else if (occlusion && !lit && desc.form == DFIELD_FORM_COMBINED) {
        job.carried = Carried::kCombined;
        job.combined = outputs.visibility;
        const auto shining = static_cast<float>(std::popcount(desc.octants));
        for (std::size_t s = 0; s < kOctants; ++s) job.intensities[s] = intensities[s] / shining;
    }
    if (distance_function(context->simd_targets)(job) == SweepResult::kNotFinite)
        throw Failure{DFIELD_INVALID_ARGUMENT,
                      "dfield_volume_sweep: the samples hold a NaN or an infinity: replace them first"};
    times.sweeps = watch.lap();

    if (occlusion && lit) {
        sweep_light(context, {grid, job.distance}, glm::normalize(light), desc.form == DFIELD_FORM_IMPROVED,
                    desc.alpha, outputs.visibility);
    } else if (occlusion && desc.form == DFIELD_FORM_IMPROVED) {
        OcclusionJob improved;
        improved.context = context;
        improved.grid = grid;
        improved.distance = job.distance;
        improved.ordinates = desc.ordinates / kOctants;
        improved.alpha = desc.alpha;
        improved.through = desc.through != 0;
        improved.intensities = intensities;
        improved.visibility = outputs.visibility;
        improved.octants = outputs.octants;
        occlusion_function(context->simd_targets)(improved);
    }
    times.occlusion = watch.lap();

    if (outputs.visibility) {
        if (job.carried == Carried::kOctants) {
            EvaluationJob evaluation;
            evaluation.context = context;
            evaluation.grid = grid;
            evaluation.distance = job.distance;
            evaluation.octants = job.octants;
            evaluation.intensities = intensities;
            evaluation.through = desc.through != 0;
            evaluation.visibility = outputs.visibility;
            evaluation_function(context->simd_targets)(evaluation);
        }
        apply_gamma(*context, desc.gamma, outputs.visibility, grid.size());
    }
    // The band that was asked for, where more was needed.
    if (outputs.distance && job.band > desc.band)
        context->for_ranges(grid.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                outputs.distance[i] = std::clamp(outputs.distance[i], -desc.band, desc.band);
        });
    times.evaluation = watch.lap();
}

// Calls use(index, point, unit normal or 0) for all points; without a normal of its own, a point has the
// gradient of `distance` there.
template<class Use>
void for_points(const dfield_context& context, const dfield_volume_points& points, const SignedField& field,
                const Use& use) {
    const Strided<const float> positions(points.positions, points.position_stride, 3);
    const Strided<const float> normals(points.normals, points.normal_stride, 3);
    context.for_ranges(points.count, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            glm::vec3 normal(0);
            if (normals) normal = normals.vec3(i);
            if (normal == glm::vec3(0) && field.distance) normal = field.gradient(positions.vec3(i));
            const float length = glm::length(normal);
            use(i, positions.vec3(i), length > 0 && std::isfinite(length) ? normal / length : glm::vec3(0));
        }
    });
}

void check_points(const dfield_volume_points* points) {
    require(points, "volume: points is null");
    require(points->count == 0 || points->positions, "volume: points->positions is null");
    const Strided<const float> positions(points->positions, points->position_stride, 3);
    for (std::size_t i = 0; i < points->count; ++i)
        require(finite(positions.vec3(i)), "volume: a point's position is not finite");
}

}  // namespace

extern "C" {

void dfield_sweep_desc_init(dfield_sweep_desc* desc) {
    if (!desc) return;
    *desc = {};
    desc->struct_size = sizeof *desc;
    desc->form = DFIELD_FORM_IMPROVED;
    desc->ordinates = 24;
    desc->octants = DFIELD_ALL_OCTANTS;
    std::fill_n(desc->intensities, DFIELD_OCTANT_COUNT, 1.0f);
    desc->gamma = 1;
    desc->alpha = 1;
    desc->band = std::numeric_limits<float>::infinity();
}

dfield_status dfield_volume_sweep(dfield_context* context, const dfield_volume_samples* samples,
                                  const dfield_sweep_desc* desc, const dfield_sweep_outputs* outputs,
                                  dfield_sweep_times* times) {
    return guarded([&] {
        require(context, "dfield_volume_sweep: context is null");
        require(samples && desc && outputs, "dfield_volume_sweep: samples, desc or outputs is null");
        constexpr const char* kVersion =
            "dfield_volume_sweep: a struct_size is of no known version; header and library are of different "
            "versions, or the field was not set";
        const auto given = read_desc(samples, {}, kVersion);
        const auto how = read_desc(desc, {}, kVersion);
        const auto where = read_desc(outputs, {}, kVersion);
        const Grid grid = checked_grid(given.grid);
        const Samples values = checked_samples(given, grid, how.isovalue);
        check_sweep(how, where);
        dfield_sweep_times measured{};
        sweep(context, grid, values, how, where, measured);
        if (times) *times = measured;
    });
}

dfield_status dfield_volume_visibility_by_rays(dfield_context* context, const dfield_volume_grid* grid,
                                               const float* distance, const dfield_volume_points* points,
                                               uint32_t rays, uint64_t seed, float* visibility) {
    return guarded([&] {
        require(context && grid && distance && visibility,
                "dfield_volume_visibility_by_rays: an argument is null");
        require(rays >= 1 && rays <= 65536, "dfield_volume_visibility_by_rays: rays must be 1..65536");
        check_points(points);
        const SignedField field{checked_grid(*grid), distance};
        for_points(
            *context, *points, field, [&](std::size_t i, const glm::vec3& point, const glm::vec3& normal) {
                visibility[i] =
                    normal == glm::vec3(0) ? 1.0f : visibility_by_rays(field, point, normal, rays, seed + i);
            });
    });
}

dfield_status dfield_volume_gather_octants(dfield_context* context, const dfield_volume_grid* grid,
                                           const float* distance, const uint8_t* octants,
                                           const dfield_volume_points* points, float* visibility) {
    return guarded([&] {
        require(context && grid && octants && visibility,
                "dfield_volume_gather_octants: an argument is null");
        check_points(points);
        require(distance || points->normals,
                "dfield_volume_gather_octants: needs normals or the distance field");
        const Grid g = checked_grid(*grid);
        const OctantTable& geometry = OctantTable::shared();
        for_points(*context, *points, {g, distance},
                   [&](std::size_t i, const glm::vec3& point, const glm::vec3& normal) {
                       const Cell cell(g, point);
                       OctantTerms terms;
                       terms.fill(1);
                       if (normal != glm::vec3(0)) terms = geometry(normal);
                       float sum = 0, all = 0;
                       for (std::size_t s = 0; s < kOctants; ++s) {
                           const uint8_t* const channel = octants + 4 * (s / 4) * g.size() + s % 4;
                           sum += terms[s] * cell.blend([&](auto x, auto y, auto z) {
                               return static_cast<float>(channel[4 * g.index(x, y, z)]) / 255;
                           });
                           all += terms[s];
                       }
                       visibility[i] = sum / all;
                   });
    });
}

dfield_status dfield_volume_interpolate(dfield_context* context, const dfield_volume_grid* grid,
                                        const float* field, const dfield_volume_points* points, float* values,
                                        float* gradients) {
    return guarded([&] {
        require(context && grid && field, "dfield_volume_interpolate: an argument is null");
        check_points(points);
        const SignedField at{checked_grid(*grid), field};
        const Strided<const float> positions(points->positions, points->position_stride, 3);
        context->for_ranges(points->count, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const glm::vec3 point = positions.vec3(i);
                if (values) values[i] = at.at(point);
                if (!gradients) continue;
                const glm::vec3 gradient = at.gradient(point);
                const float length = glm::length(gradient);
                for (int axis = 0; axis < 3; ++axis)
                    gradients[3 * i + static_cast<std::size_t>(axis)] =
                        length > 0 && std::isfinite(length) ? gradient[axis] / length : 0.0f;
            }
        });
    });
}

void dfield_octant_geometry(const float normal[3], int through, float terms[DFIELD_OCTANT_COUNT]) {
    if (!normal || !terms) return;
    const glm::vec3 n(normal[0], normal[1], normal[2]);
    const OctantTerms result = through ? octant_geometry_through(n) : octant_geometry(n);
    std::copy(result.begin(), result.end(), terms);
}
}
