// The C ABI of local.h that needs no session.
#include "context.hpp"
#include "volume/local_setup.hpp"

using namespace dfield::runtime;
using namespace dfield::runtime::volume;

extern "C" {

void dfield_local_desc_init(dfield_local_desc* desc) {
    if (!desc) return;
    *desc = {};
    desc->struct_size = sizeof *desc;
    desc->ray_set = DFIELD_RAYS_NEIGHBOURS;
    desc->ray_count = 54;
    desc->samples = 20;
    desc->step_unit = DFIELD_STEP_VOXELS;
    desc->step = 1;
}

dfield_status dfield_local_get_directions(const dfield_local_desc* desc, float* directions) {
    return guarded([&] {
        require(directions, "dfield_local_get_directions: directions is null");
        for (const glm::dvec3& direction : directions_of(checked_local(desc)))
            for (int axis = 0; axis < 3; ++axis) *directions++ = static_cast<float>(direction[axis]);
    });
}

dfield_status dfield_volume_local_ao(dfield_context* context, const dfield_volume_samples* samples,
                                     const dfield_opacity_desc* opacity, const dfield_local_desc* desc,
                                     float* visibility) {
    return guarded([&] {
        require(context && samples && visibility, "dfield_volume_local_ao: an argument is null");
        const dfield_volume_samples given = checked_volume(samples);
        const Grid grid = checked_grid(given.grid);
        const Samples values = checked_samples(given, grid);
        const dfield_local_desc local = checked_local(desc);
        const OpacityFunction function = opacity_of(context, opacity, local, grid, values.type);
        const LocalRays rays = rays_of(context, grid, local);
        OpacityVolume volume = opacity_volume(context, grid, rays);
        require_finite(fill_opacity(context, values, function, volume));
        const LocalPlan plan(context, rays, volume);
        compute_local(context, {&volume, &plan, visibility});
    });
}
}
