// Sample sets out of indices: Sobol points, shifted by a seed, of which each of the interleaved sets has a
// block of n consecutive ones. With n a power of two a block is well spread by itself, and so are all of them
// together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory_resource>
#include <vector>

namespace dfield::runtime::screen {

// Point `index` of the sequence, each coordinate in (0, 1).
std::array<float, 3> sobol_point(std::uint32_t index, std::uint64_t seed);

// Uniform in the unit disk, keeping neighbours (Shirley and Chiu's concentric map), and in the unit ball.
glm::vec2 concentric_disk(float u, float v);
glm::vec3 uniform_ball(const std::array<float, 3>& point);

// Which block of the sequence the pixels at (x, y) of a square of `side` use: squares of 2 x 2, 4 x 4, ...
// have consecutive blocks.
std::uint32_t block_of(std::uint32_t x, std::uint32_t y, std::uint32_t side);

// `count` values a set, the sets of a square's pixels row by row.
template<class Sample>
struct SampleSets {
    template<class Make>
    SampleSets(std::pmr::memory_resource* memory, std::uint32_t side, std::uint32_t count, const Make& make)
        : side(side), count(count), samples(memory) {
        samples.reserve(std::size_t{side} * side * count);
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x)
                for (std::uint32_t k = 0; k < count; ++k)
                    samples.push_back(make(block_of(x, y, side) * count + k));
    }
    const Sample* at(std::uint32_t column, std::uint32_t row) const {
        return samples.data() + std::size_t{row % side * side + column % side} * count;
    }

    std::uint32_t side, count;
    std::pmr::vector<Sample> samples;
};

}  // namespace dfield::runtime::screen
