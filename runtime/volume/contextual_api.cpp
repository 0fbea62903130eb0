// The C ABI of contextual.h.
#include "context.hpp"
#include "desc.hpp"
#include "strided.hpp"
#include "volume/contextual.hpp"
#include "volume/local_setup.hpp"

using namespace dfield::runtime;
using namespace dfield::runtime::volume;

namespace {

constexpr const char* kVersion =
    "contextual ambient occlusion: a struct_size is of no known version; header and library are of different "
    "versions, or the field was not set";

void check_clip_samples(std::uint32_t samples) {
    require(samples <= DFIELD_MAX_CLIP_SAMPLES, "contextual ambient occlusion: clip_samples must be 0..240");
}

}  // namespace

extern "C" {

void dfield_clip_mesh_desc_init(dfield_clip_mesh_desc* desc) {
    if (!desc) return;
    *desc = {};
    desc->struct_size = sizeof *desc;
    desc->method = DFIELD_CLIP_AUTO;
    desc->axis = 2;
    desc->resolution = 512;
}

dfield_status dfield_clip_mesh_create(dfield_context* context, const dfield_clip_mesh_desc* given,
                                      dfield_clip_mesh** mesh) {
    return guarded([&] {
        require(context && given && mesh, "dfield_clip_mesh_create: an argument is null");
        const auto desc = read_desc(given, {}, kVersion);
        require(desc.positions && desc.indices, "dfield_clip_mesh_create: positions or indices is null");
        require(desc.vertex_count >= 1 && desc.vertex_count < 0xffffffffu,
                "dfield_clip_mesh_create: vertex_count must be 1 or more, and below 2^32 - 1");
        require(desc.triangle_count >= 1 && desc.triangle_count < 0x55555555u,
                "dfield_clip_mesh_create: triangle_count must be 1 or more, and below 2^32 / 3");
        require(desc.method <= DFIELD_CLIP_EXACT, "dfield_clip_mesh_create: unknown method");
        require(desc.axis <= 2, "dfield_clip_mesh_create: axis must be 0, 1 or 2");
        require(desc.resolution >= 1 && desc.resolution <= 4096,
                "dfield_clip_mesh_create: resolution must be 1..4096");
        *mesh = dfield_clip_mesh::make(context, desc);
    });
}

void dfield_clip_mesh_release(dfield_clip_mesh* mesh) {
    if (mesh) mesh->release();
}

dfield_clip_method dfield_clip_mesh_get_method(const dfield_clip_mesh* mesh) {
    return mesh && !mesh->exact() ? DFIELD_CLIP_DEPTH_MAPS : DFIELD_CLIP_EXACT;
}

uint32_t dfield_clip_mesh_get_layers(const dfield_clip_mesh* mesh) {
    return mesh ? mesh->layers() : 0;
}

dfield_status dfield_volume_local_ao_clipped(dfield_context* context, const dfield_volume_samples* samples,
                                             const dfield_opacity_desc* opacity,
                                             const dfield_local_desc* desc, const dfield_clip* clips,
                                             size_t clip_count, uint32_t clip_samples, float* visibility) {
    return guarded([&] {
        require(context && samples && visibility, "dfield_volume_local_ao_clipped: an argument is null");
        require(clips || clip_count == 0, "dfield_volume_local_ao_clipped: clips is null");
        check_clip_samples(clip_samples);
        const dfield_volume_samples given = checked_volume(samples);
        const Grid grid = checked_grid(given.grid);
        const Samples values = checked_samples(given, grid);
        const dfield_local_desc local = checked_local(desc);
        const OpacityFunction function = opacity_of(context, opacity, local, grid, values.type);
        const LocalRays rays = rays_of(context, grid, local);
        OpacityVolume volume = opacity_volume(context, grid, rays);
        const LocalPlan plan(context, rays, volume);
        std::pmr::vector<PlacedClip> placed(context);
        for (std::size_t i = 0; i < clip_count; ++i) placed.emplace_back(clips[i], grid);
        const Coverage coverage(context, clip_samples);
        const Buffer<std::uint8_t> left(context, grid.size());

        require_finite(fill_opacity(context, values, function, volume));
        context->for_ranges(grid.ny * grid.nz, [&](std::size_t begin, std::size_t end) {
            for (std::size_t row = begin; row < end; ++row)
                for (std::size_t x = 0; x < grid.nx; ++x) {
                    const std::size_t y = row % grid.ny, z = row / grid.ny;
                    const std::uint8_t here = coverage.of_voxel(placed, x, y, z);
                    left.get()[grid.index(x, y, z)] = here;
                    if (here != coverage.all()) volume.row(y, z)[x] *= coverage.share(here);
                }
        });
        const std::size_t low[3] = {0, 0, 0}, high[3] = {grid.nx, grid.ny, grid.nz};
        volume.update_occupied(context, low, high);
        compute_local(context, {&volume, &plan, visibility});
        context->for_ranges(grid.nz, [&](std::size_t begin, std::size_t end) {
            for (std::size_t z = begin; z < end; z += 1)
                if (z % kBlockZ == 0)
                    for (std::size_t y = 0; y < grid.ny; y += kBlockY)
                        for (std::size_t x = 0; x < grid.nx; x += kBlockX)
                            open_gone_voxels(grid, left.get(), x, y, z, visibility);
        });
    });
}

void dfield_contextual_desc_init(dfield_contextual_desc* desc) {
    if (!desc) return;
    *desc = {};
    desc->struct_size = sizeof *desc;
    desc->samples.struct_size = sizeof desc->samples;
    desc->opacity.struct_size = sizeof desc->opacity;
    dfield_local_desc_init(&desc->local);
    desc->clip_samples = DFIELD_CLIP_SAMPLES;
    desc->mask = DFIELD_UPDATE_CHANGED;
}

dfield_status dfield_contextual_create(dfield_context* context, const dfield_contextual_desc* given,
                                       dfield_contextual** session) {
    return guarded([&] {
        require(context && given && session, "dfield_contextual_create: an argument is null");
        const auto desc = read_desc(given, {}, kVersion);
        check_clip_samples(desc.clip_samples);
        require(desc.mask <= DFIELD_UPDATE_DILATED, "dfield_contextual_create: unknown mask");
        require(desc.local.approximate == 0,
                "dfield_contextual_create: sessions are exact; leave local.approximate at 0");
        *session = dfield_contextual::make(context, desc);
    });
}

void dfield_contextual_release(dfield_contextual* session) {
    if (session) session->release();
}

dfield_status dfield_contextual_add_clip(dfield_contextual* session, const dfield_clip* clip, uint32_t* id) {
    return guarded([&] {
        require(session && clip && id, "dfield_contextual_add_clip: an argument is null");
        *id = session->add(*clip);
    });
}

dfield_status dfield_contextual_move_clip(dfield_contextual* session, uint32_t id,
                                          const float mesh_to_world[16]) {
    return guarded([&] {
        require(session && mesh_to_world, "dfield_contextual_move_clip: an argument is null");
        session->move(id, mesh_to_world);
    });
}

dfield_status dfield_contextual_remove_clip(dfield_contextual* session, uint32_t id) {
    return guarded([&] {
        require(session, "dfield_contextual_remove_clip: session is null");
        session->remove(id);
    });
}

dfield_status dfield_contextual_set_opacity(dfield_contextual* session, const dfield_opacity_desc* opacity) {
    return guarded([&] {
        require(session && opacity, "dfield_contextual_set_opacity: an argument is null");
        session->set_opacity(*opacity);
    });
}

dfield_status dfield_contextual_update(dfield_contextual* session, const dfield_update_desc* given,
                                       dfield_update_result* result) {
    return guarded([&] {
        require(session, "dfield_contextual_update: session is null");
        dfield_update_desc desc{};
        if (given) desc = read_desc(given, {}, kVersion);
        require(desc.seconds >= 0, "dfield_contextual_update: seconds must not be negative");
        dfield_update_result found{};
        session->update(desc, found);
        if (result) *result = found;
    });
}

const float* dfield_contextual_get_visibility(const dfield_contextual* session) {
    return session ? session->visibility() : nullptr;
}

const uint8_t* dfield_contextual_get_coverage(const dfield_contextual* session) {
    return session ? session->left() : nullptr;
}

dfield_status dfield_contextual_test_points(const dfield_contextual* session, size_t count,
                                            const float* positions, size_t position_stride,
                                            uint8_t* clipped) {
    return guarded([&] {
        require(session && (count == 0 || (positions && clipped)),
                "dfield_contextual_test_points: an argument is null");
        const Strided<const float> points(positions, position_stride, 3);
        const Grid& grid = session->grid();
        for (std::size_t i = 0; i < count; ++i) {
            const glm::dvec3 voxel = glm::dvec3(points.vec3(i)) / glm::dvec3(grid.hx, grid.hy, grid.hz);
            clipped[i] = 0;
            for (const PlacedClip& clip : session->applied())
                if (clip.clips(clip.to_camera(voxel.x, voxel.y, voxel.z))) clipped[i] = 1;
        }
    });
}
}
