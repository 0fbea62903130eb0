#include "format/hemisphere_map.hpp"

#include <numbers>

namespace dfield {
namespace {

using std::numbers::pi;

glm::dvec2 texel_centre(std::uint32_t map_size, std::uint32_t s, std::uint32_t t) {
    return {(2.0 * s + 1) / map_size - 1, (2.0 * t + 1) / map_size - 1};
}

// Malley's method: a point of the unit disk lifted onto the hemisphere.
glm::vec3 lift(const glm::dvec2& disk) {
    const double squared = disk.x * disk.x + disk.y * disk.y;
    return {disk.x, disk.y, std::sqrt(std::max(0.0, 1 - squared))};
}

glm::dvec3 spherical(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

}  // namespace

glm::dvec2 concentric_disk(const glm::dvec2& square) {
    const auto [a, b] = std::pair(square.x, square.y);
    if (a == 0 && b == 0) return {0, 0};
    if (std::fabs(a) >= std::fabs(b)) {
        const double phi = pi / 4 * (b / a);
        return {a * std::cos(phi), a * std::sin(phi)};
    }
    const double phi = pi / 4 * (a / b);
    return {b * std::sin(phi), b * std::cos(phi)};
}

glm::vec3 texel_direction(Mapping mapping, std::uint32_t map_size, std::uint32_t s, std::uint32_t t) {
    const glm::dvec2 centre = texel_centre(map_size, s, t);
    switch (mapping) {
        case Mapping::kConcentric:
            return lift(concentric_disk(centre));
        case Mapping::kPolar:
            return spherical(pi / 2 * (t + 0.5) / map_size, 2 * pi * (s + 0.5) / map_size);
        default:
            if (centre.x * centre.x + centre.y * centre.y > 1) return {0, 0, -1};
            return lift(centre);
    }
}

std::vector<glm::vec3> map_directions(Mapping mapping, std::uint32_t map_size) {
    std::vector<glm::vec3> directions;
    directions.reserve(std::size_t{map_size} * map_size);
    for (std::uint32_t t = 0; t < map_size; ++t)
        for (std::uint32_t s = 0; s < map_size; ++s)
            directions.push_back(texel_direction(mapping, map_size, s, t));
    return directions;
}

std::vector<glm::vec3> cosine_directions(std::uint32_t count) {
    const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(count))));
    if (side * side == count) return map_directions(Mapping::kConcentric, side);
    std::vector<glm::vec3> directions;
    directions.reserve(count);
    const double golden = pi * (3 - std::sqrt(5.0));
    for (std::uint32_t i = 0; i < count; ++i) {
        const double radius = std::sqrt((i + 0.5) / count);
        directions.push_back(lift({radius * std::cos(golden * i), radius * std::sin(golden * i)}));
    }
    return directions;
}

std::vector<glm::vec3> fibonacci_sphere(std::uint32_t count) {
    std::vector<glm::vec3> directions;
    directions.reserve(count);
    const double golden = pi * (3 - std::sqrt(5.0));
    const std::uint32_t half = count / 2;
    for (std::uint32_t i = 0; i < count - half; ++i) {
        const double z = 1 - (2.0 * i + 1) / count, radius = std::sqrt(1 - z * z);
        directions.emplace_back(radius * std::cos(golden * i), radius * std::sin(golden * i), z);
    }
    for (std::uint32_t i = 0; i < half; ++i) directions.push_back(-directions[i]);
    return directions;
}

std::vector<glm::vec3> polar_directions(std::uint32_t count, std::vector<float>& weights) {
    const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(count))));
    weights.clear();
    for (std::uint32_t t = 0; t < side; ++t) {
        // Share of the cosine-weighted hemisphere in this band of theta: sin^2 between its borders.
        const double lower = std::sin(pi / 2 * t / side), upper = std::sin(pi / 2 * (t + 1) / side);
        weights.insert(weights.end(), side, static_cast<float>((upper * upper - lower * lower) / side));
    }
    return map_directions(Mapping::kPolar, side);
}

}  // namespace dfield
