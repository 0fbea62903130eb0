#include "baker/volume/volume.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <type_traits>

#include "baker/error.hpp"

namespace dfield {

std::size_t size_of(VoxelType type) {
    return visit_type(type, [](auto voxel) { return sizeof voxel; });
}

const char* name_of(VoxelType type) {
    switch (type) {
        case VoxelType::kI8:
            return "i8";
        case VoxelType::kU8:
            return "u8";
        case VoxelType::kI16:
            return "i16";
        case VoxelType::kU16:
            return "u16";
        case VoxelType::kI32:
            return "i32";
        case VoxelType::kU32:
            return "u32";
        case VoxelType::kF32:
            return "f32";
        case VoxelType::kF64:
            break;
    }
    return "f64";
}

bool is_floating(VoxelType type) {
    return type == VoxelType::kF32 || type == VoxelType::kF64;
}

std::string size_text(std::span<const std::size_t> size) {
    std::string text;
    for (const std::size_t axis : size) {
        if (!text.empty()) text += " x ";
        text += std::to_string(axis);
    }
    return text;
}

glm::dvec3 VolumeGrid::spacing() const {
    return {glm::length(directions[0]), glm::length(directions[1]), glm::length(directions[2])};
}

bool VolumeGrid::right_handed() const {
    return glm::determinant(directions) > 0;
}

bool VolumeGrid::axis_aligned() const {
    for (int axis = 0; axis < 3; ++axis)
        for (int component = 0; component < 3; ++component) {
            const double value = directions[axis][component];
            if (axis == component ? !(value > 0) : value != 0) return false;
        }
    return true;
}

ValueRange value_range(const Volume& volume) {
    return visit_type(volume.type, [&](auto voxel) {
        using T = decltype(voxel);
        const std::span<const T> voxels = volume.voxels<T>();
        if (voxels.empty()) return ValueRange{};
        // Plain comparisons, which compilers vectorise; std::minmax_element keeps positions.
        T low = voxels[0], high = voxels[0];
        for (const T value : voxels) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
        return ValueRange{static_cast<double>(low), static_cast<double>(high)};
    });
}

std::vector<float> float_values(const Volume& volume) {
    return visit_type(volume.type, [&](auto voxel) {
        using T = decltype(voxel);
        const std::span<const T> voxels = volume.voxels<T>();
        std::vector<float> values(voxels.size());
        std::transform(voxels.begin(), voxels.end(), values.begin(),
                       [](T value) { return static_cast<float>(value); });
        if constexpr (std::is_same_v<T, double>)
            for (std::size_t i = 0; i < voxels.size(); ++i)
                if (std::isinf(values[i]))
                    throw InputError("voxel " + std::to_string(i) +
                                     " does not fit a float; scale the volume to a smaller range");
        return values;
    });
}

}  // namespace dfield
