// Voxel grids, the samples on them, and the sweeps through them: what all of the volume backend shares.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace dfield::runtime::volume {

// Voxel (x, y, z) lies at the point (x hx, y hy, z hz), world units; arrays hold x fastest, then y, then z.
struct Grid {
    std::size_t nx = 0, ny = 0, nz = 0;
    float hx = 1, hy = 1, hz = 1;

    std::size_t size() const { return nx * ny * nz; }
    std::size_t index(std::size_t x, std::size_t y, std::size_t z) const { return x + nx * (y + ny * z); }
    bool isotropic() const { return hx == hy && hy == hz; }
    // The h of equations 7 and of the normal's offset: the smallest spacing, below which no unfrozen vertex's
    // distance can fall by more than 1/sqrt(3), so that equation 7 reads initialised distances only.
    float h() const { return hx < hy ? (hx < hz ? hx : hz) : (hy < hz ? hy : hz); }
};

enum class SampleType : std::uint32_t { kU8, kI8, kU16, kI16, kF32 };

// The caller's voxels. Rows along x are packed; the strides lead to the next row and slice, in bytes.
struct Samples {
    const void* data = nullptr;
    SampleType type = SampleType::kF32;
    std::size_t row_stride = 0, slice_stride = 0;
    float isovalue = 0;

    const std::byte* row(std::size_t y, std::size_t z) const {
        return static_cast<const std::byte*>(data) + y * row_stride + z * slice_stride;
    }
    template<class Type>
    static float at(const std::byte* row, std::size_t x) {
        Type value;
        std::memcpy(&value, row + x * sizeof(Type), sizeof value);
        return static_cast<float>(value);
    }
    // Above the isovalue by this much; inside where >= 0.
    float above(std::size_t x, std::size_t y, std::size_t z) const {
        const std::byte* const r = row(y, z);
        switch (type) {
            case SampleType::kU8:
                return at<std::uint8_t>(r, x) - isovalue;
            case SampleType::kI8:
                return at<std::int8_t>(r, x) - isovalue;
            case SampleType::kU16:
                return at<std::uint16_t>(r, x) - isovalue;
            case SampleType::kI16:
                return at<std::int16_t>(r, x) - isovalue;
            default:
                return at<float>(r, x) - isovalue;
        }
    }
};

// The paper's Table 1: sweep s = index + 1 goes in this direction. Its neighbours lie on the opposite side,
// and so does the octant of the sky, octant `index`, whose visibility it computes.
struct Sweep {
    int x, y, z;
};
constexpr std::size_t kOctants = 8;
constexpr std::array<Sweep, kOctants> kSweeps{
    {{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {-1, -1, 1}, {1, 1, -1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, -1}}};
// The order in which the distance field is swept: all that go up in z, then all that go down, opposite
// diagonals of a slice one after the other.
constexpr std::array<std::size_t, kOctants> kSweepOrder{0, 3, 2, 1, 4, 7, 6, 5};

// Distances are never this large: "not reached yet", and in the end "there is no surface".
constexpr float kFar = 1e30f;

}  // namespace dfield::runtime::volume
