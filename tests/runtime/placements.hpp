// Random places of instances and receivers, for tests.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <vector>

#include "dfield/dfield.hpp"
#include "tests/random.hpp"

namespace dfield::test {

// Rotated, scaled (sometimes unevenly or mirrored), somewhere in the box.
inline glm::mat4 random_placement(Random& random, const glm::dvec3& low, const glm::dvec3& high) {
    const double size = random.uniform(0.3, 1.2);
    glm::dvec3 scale(size);
    if (random.below(3) == 0) scale *= glm::dvec3(random.uniform(0.5, 2), random.uniform(0.5, 2), 1);
    if (random.below(4) == 0) scale.x = -scale.x;
    glm::dmat4 m(1);
    const glm::dmat3 linear = random.rotation() * glm::dmat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z);
    for (int i = 0; i < 3; ++i) m[i] = glm::dvec4(linear[i], 0);
    for (int axis = 0; axis < 3; ++axis) m[3][axis] = random.uniform(low[axis], high[axis]);
    return m;
}

struct ReceiverList {
    std::vector<glm::vec3> positions, normals;
    std::vector<dfield_instance> owners, attached;
    std::vector<float> self;

    std::size_t size() const { return positions.size(); }
    dfield_receivers view() const {
        dfield_receivers view{};
        view.count = size();
        view.positions = &positions.front().x;
        view.normals = &normals.front().x;
        view.owners = owners.empty() ? nullptr : owners.data();
        view.self_visibility = self.empty() ? nullptr : self.data();
        return view;
    }
};

}  // namespace dfield::test
