// Volumes as callers hand them over, checked.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "dfield/dfield.h"
#include "status.hpp"
#include "volume/grid.hpp"

namespace dfield::runtime::volume {

inline Grid checked_grid(const dfield_volume_grid& given) {
    for (int axis = 0; axis < 3; ++axis) {
        require(given.dims[axis] >= 1 && given.dims[axis] <= DFIELD_MAX_VOLUME_DIM,
                "volume: every dimension must be 1..65536");
        require(std::isfinite(given.spacing[axis]) && given.spacing[axis] > 0,
                "volume: every spacing must be finite and above 0");
    }
    const auto [low, high] = std::minmax_element(given.spacing, given.spacing + 3);
    require(*high / *low <= 1000, "volume: spacings differ by more than 1000 times");
    require(*high <= 1e9f && *low >= 1e-9f, "volume: spacings must be 1e-9..1e9");
    require(std::uint64_t{given.dims[0]} * given.dims[1] < (std::uint64_t{1} << 31),
            "volume: a slice has 2^31 samples or more");
    require(std::uint64_t{given.dims[0]} * given.dims[1] * given.dims[2] <
                std::numeric_limits<std::size_t>::max() / 64,
            "volume: too many voxels for this machine");
    return {given.dims[0],    given.dims[1],    given.dims[2],
            given.spacing[0], given.spacing[1], given.spacing[2]};
}

inline Samples checked_samples(const dfield_volume_samples& given, const Grid& grid, float isovalue = 0) {
    constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4};
    require(given.data, "volume: samples->data is null");
    require(given.type <= DFIELD_SAMPLE_F32, "volume: unknown type of samples");
    require(std::isfinite(isovalue) && std::abs(isovalue) <= 1e30f, "volume: the isovalue must be finite");
    const std::size_t row = grid.nx * kSizes[given.type];
    Samples samples{given.data, static_cast<SampleType>(given.type),
                    given.row_stride ? given.row_stride : row, 0, isovalue};
    samples.slice_stride = given.slice_stride ? given.slice_stride : samples.row_stride * grid.ny;
    require(samples.row_stride >= row || grid.ny == 1, "volume: row_stride is less than a row");
    return samples;
}

}  // namespace dfield::runtime::volume
