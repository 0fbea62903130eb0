#include "format/frame.hpp"

#include <catch2/catch.hpp>

#include "tests/random.hpp"

using namespace dfield;

TEST_CASE("Frames are right-handed and orthonormal everywhere, poles and equator included") {
    dfield::test::Random random(7);
    std::vector<glm::vec3> normals{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {1, 0, -0.0f}};
    for (int i = 0; i < 100000; ++i) normals.emplace_back(random.direction());
    for (const glm::vec3& n : normals) {
        const Frame frame = frame_of_normal(n);
        const glm::dvec3 t(frame.tangent), b(frame.bitangent);
        REQUIRE(std::fabs(glm::length(t) - 1) < 1e-6);
        REQUIRE(std::fabs(glm::length(b) - 1) < 1e-6);
        REQUIRE(std::fabs(glm::dot(t, b)) < 1e-6);
        REQUIRE(glm::distance(glm::cross(t, b), glm::dvec3(n)) < 2e-6);
    }
}

TEST_CASE("The frame rule's fixed points, as FORMAT.md states them") {
    const Frame up = frame_of_normal({0, 0, 1}), down = frame_of_normal({0, 0, -1});
    CHECK(up.tangent == glm::vec3(1, 0, 0));
    CHECK(up.bitangent == glm::vec3(0, 1, 0));
    CHECK(down.tangent == glm::vec3(1, 0, 0));
    CHECK(down.bitangent == glm::vec3(0, -1, 0));
    // -0 counts as the upper half.
    CHECK(frame_of_normal({1, 0, -0.0f}).tangent == frame_of_normal({1, 0, 0}).tangent);
}

TEST_CASE("to_local undoes to_world") {
    dfield::test::Random random(8);
    for (int i = 0; i < 1000; ++i) {
        const Frame frame = frame_of_normal(glm::vec3(random.direction()));
        const glm::vec3 v = random.direction();
        CHECK(glm::distance(frame.to_local(frame.to_world(v)), v) < 1e-6f);
    }
}
