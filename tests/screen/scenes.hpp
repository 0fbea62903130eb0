// Small pictures that the tests of screen space share.
#pragma once

#include <string>

#include "tests/random.hpp"
#include "tests/screen/pictures.hpp"

namespace dfield::test {

inline World open_plane() {
    return plane({0.3, 0.8, 1}, -3);
}
inline World corner() {
    return nearest({plane({0, 1, 0}, -1, {0.8, 0.8, 0.8}), plane({0, 0, 1}, -4, {0.9, 0.2, 0.1}),
                    plane({1, 0, 0.3}, -1.8, {0.1, 0.8, 0.2})});
}
// A box's edge before a wall.
inline World step() {
    return [](const glm::dvec3& origin, const glm::dvec3& direction) {
        const Met wall = plane({0, 0, 1}, -4)(origin, direction),
                  front = plane({0, 0, 1}, -3.4)(origin, direction);
        return origin.x + front.t * direction.x > 0.1 ? front : wall;
    };
}
inline World ball() {
    return nearest({plane({0, 1, 0.2}, -1.6), sphere({0.1, -0.6, -3.4}, 0.8, {0.2, 0.3, 0.9})});
}
inline World room() {
    return nearest({corner(), sphere({0.2, -0.4, -3}, 0.5, {0.2, 0.3, 0.9}),
                    sphere({0.9, -0.75, -2.4}, 0.25, {0.9, 0.9, 0.2})});
}

// Waves, with some noise from pixel to pixel: depths that no surface has.
inline Picture height_field(std::uint32_t width, std::uint32_t height, const dfield_screen_camera& camera,
                            std::uint64_t seed) {
    Random random(seed);
    Picture picture = take(plane({0, 0, 1}, -3), width, height, camera);
    const double a = random.uniform(0.1, 0.4), b = random.uniform(0.1, 0.4), c = random.uniform(0, 6);
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const double x = static_cast<double>(i % width), y = static_cast<double>(i / width);
        picture.depth[i] = static_cast<float>(3 + 0.25 * std::sin(a * x + c) * std::cos(b * y) +
                                              0.03 * random.uniform(-1, 1));
        const glm::dvec3 n = glm::normalize(random.direction() * 0.4 + glm::dvec3(0, 0, 1));
        for (std::size_t k = 0; k < 3; ++k) {
            picture.normals[3 * i + k] = static_cast<float>(n[static_cast<int>(k)]);
            picture.radiance[3 * i + k] = static_cast<float>(random.uniform(0, 1));
        }
    }
    return picture;
}

inline dfield_screen_desc desc_of(std::uint32_t estimator, float radius) {
    dfield_screen_desc desc = screen_defaults();
    desc.estimator = estimator;
    desc.radius = radius;
    return desc;
}
// One set of samples, no filter.
inline dfield_screen_desc plain_desc(std::uint32_t estimator, float radius, std::uint32_t samples) {
    dfield_screen_desc desc = desc_of(estimator, radius);
    desc.samples = samples;
    desc.interleave = 1;
    return desc;
}

}  // namespace dfield::test
