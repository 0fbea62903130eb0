// Occlusion volumes: how much of each octant of the sky an object leaves open, at the samples of a grid
// around it, and beyond the grid the ball that stands for the object in each direction. FORMAT.md, "VOLU", is
// normative.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <string>
#include <vector>

namespace dfield {

inline constexpr std::uint32_t kMinVolumeSize = 4, kMaxVolumeSize = 256;  // samples along an axis
inline constexpr std::uint32_t kMinFarSize = 3, kMaxFarSize = 33;         // odd
inline constexpr std::uint64_t kMaxVolumeBytes = std::uint64_t{1} << 27;  // in memory

// Octant i has the directions whose x is positive where bit 0 of i is set and negative otherwise, likewise y
// and bit 1, z and bit 2; object space.
inline constexpr std::size_t kVolumeOctants = 8;

// The object as it is seen from afar, a ball: radius, and its middle relative to the bounding sphere's
// centre. Bytes: round(255 r / R), and round(127 x / R) + 128 an axis, R being the bounding sphere's radius.
struct FarBall {
    std::uint8_t radius, x, y, z;
};
constexpr std::uint32_t pack_far_ball(const FarBall& ball) {
    return ball.radius | ball.x << 8 | ball.y << 16 | std::uint32_t{ball.z} << 24;
}
constexpr FarBall unpack_far_ball(std::uint32_t word) {
    const auto byte = [word](int shift) { return static_cast<std::uint8_t>(word >> shift); };
    return {byte(0), byte(8), byte(16), byte(24)};
}

struct OcclusionVolume {
    explicit OcclusionVolume(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
        : octants(memory), far(memory) {}

    std::array<std::uint32_t, 3> dims{};  // kMinVolumeSize..kMaxVolumeSize each
    glm::vec3 origin{0};                  // of sample (0, 0, 0), object space
    float spacing = 0;                    // between samples, on all axes, object space
    float blend = 0;  // how far within the grid's border what is beyond it begins to count, object space
    std::uint32_t far_size = 0;  // nodes along an edge of the map of balls

    // Two words a sample, x fastest: byte i % 4 (0 the lowest) of word i / 4 is what octant i leaves open,
    // 255 all.
    std::pmr::vector<std::uint32_t> octants;
    // far_size^2 nodes of an octahedral map, rows (t) of far_size nodes (s), node (s, t) for the direction
    // far_direction() from the bounding sphere's centre to the receiver.
    std::pmr::vector<std::uint32_t> far;

    std::uint64_t samples() const { return std::uint64_t{dims[0]} * dims[1] * dims[2]; }
    std::uint64_t memory_bytes() const { return 4 * (octants.size() + far.size()); }
    std::uint8_t octant(std::size_t sample, std::size_t i) const {
        return static_cast<std::uint8_t>(octants[2 * sample + i / 4] >> 8 * (i % 4));
    }
    void set_octant(std::size_t sample, std::size_t i, std::uint8_t value) {
        std::uint32_t& word = octants[2 * sample + i / 4];
        word = (word & ~(0xffu << 8 * (i % 4))) | std::uint32_t{value} << 8 * (i % 4);
    }
};

// The direction of node (s, t). Nodes on the map's rim that stand for one direction have the same ball.
glm::vec3 far_direction(std::uint32_t far_size, std::uint32_t s, std::uint32_t t);

// Empty when dimensions and sizes are within the format's limits, otherwise what is wrong and what is
// allowed.
std::string volume_dims_error(const std::array<std::uint32_t, 3>& dims, std::uint32_t far_size);

}  // namespace dfield
