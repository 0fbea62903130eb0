#include "screen/samples.hpp"

#include <cmath>
#include <numbers>

#include "volume/random.hpp"

namespace dfield::runtime::screen {
namespace {

using Directions = std::array<std::uint32_t, 32>;

// Direction numbers of a primitive polynomial over GF(2) of degree `degree` with the inner coefficients
// `inner`, from its first ones (S. Joe, F. Kuo).
constexpr Directions sobol_directions(unsigned degree, std::uint32_t inner,
                                      std::array<std::uint32_t, 2> first) {
    Directions v{};
    for (unsigned i = 0; i < 32; ++i) {
        if (i < degree) {
            v[i] = first[i] << (31 - i);
            continue;
        }
        v[i] = v[i - degree] ^ (v[i - degree] >> degree);
        for (unsigned k = 1; k < degree; ++k)
            if (inner >> (degree - 1 - k) & 1) v[i] ^= v[i - k];
    }
    return v;
}

constexpr Directions van_der_corput() {
    Directions v{};
    for (unsigned i = 0; i < 32; ++i) v[i] = 1u << (31 - i);
    return v;
}

constexpr Directions kDirections[3] = {van_der_corput(), sobol_directions(1, 0, {1, 0}),
                                       sobol_directions(2, 1, {1, 3})};

}  // namespace

std::array<float, 3> sobol_point(std::uint32_t index, std::uint64_t seed) {
    std::array<float, 3> point{};
    for (unsigned axis = 0; axis < 3; ++axis) {
        std::uint32_t bits = static_cast<std::uint32_t>(volume::mixed(3 * seed + axis) >> 32);
        for (unsigned i = 0; index >> i != 0; ++i)
            if (index >> i & 1) bits ^= kDirections[axis][i];
        point[axis] = (static_cast<float>(bits >> 9) + 0.5f) * 0x1p-23f;
    }
    return point;
}

glm::vec2 concentric_disk(float u, float v) {
    constexpr float kQuarter = std::numbers::pi_v<float> / 4;
    const float a = 2 * u - 1, b = 2 * v - 1;
    if (std::abs(a) > std::abs(b)) {
        const float phi = kQuarter * (b / a);
        return {a * std::cos(phi), a * std::sin(phi)};
    }
    const float phi = kQuarter * (a / b);  // b is not 0: coordinates are odd multiples of 2^-24
    return {b * std::sin(phi), b * std::cos(phi)};
}

glm::vec3 uniform_ball(const std::array<float, 3>& point) {
    const float z = 2 * point[2] - 1;
    const glm::vec2 disk = concentric_disk(point[0], point[1]);
    const float rho2 = disk.x * disk.x + disk.y * disk.y;
    // The disk's points, with their squared radius as the height, cover a sphere uniformly.
    const float height = 1 - 2 * rho2, across = 2 * std::sqrt(std::max(0.0f, 1 - rho2));
    const float radius = std::cbrt(0.5f * (z + 1));
    return radius * glm::vec3(across * disk.x, across * disk.y, height);
}

std::uint32_t block_of(std::uint32_t x, std::uint32_t y, std::uint32_t side) {
    if ((side & (side - 1)) != 0) return y * side + x;
    std::uint32_t block = 0;
    for (unsigned bit = 0; side >> (bit + 1) != 0; ++bit)
        block |= (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1);
    return block;
}

}  // namespace dfield::runtime::screen
