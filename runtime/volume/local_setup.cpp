#include "volume/local_setup.hpp"

#include "desc.hpp"

namespace dfield::runtime::volume {
namespace {

constexpr const char* kVersion =
    "local ambient occlusion: a struct_size is of no known version; header and library are of different "
    "versions, or "
    "the field was not set";

}  // namespace

dfield_volume_samples checked_volume(const dfield_volume_samples* given) {
    require(given, "local ambient occlusion: samples is null");
    return read_desc(given, {}, kVersion);
}

dfield_local_desc checked_local(const dfield_local_desc* given) {
    require(given, "local ambient occlusion: desc is null");
    const auto desc = read_desc(given, {}, kVersion);
    require(desc.ray_set <= DFIELD_RAYS_FIBONACCI, "local ambient occlusion: unknown ray_set");
    require(desc.ray_count >= 1 && desc.ray_count <= DFIELD_MAX_LOCAL_RAYS,
            "local ambient occlusion: ray_count must be 1..4096");
    require(desc.ray_set == DFIELD_RAYS_FIBONACCI || desc.ray_count == 6 || desc.ray_count == 14 ||
                desc.ray_count == 26 || desc.ray_count == 54,
            "local ambient occlusion: NEIGHBOURS has 6, 14, 26 or 54 rays; for other numbers take FIBONACCI");
    require(desc.samples >= 1 && desc.samples <= DFIELD_MAX_LOCAL_SAMPLES,
            "local ambient occlusion: samples must be 1..1024");
    require(desc.step_unit <= DFIELD_STEP_WORLD, "local ambient occlusion: unknown step_unit");
    require(std::isfinite(desc.step) && desc.step > 0,
            "local ambient occlusion: step must be finite and above 0");
    require(desc.jitter >= 0 && desc.jitter <= 1, "local ambient occlusion: jitter must be 0..1");
    require(desc.approximate <= 1, "local ambient occlusion: approximate must be 0 or 1");
    require(desc.approximate == 0 || desc.jitter == 0,
            "local ambient occlusion: approximate rays have no jitter; choose one of them");
    for (std::uint32_t k = 0; desc.weights && k < desc.ray_count; ++k)
        require(std::isfinite(desc.weights[k]) && desc.weights[k] >= 0,
                "local ambient occlusion: weights must be finite and not negative");
    return desc;
}

std::vector<glm::dvec3> directions_of(const dfield_local_desc& desc) {
    return desc.ray_set == DFIELD_RAYS_NEIGHBOURS ? neighbour_directions(desc.ray_count)
                                                  : fibonacci_directions(desc.ray_count);
}

LocalRays rays_of(dfield_context* context, const Grid& grid, const dfield_local_desc& desc) {
    const std::vector<glm::dvec3> directions = directions_of(desc);
    RayOptions options;
    options.directions = directions;
    if (desc.weights) options.weights = {desc.weights, desc.ray_count};
    options.samples = desc.samples;
    options.step = static_cast<double>(desc.step);
    options.world = desc.step_unit == DFIELD_STEP_WORLD;
    options.jitter = {desc.jitter, desc.seed};
    options.approximate = desc.approximate != 0;
    const double voxel = options.world ? static_cast<double>(grid.h()) : 1.0;
    require(options.step * desc.samples / voxel <= DFIELD_MAX_VOLUME_DIM,
            "local ambient occlusion: rays are longer than 65536 voxels; is step in the right unit?");
    return make_local_rays(context, grid, options);
}

OpacityFunction opacity_of(dfield_context* context, const dfield_opacity_desc* given,
                           const dfield_local_desc& local, const Grid& grid, SampleType type) {
    require(given, "local ambient occlusion: the transfer function is null");
    const auto desc = read_desc(given, {}, kVersion);
    require(desc.points && desc.point_count > 0,
            "local ambient occlusion: the transfer function has no points");
    std::pmr::vector<OpacityFunction::Point> points(context);
    for (std::size_t i = 0; i < desc.point_count; ++i) {
        const dfield_opacity_point& p = desc.points[i];
        require(std::isfinite(p.value) && (i == 0 || p.value >= desc.points[i - 1].value),
                "local ambient occlusion: the transfer function's values must be finite and ascend");
        require(p.opacity >= 0 && p.opacity <= 1,
                "local ambient occlusion: the transfer function's opacities must be 0..1");
        points.push_back({p.value, p.opacity});
    }
    require(std::isfinite(desc.unit_length) && desc.unit_length >= 0,
            "local ambient occlusion: unit_length must be finite and not negative");
    float exponent = 1;
    if (desc.unit_length > 0) {
        const bool world = local.step_unit == DFIELD_STEP_WORLD;
        require(
            world || grid.isotropic(),
            "local ambient occlusion: opacities of a length need steps in world units where spacings differ");
        exponent = local.step * (world ? 1 : grid.hx) / desc.unit_length;
        require(std::isfinite(exponent), "local ambient occlusion: unit_length is too small");
    }
    return {context, points, exponent, type};
}

void require_finite(bool finite) {
    require(finite, "volume: the samples hold a NaN or an infinity: replace them first");
}

}  // namespace dfield::runtime::volume
