#include "bench/kinds/layouts.hpp"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>

namespace dfield::kinds {
namespace {

constexpr float kSpacing = 1.5f, kMargin = 1, kClearance = 0.1f, kOrbit = 0.4f;
constexpr float kFramesAround = 120;

// R2 sequence (Roberts 2018) and its relatives: even, and a function of the index alone.
float fraction(std::size_t index, double step) {
    const double value = step * static_cast<double>(index + 1);
    return static_cast<float>(value - std::floor(value));
}

std::size_t columns_of(std::size_t count) {
    return static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
}

glm::vec3 cell_middle(std::size_t index, std::size_t columns) {
    return kSpacing * glm::vec3(static_cast<float>(index % columns) + 0.5f, 0,
                                static_cast<float>(index / columns) + 0.5f);
}

// To longest side 1 around the origin.
glm::mat4 to_unit(const Bounds& object) {
    const glm::vec3 size = object.size();
    return glm::translate(glm::scale(glm::mat4(1), glm::vec3(1 / std::max({size.x, size.y, size.z}))),
                          -object.centre());
}

float lowest(const Bounds& object, const glm::mat4& transform) {
    float result = INFINITY;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 point(corner & 1 ? object.max.x : object.min.x,
                              corner & 2 ? object.max.y : object.min.y,
                              corner & 4 ? object.max.z : object.min.z);
        result = std::min(result, (transform * glm::vec4(point, 1)).y);
    }
    return result;
}

// Shoemake, "Uniform Random Rotations" (Graphics Gems III), of even instead of random numbers.
glm::quat turn(std::size_t index) {
    const float u = fraction(index, 0.8191725134), a = glm::two_pi<float>() * fraction(index, 0.6710436067),
                b = glm::two_pi<float>() * fraction(index, 0.5497004779);
    const float low = std::sqrt(1 - u), high = std::sqrt(u);
    return {high * std::cos(b), low * std::sin(a), low * std::cos(a), high * std::sin(b)};
}

glm::mat4 lifted(glm::mat4 transform, const Bounds& object, const glm::vec3& place, float height) {
    transform[3] += glm::vec4(place.x, height - lowest(object, transform), place.z, 0);
    return transform;
}

}  // namespace

std::vector<Placement> crowd(const Bounds& object, std::size_t count, std::uint32_t frame) {
    const std::size_t columns = columns_of(count);
    std::vector<Placement> result;
    for (std::size_t i = 0; i < count; ++i)
        result.push_back({0, lifted(glm::mat4_cast(turn(i + frame)) * to_unit(object), object,
                                    cell_middle(i, columns), kClearance)});
    return result;
}

std::vector<Placement> swarm(std::span<const Bounds> objects, std::size_t count, std::uint32_t frame) {
    const std::size_t columns = columns_of(count);
    std::vector<Placement> result;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t object = i % objects.size();
        const float size = 0.7f + 0.6f * fraction(i, 0.7548776662);
        const float direction = i % 3 == 0 ? -1.0f : 1.0f;
        const float angle = glm::two_pi<float>() * (fraction(i, 0.5698402910) +
                                                    direction * static_cast<float>(frame) / kFramesAround);
        const float height = kClearance + (i % 4 == 0 ? 0.5f * fraction(i, 0.8191725134) : 0);
        const glm::vec3 place =
            cell_middle(i, columns) + kOrbit * glm::vec3(std::cos(angle), 0, std::sin(angle));
        const glm::mat4 turned = glm::rotate(glm::mat4(1), -angle, glm::vec3(0, 1, 0));
        result.push_back({object, lifted(glm::scale(turned, glm::vec3(size)) * to_unit(objects[object]),
                                         objects[object], place, height)});
    }
    return result;
}

cli::Receivers ground(std::size_t instances, std::size_t count) {
    const std::size_t columns = columns_of(instances), rows = (instances + columns - 1) / columns;
    const float width = kSpacing * static_cast<float>(columns) + 2 * kMargin,
                depth = kSpacing * static_cast<float>(rows) + 2 * kMargin;
    const auto across =
        static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(count) * width / depth)));
    const std::size_t along = (count + across / 2) / across;
    cli::Receivers receivers;
    for (std::size_t z = 0; z < along; ++z)
        for (std::size_t x = 0; x < across; ++x) {
            const float u = static_cast<float>(x) / static_cast<float>(across - 1),
                        v = static_cast<float>(z) / static_cast<float>(along - 1);
            receivers.positions.emplace_back(u * width - kMargin, 0, v * depth - kMargin);
            receivers.normals.emplace_back(0, 1, 0);
        }
    return receivers;
}

}  // namespace dfield::kinds
