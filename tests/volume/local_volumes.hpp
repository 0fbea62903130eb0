// Volumes and calls that the tests of local and contextual ambient occlusion share.
#pragma once

#include <cmath>
#include <dfield/dfield.hpp>
#include <vector>

#include "tests/random.hpp"
#include "tests/volume/sweeping.hpp"

namespace dfield::test {

// Soft blobs of values 0..255 with empty space between them.
inline models::ScalarVolume blobs(models::Dims dims, std::uint64_t seed,
                                  models::Spacing spacing = {1, 1, 1}) {
    Random random(seed);
    const double px = random.uniform(0.25, 0.6), py = random.uniform(0.25, 0.6),
                 pz = random.uniform(0.25, 0.6), at = random.uniform(0, 6);
    models::ScalarVolume volume{dims, spacing, {}};
    for (std::uint32_t z = 0; z < dims[2]; ++z)
        for (std::uint32_t y = 0; y < dims[1]; ++y)
            for (std::uint32_t x = 0; x < dims[0]; ++x) {
                const double wave = std::sin(px * x + at) * std::sin(py * y + at) * std::sin(pz * z + at);
                volume.values.push_back(static_cast<float>(std::round(std::max(0.0, 255 * wave))));
            }
    return volume;
}

struct Transfer {
    std::vector<dfield_opacity_point> points{{20, 0}, {120, 0.6f}, {250, 0.9f}};
    float unit_length = 0;

    dfield_opacity_desc desc() const {
        dfield_opacity_desc desc{};
        desc.struct_size = sizeof desc;
        desc.points = points.data();
        desc.point_count = points.size();
        desc.unit_length = unit_length;
        return desc;
    }
};

inline dfield_local_desc local_desc(std::uint32_t rays = 54, std::uint32_t samples = 12) {
    dfield_local_desc desc = local_defaults();
    desc.ray_count = rays;
    desc.samples = samples;
    if (rays != 6 && rays != 14 && rays != 26 && rays != 54) desc.ray_set = DFIELD_RAYS_FIBONACCI;
    return desc;
}

inline std::vector<float> local_ao(const Context& context, const dfield_volume_samples& samples,
                                   const dfield_local_desc& desc, const Transfer& transfer = {}) {
    std::vector<float> visibility(std::size_t{samples.grid.dims[0]} * samples.grid.dims[1] *
                                  samples.grid.dims[2]);
    local_ao_volume(context, samples, transfer.desc(), desc, visibility.data());
    return visibility;
}

inline std::vector<float> local_ao(const models::ScalarVolume& volume, const dfield_local_desc& desc,
                                   const Transfer& transfer = {}, dfield_simd simd = DFIELD_SIMD_BEST) {
    const dfield_context_desc how = context_desc(simd);
    return local_ao(Context(&how), samples_of(volume), desc, transfer);
}

inline float largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    float largest = a.size() == b.size() ? 0.0f : INFINITY;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

}  // namespace dfield::test
