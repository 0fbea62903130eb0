// A volume in memory: one scalar a voxel on a regular grid that lies anywhere in the world.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace dfield {

enum class VoxelType { kI8, kU8, kI16, kU16, kI32, kU32, kF32, kF64 };

inline constexpr std::array kVoxelTypes{VoxelType::kI8,  VoxelType::kU8,  VoxelType::kI16, VoxelType::kU16,
                                        VoxelType::kI32, VoxelType::kU32, VoxelType::kF32, VoxelType::kF64};

std::size_t size_of(VoxelType type);                       // bytes of a voxel
const char* name_of(VoxelType type);                       // "u8", "f32", ...
bool is_floating(VoxelType type);                          // f32, f64
std::string size_text(std::span<const std::size_t> size);  // "256 x 256 x 128"

// Where the voxels lie. A voxel is a sample at a point; its cell plays no part.
struct VolumeGrid {
    std::array<std::size_t, 3> size{1, 1, 1};  // voxels along x (fastest in memory), y and z
    glm::dvec3 origin{0};                      // world position of the first voxel
    glm::dmat3 directions{1};  // columns: the step in world units from a voxel to the next along x, y, z

    // What the origin and the directions are told in, by NRRD's names, such as "left-posterior-superior";
    // kUnnamedSpace for a world without a name; empty where the file told no more than a spacing along the
    // axes.
    std::string space;
    std::string unit;  // of length, such as "mm"; empty where the file did not say

    std::size_t voxels() const { return size[0] * size[1] * size[2]; }
    glm::dvec3 spacing() const;  // lengths of the directions
    bool right_handed() const;   // false where the directions mirror the grid
    bool axis_aligned() const;   // directions along +x, +y, +z of the world
    glm::dvec3 position(const glm::dvec3& index) const { return origin + directions * index; }
};

inline constexpr const char* kUnnamedSpace = "3D";

struct Volume {
    VolumeGrid grid;
    VoxelType type = VoxelType::kU8;
    std::vector<std::byte> data;  // grid.voxels() * size_of(type) bytes, in this machine's byte order

    // The voxels as what they are. T is the C++ type that `type` stands for.
    template<class T>
    std::span<const T> voxels() const {
        return {reinterpret_cast<const T*>(data.data()), data.size() / sizeof(T)};
    }
    template<class T>
    std::span<T> voxels() {
        return {reinterpret_cast<T*>(data.data()), data.size() / sizeof(T)};
    }
};

// Calls visit(T{}) with the C++ type that `type` stands for.
template<class Visit>
decltype(auto) visit_type(VoxelType type, Visit&& visit) {
    switch (type) {
        case VoxelType::kI8:
            return visit(std::int8_t{});
        case VoxelType::kU8:
            return visit(std::uint8_t{});
        case VoxelType::kI16:
            return visit(std::int16_t{});
        case VoxelType::kU16:
            return visit(std::uint16_t{});
        case VoxelType::kI32:
            return visit(std::int32_t{});
        case VoxelType::kU32:
            return visit(std::uint32_t{});
        case VoxelType::kF32:
            return visit(float{});
        case VoxelType::kF64:
            break;
    }
    return visit(double{});
}

struct ValueRange {
    double min = 0, max = 0;
};

// Smallest and largest voxel. The voxels are finite, as those of every volume that was read are.
ValueRange value_range(const Volume& volume);

// The voxels as floats, rounded to nearest: i32, u32 and f64 may lose digits. InputError where an f64 is
// beyond float's range.
std::vector<float> float_values(const Volume& volume);

}  // namespace dfield
