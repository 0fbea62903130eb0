// The layouts of many instances are those that the figures are stated for.
#include "bench/kinds/layouts.hpp"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace {

using namespace dfield;
using namespace dfield::kinds;

const Bounds kTall{{-1, 3, 2}, {0, 8, 4}}, kFlat{{0, 0, 0}, {10, 1, 10}};

float lowest(const Bounds& object, const glm::mat4& transform) {
    float result = 1e9f;
    for (int corner = 0; corner < 8; ++corner)
        result = std::min(result, (transform * glm::vec4(corner & 1 ? object.max.x : object.min.x,
                                                         corner & 2 ? object.max.y : object.min.y,
                                                         corner & 4 ? object.max.z : object.min.z, 1))
                                      .y);
    return result;
}

glm::vec3 placed_centre(const Bounds& object, const glm::mat4& transform) {
    return transform * glm::vec4(object.centre(), 1);
}

}  // namespace

TEST_CASE("A crowd's objects are rotated, of longest side 1, above the ground and apart") {
    const std::vector<Placement> placements = crowd(kTall, 100, 0);
    REQUIRE(placements.size() == 100);
    for (std::size_t i = 0; i < placements.size(); ++i) {
        const glm::mat3 linear(placements[i].transform);
        CHECK(glm::determinant(linear) == Approx(1 / 125.0f));
        CHECK(lowest(kTall, placements[i].transform) > 0);
        for (std::size_t j = 0; j < i; ++j) {
            CHECK(glm::distance(placed_centre(kTall, placements[i].transform),
                                placed_centre(kTall, placements[j].transform)) > 1);
            CHECK(glm::distance(linear[0], glm::mat3(placements[j].transform)[0]) > 1e-4f);
        }
    }
}

TEST_CASE("Layouts are functions of index and frame") {
    CHECK(crowd(kFlat, 20, 0)[7].transform == crowd(kFlat, 20, 0)[7].transform);
    CHECK(crowd(kFlat, 20, 0)[7].transform != crowd(kFlat, 20, 1)[7].transform);
    const Bounds objects[] = {kTall, kFlat};
    const std::vector<Placement> first = swarm(objects, 60, 0), again = swarm(objects, 60, 0),
                                 next = swarm(objects, 60, 1);
    for (std::size_t i = 0; i < first.size(); ++i) {
        CHECK(first[i].object == i % 2);
        CHECK(first[i].transform == again[i].transform);
        const Bounds& object = objects[first[i].object];
        const float step = glm::distance(placed_centre(object, first[i].transform),
                                         placed_centre(object, next[i].transform));
        CHECK(step > 0);
        CHECK(step < 0.1f);
        CHECK(lowest(object, first[i].transform) > 0);
    }
}

TEST_CASE("The ground reaches beyond all objects") {
    const cli::Receivers receivers = ground(100, 100000);
    CHECK(receivers.size() == Approx(100000).epsilon(0.01));
    for (const glm::vec3& normal : receivers.normals) REQUIRE(normal == glm::vec3(0, 1, 0));
    for (const Placement& placement : crowd(kTall, 100, 0)) {
        const glm::vec3 centre = placed_centre(kTall, placement.transform);
        CHECK(centre.x > receivers.positions.front().x + 1);
        CHECK(centre.x < receivers.positions.back().x - 1);
        CHECK(centre.z > receivers.positions.front().z + 1);
        CHECK(centre.z < receivers.positions.back().z - 1);
    }
}
