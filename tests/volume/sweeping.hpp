// Sweeps of the generated volumes with everything that they can leave.
#pragma once

#include <dfield/dfield.hpp>
#include <dfield/threads.hpp>
#include <string>
#include <vector>

#include "models/volumes.hpp"

namespace dfield::test {

struct Swept {
    dfield_volume_grid grid{};
    std::vector<float> distance, visibility;
    std::vector<std::uint8_t> octants;  // empty where the form has none

    std::size_t size() const { return distance.size(); }
    std::size_t index(std::size_t x, std::size_t y, std::size_t z) const {
        return x + grid.dims[0] * (y + grid.dims[1] * z);
    }
    int octant(std::size_t s, std::size_t voxel) const {
        return octants[4 * (s / 4 * size() + voxel) + s % 4];
    }
};

inline dfield_context_desc context_desc(dfield_simd simd) {
    dfield_context_desc desc{};
    desc.struct_size = sizeof desc;
    desc.simd = simd;
    return desc;
}

inline dfield_volume_samples samples_of(const models::ScalarVolume& volume) {
    dfield_volume_samples samples{};
    samples.struct_size = sizeof samples;
    for (int axis = 0; axis < 3; ++axis) {
        samples.grid.dims[axis] = volume.dims[static_cast<std::size_t>(axis)];
        samples.grid.spacing[axis] = static_cast<float>(volume.spacing[static_cast<std::size_t>(axis)]);
    }
    samples.type = DFIELD_SAMPLE_F32;
    samples.data = volume.values.data();
    return samples;
}

inline Swept sweep(const Context& context, const dfield_volume_samples& samples,
                   const dfield_sweep_desc& desc = sweep_defaults()) {
    Swept swept;
    swept.grid = samples.grid;
    const std::size_t size = std::size_t{swept.grid.dims[0]} * swept.grid.dims[1] * swept.grid.dims[2];
    swept.distance.resize(size);
    swept.visibility.resize(size);
    const bool light = desc.light[0] != 0 || desc.light[1] != 0 || desc.light[2] != 0;
    if (desc.form != DFIELD_FORM_COMBINED && !light) swept.octants.resize(8 * size);
    dfield_sweep_outputs outputs = no_sweep_outputs();
    outputs.distance = swept.distance.data();
    outputs.visibility = swept.visibility.data();
    outputs.octants = swept.octants.empty() ? nullptr : swept.octants.data();
    sweep_volume(context, samples, desc, outputs);
    return swept;
}

inline Swept sweep(const models::ScalarVolume& volume, const dfield_sweep_desc& desc = sweep_defaults(),
                   dfield_simd simd = DFIELD_SIMD_BEST) {
    const dfield_context_desc how = context_desc(simd);
    return sweep(Context(&how), samples_of(volume), desc);
}

inline dfield_sweep_desc form_desc(dfield_occlusion_form form) {
    dfield_sweep_desc desc = sweep_defaults();
    desc.form = form;
    return desc;
}

constexpr dfield_occlusion_form kForms[] = {DFIELD_FORM_IMPROVED, DFIELD_FORM_PAPER, DFIELD_FORM_COMBINED};

}  // namespace dfield::test
