// Distances and hits of rays against closed forms.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/random.hpp"
#include "tests/runtime/baked.hpp"
#include "tests/shapes.hpp"

using namespace dfield;
using test::kIdentity;
using test::Random;

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

struct RayBatch {
    std::vector<glm::vec3> origins, directions;
    std::vector<float> limits;

    dfield_rays view() const {
        dfield_rays rays{};
        rays.count = origins.size();
        rays.origins = &origins.front().x;
        rays.directions = &directions.front().x;
        rays.max_distances = limits.empty() ? nullptr : limits.data();
        return rays;
    }
};

std::vector<float> traced(const Scene& scene, const RayBatch& batch,
                          std::vector<dfield_instance>* instances = nullptr) {
    std::vector<float> distances(batch.origins.size());
    if (instances) instances->resize(batch.origins.size());
    scene.trace(batch.view(), {distances.data(), 0, instances ? instances->data() : nullptr, 0});
    return distances;
}

std::vector<std::uint8_t> blocked(const Scene& scene, const RayBatch& batch) {
    std::vector<std::uint8_t> result(batch.origins.size());
    scene.occluded(batch.view(), result.data());
    return result;
}

// First hit of o + t d with the sphere, or with its far side from inside; infinity for none ahead.
double sphere_distance(const glm::dvec3& centre, double radius, const glm::dvec3& o, const glm::dvec3& d) {
    const glm::dvec3 v = o - centre;
    const double a = glm::dot(d, d), b = glm::dot(v, d), c = glm::dot(v, v) - radius * radius,
                 disc = b * b - a * c;
    if (disc < 0) return kInf;
    const double near = (-b - std::sqrt(disc)) / a, far = (-b + std::sqrt(disc)) / a;
    return near >= 0 ? near : far >= 0 ? far : kInf;
}

// A ball in the corner of its bounding sphere: a second, far ball makes the sphere large, so that there is
// room inside.
TriangleMesh two_balls() {
    TriangleMesh mesh = test::sphere_mesh({-1, 0, 0}, 0.5f);
    test::append(mesh, test::sphere_mesh({1, 0.3f, 0}, 0.4f));
    return mesh;
}

double two_balls_distance(const glm::dvec3& o, const glm::dvec3& d) {
    return std::min(sphere_distance({-1, 0, 0}, 0.5, o, d), sphere_distance({1, 0.3, 0}, 0.4, o, d));
}

}  // namespace

TEST_CASE("First hits from outside agree with two spheres' closed form, in every mapping, layout and depth") {
    const Context context;
    Random random(21);
    RayBatch batch;
    for (int i = 0; i < 20000; ++i) {
        batch.origins.emplace_back(random.direction() * random.uniform(2.5, 20));
        const glm::dvec3 target = random.direction() * random.uniform(0, 1.5);
        batch.directions.emplace_back((target - glm::dvec3(batch.origins.back())) * random.uniform(0.1, 3));
    }
    struct Case {
        std::uint32_t bits;
        Mapping mapping;
        Positions positions;
    };
    for (const Case c :
         {Case{8, Mapping::kConcentric, Positions::kSlater}, Case{16, Mapping::kPolar, Positions::kSlater},
          Case{32, Mapping::kRejection, Positions::kSlater},
          Case{8, Mapping::kConcentric, Positions::kLatlong}}) {
        const Field field = test::baked(context, two_balls(), 32, 48, c.bits, c.mapping, c.positions);
        Scene scene(context);
        scene.add(field, kIdentity);
        std::vector<dfield_instance> instances;
        const auto distances = traced(scene, batch, &instances);
        const auto occluded = blocked(scene, batch);
        std::size_t disagree = 0, both = 0;
        double squares = 0;
        for (std::size_t i = 0; i < distances.size(); ++i) {
            const double exact =
                two_balls_distance(glm::dvec3(batch.origins[i]), glm::dvec3(batch.directions[i]));
            const bool hit = distances[i] < kInf;
            REQUIRE(occluded[i] == hit);
            REQUIRE((instances[i] == (hit ? 0 : DFIELD_NO_INSTANCE)));
            if (hit != (exact < kInf)) {
                ++disagree;
            } else if (hit) {
                ++both;
                const double error = (distances[i] - exact) * glm::length(glm::dvec3(batch.directions[i]));
                squares += error * error;
            }
        }
        INFO("bits " << c.bits << " mapping " << static_cast<int>(c.mapping));
        CHECK(both > 3000);
        CHECK(disagree < 0.02 * distances.size());
        CHECK(std::sqrt(squares / both) < 0.15);  // radius 1.5; silhouettes dominate
    }
}

TEST_CASE("From inside the bounding sphere: hits ahead are found, hits behind are not") {
    const Context context;
    const Field field = test::baked(context, two_balls(), 32, 48, 16);
    Scene scene(context);
    scene.add(field, kIdentity);
    Random random(22);
    RayBatch batch;
    while (batch.origins.size() < 20000) {
        const glm::dvec3 o(random.uniform(-0.4, 0.5), random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8));
        batch.origins.emplace_back(o);
        batch.directions.emplace_back(random.direction());
    }
    const auto distances = traced(scene, batch);
    const auto occluded = blocked(scene, batch);
    std::size_t disagree = 0, trace_disagree = 0, too_short = 0, hits = 0;
    for (std::size_t i = 0; i < distances.size(); ++i) {
        const double exact =
            two_balls_distance(glm::dvec3(batch.origins[i]), glm::dvec3(batch.directions[i]));
        hits += exact < kInf;
        disagree += (occluded[i] != 0) != (exact < kInf);
        trace_disagree += (distances[i] < kInf) != (exact < kInf);
        // An upper bound of the distance: where the line's first hit lies behind, the last one ahead is
        // reported.
        too_short += distances[i] < exact - 0.25;
    }
    CHECK(hits > 1500);
    CHECK(disagree < 0.02 * distances.size());
    CHECK(trace_disagree < 0.02 * distances.size());
    CHECK(too_short < 0.01 * distances.size());
}

TEST_CASE("Maximum distances bound hits, per ray") {
    const Context context;
    const Field field = test::baked(context, test::box_mesh({-1, -1, -1}, {1, 1, 1}), 32, 32, 16);
    Scene scene(context);
    scene.add(field, kIdentity);
    RayBatch batch;
    batch.origins.assign(4, {0, 0, -5});
    batch.directions = {{0, 0, 1}, {0, 0, 1}, {0, 0, 2}, {0, 0, 2}};
    batch.limits = {3.8f, 4.2f, 1.8f, 2.2f};  // the face is 4 away; t counts in lengths of the direction
    const auto distances = traced(scene, batch);
    CHECK(distances[0] == kInf);
    CHECK(distances[1] == Approx(4).margin(0.05));
    CHECK(distances[2] == kInf);
    CHECK(distances[3] == Approx(2).margin(0.03));
    CHECK(blocked(scene, batch) == std::vector<std::uint8_t>{0, 1, 0, 1});
}

TEST_CASE("The nearest of several instances and the ground answers") {
    const Context context;
    const Field field = test::baked(context, test::box_mesh({-1, -1, -1}, {1, 1, 1}), 32, 32, 16);
    Scene scene(context);
    float moved[16];
    std::copy(kIdentity, kIdentity + 16, moved);
    const auto near = scene.add(field, kIdentity);
    moved[14] = 6;
    const auto far = scene.add(field, moved);
    const float ground[4] = {0, 0, 2, -20};  // z = -10, normal not unit
    scene.set_ground(ground);
    RayBatch batch;
    batch.origins = {{0, 0, -5}, {0, 0, 12}, {0, 0, 3}, {8, 0, 0}, {8, 0, 0}, {0, 0, 3}};
    batch.directions = {{0, 0, 1}, {0, 0, -1}, {0, 0, 1}, {0, 0, -1}, {0, 0, 1}, {0, 0, -1}};
    std::vector<dfield_instance> instances;
    const auto distances = traced(scene, batch, &instances);
    CHECK(instances ==
          std::vector<dfield_instance>{near, far, far, DFIELD_NO_INSTANCE, DFIELD_NO_INSTANCE, near});
    CHECK(distances[0] == Approx(4).margin(0.05));
    CHECK(distances[1] == Approx(5).margin(0.05));
    CHECK(distances[2] == Approx(2).margin(0.05));
    CHECK(distances[3] == Approx(10));
    CHECK(distances[4] == kInf);
    CHECK(distances[5] == Approx(2).margin(0.05));
    scene.set_ground(nullptr);
    CHECK(traced(scene, batch)[3] == kInf);
}

TEST_CASE("Strides and splitting a batch do not change the answers") {
    struct Vertex {
        glm::vec3 position;
        float padding[3];
        glm::vec3 direction;
    };
    const Context context;
    const Field field = test::baked(context, two_balls(), 16, 16, 8);
    Scene scene(context);
    scene.add(field, kIdentity);
    Random random(23);
    std::vector<Vertex> vertices(1000);
    RayBatch packed;
    for (Vertex& v : vertices) {
        v.position = random.direction() * 3.0;
        v.direction = -v.position + glm::vec3(random.direction());
        packed.origins.push_back(v.position);
        packed.directions.push_back(v.direction);
    }
    const auto expected = traced(scene, packed);
    dfield_rays rays{};
    rays.origins = &vertices.front().position.x;
    rays.directions = &vertices.front().direction.x;
    rays.origin_stride = rays.direction_stride = sizeof(Vertex);
    std::vector<float> spread(4 * vertices.size(), -1);
    for (std::size_t begin = 0; begin < vertices.size(); begin += 77) {
        dfield_rays part = rays;
        part.count = std::min<std::size_t>(77, vertices.size() - begin);
        part.origins = &vertices[begin].position.x;
        part.directions = &vertices[begin].direction.x;
        scene.trace(part, {&spread[4 * begin], 4 * sizeof(float), nullptr, 0});
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        REQUIRE(spread[4 * i] == expected[i]);
        REQUIRE(spread[4 * i + 1] == -1);
    }
}

TEST_CASE("Far origins keep their accuracy") {
    const Context context;
    const Field field = test::baked(context, test::sphere_mesh({0, 0, 0}, 1), 32, 32, 16);
    Scene scene(context);
    scene.add(field, kIdentity);
    RayBatch batch;
    for (const float distance : {10.0f, 1e3f, 1e5f}) {
        batch.origins.push_back(glm::vec3(0, 0.6f, -distance));
        batch.directions.push_back({0, 0, 1});
        batch.origins.push_back(glm::vec3(0, 1.01f, -distance));
        batch.directions.push_back({0, 0, 1});
    }
    const auto distances = traced(scene, batch);
    for (int i = 0; i < 3; ++i) {
        CHECK(distances[2 * i] == Approx(-batch.origins[2 * i].z - 0.8f).margin(0.05));
        CHECK(distances[2 * i + 1] == kInf);
    }
}
