// Occlusion volumes from mesh to visibility: closed forms, Embree as judge, transforms, open meshes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "baker/mesh_distance.hpp"
#include "baker/ray_visibility.hpp"
#include "format/hemisphere_map.hpp"
#include "tests/runtime/baked_volume.hpp"
#include "tests/shapes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

const glm::mat4 kPlace(1);

struct Error {
    double rms = 0, max = 0;
};
template<class Values>
Error error_of(const std::vector<float>& visibility, const Values& expected) {
    Error error;
    for (std::size_t i = 0; i < visibility.size(); ++i) {
        const double e = static_cast<double>(visibility[i]) - static_cast<double>(expected[i]);
        error.rms += e * e;
        error.max = std::max(error.max, std::fabs(e));
    }
    error.rms = std::sqrt(error.rms / static_cast<double>(visibility.size()));
    return error;
}

// The plane z = height, facing up, out to `reach` from the z axis.
ReceiverList plane(float height, float reach, std::size_t across = 41) {
    ReceiverList list;
    for (std::size_t j = 0; j < across; ++j)
        for (std::size_t i = 0; i < across; ++i) {
            const auto place = [&](std::size_t k) {
                return reach * (2 * static_cast<float>(k) / static_cast<float>(across - 1) - 1);
            };
            list.positions.emplace_back(place(i), place(j), height);
            list.normals.emplace_back(0, 0, 1);
        }
    return list;
}

// At random, between `nearest` and `farthest` from the middle, looking anywhere.
ReceiverList around(double nearest, double farthest, std::size_t count, std::uint64_t seed) {
    ReceiverList list;
    Random random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        list.positions.emplace_back(random.direction() * random.uniform(nearest, farthest));
        list.normals.emplace_back(random.direction());
    }
    return list;
}

std::vector<float> ray_cast(const TriangleMesh& mesh, const glm::mat4& transform,
                            const ReceiverList& receivers) {
    EmbreeScene scene(EmbreeUse::kFast);
    scene.add_mesh(mesh, transform);
    scene.commit();
    const std::vector<glm::vec3> directions = cosine_directions(1024);
    RayVisibilityOptions options;
    options.directions = directions;
    return ray_visibility(scene, receivers.positions, receivers.normals, options);
}

ReceiverList carried(const ReceiverList& list, const glm::mat4& transform) {
    ReceiverList result;
    const glm::mat3 normals = glm::inverse(glm::transpose(glm::mat3(transform)));
    for (std::size_t i = 0; i < list.size(); ++i) {
        result.positions.emplace_back(transform * glm::vec4(list.positions[i], 1));
        result.normals.push_back(glm::normalize(normals * list.normals[i]));
    }
    return result;
}

glm::mat4 placed(const glm::dmat3& linear, const glm::dvec3& translation) {
    glm::mat4 m{glm::mat3(linear)};
    m[3] = glm::vec4(glm::vec3(translation), 1);
    return m;
}

TriangleMesh clutter() {
    TriangleMesh mesh = sphere_mesh({-0.6f, 0, 0.1f}, 0.5f, 24);
    append(mesh, box_mesh({0, -0.3f, -0.6f}, {1, 0.5f, 0.4f}));
    return mesh;
}

// A flat square, or half of a hollow sphere that opens upwards.
TriangleMesh sheet() {
    TriangleMesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}
TriangleMesh bowl() {
    TriangleMesh mesh = sphere_mesh(glm::vec3(0), 1, 32);
    std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
        return mesh.positions[t.x].z + mesh.positions[t.y].z + mesh.positions[t.z].z > 0;
    });
    return mesh;
}

void report(const char* what, const Error& error) {
    std::printf("  %-32s RMS %.2f, at most %.1f grey\n", what, 255 * error.rms, 255 * error.max);
    std::fflush(stdout);
}

}  // namespace

TEST_CASE("A sphere over a plane hides what its form factor says") {
    // A ball of radius r, its middle d away at an angle whose cosine is c: r^2 c / d^2 where it is all above.
    const Context context;
    const Field field = baked_volume(context, sphere_mesh(glm::vec3(0), 1, 48), 48);
    for (const float height : {-1.1f, -1.5f, -3.0f}) {
        const ReceiverList list = plane(height, 5);
        std::vector<float> exact;
        for (const glm::vec3& p : list.positions) {
            const float d = glm::length(p);
            exact.push_back(1 - (-height / d) / (d * d));
        }
        const Error error = error_of(visibility_past(context, field, kPlace, list), exact);
        report(("plane at " + std::to_string(height)).c_str(), error);
        CHECK(255 * error.rms < 2);
        CHECK(255 * error.max < 16);
    }
}

TEST_CASE("Far away the object is as large as its silhouette") {
    // Occlusion times the square of the distance tends to area times cosine over pi.
    const Context context;
    const TriangleMesh box = box_mesh({-1, -0.5f, -0.25f}, {1, 0.5f, 0.25f});
    const Field field = baked_volume(context, box);
    Random random(4);
    for (const double distance : {30.0, 300.0})
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 d = random.direction();
            ReceiverList list;
            list.positions.emplace_back(d * distance);
            list.normals.emplace_back(-d);
            const glm::dvec3 size = glm::abs(d);
            const double area = 4 * (size.x * 0.5 * 0.25 + size.y * 1 * 0.25 + size.z * 1 * 0.5);
            const double hidden = 1 - visibility_past(context, field, kPlace, list)[0];
            // Between the map's directions, and float's last bits of 1 - occlusion.
            REQUIRE(hidden * distance * distance * 3.14159265 ==
                    Approx(area).epsilon(0.2).margin(2e-7 * distance * distance));
            list.normals[0] = glm::vec3(d);  // looks away
            REQUIRE(visibility_past(context, field, kPlace, list)[0] == 1);
        }
}

TEST_CASE("Transformed instances hide what the transformed mesh does") {
    const Context context;
    const TriangleMesh mesh = clutter();
    const Field field = baked_volume(context, mesh, 40);
    Random random(31);
    const glm::dmat3 rotation = random.rotation();
    const glm::dmat3 stretched(glm::dvec3(2, 0, 0), glm::dvec3(0, 0.7, 0), glm::dvec3(0, 0, 1.2));
    const glm::dmat3 mirrored(glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1));
    const glm::dmat3 sheared(glm::dvec3(1, 0, 0), glm::dvec3(0.8, 1, 0), glm::dvec3(0, -0.5, 1));
    struct Case {
        const char* name;
        glm::dmat3 linear;
        double limit;  // RMS, grey
    };
    const ReceiverList list = around(1.3, 3, 2000, 5);
    for (const Case& c :
         {Case{"identity", glm::dmat3(1), 9}, Case{"rotated", rotation, 9}, Case{"large", 40.0 * rotation, 9},
          Case{"tiny", 1e-3 * rotation, 9}, Case{"mirrored", rotation * mirrored, 9},
          Case{"stretched", rotation * stretched, 12}, Case{"sheared", sheared, 12},
          Case{"mirrored and stretched", mirrored * rotation * stretched, 12}}) {
        INFO(c.name);
        const glm::mat4 transform = placed(c.linear, {5, -7, 11});
        const ReceiverList moved = carried(list, transform);
        const auto looked_up = visibility_past(context, field, transform, moved);
        const Error error = error_of(looked_up, ray_cast(mesh, transform, moved));
        report(c.name, error);
        CHECK(255 * error.rms < c.limit);
    }
}

TEST_CASE("A rotated instance is rotated receivers, a mirrored one mirrored receivers") {
    const Context context;
    const Field field = baked_volume(context, clutter());
    const ReceiverList list = around(0.6, 3, 2000, 6);
    const auto still = visibility_past(context, field, kPlace, list);
    Random random(8);
    const glm::dmat3 mirrored(glm::dvec3(1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1));
    for (const glm::dmat3& linear :
         {random.rotation(), 3.0 * random.rotation(), random.rotation() * mirrored}) {
        const glm::mat4 transform = placed(linear, {1, 2, -3});
        const Error error =
            error_of(visibility_past(context, field, transform, carried(list, transform)), still);
        CHECK(error.max < 2e-4);
    }
}

TEST_CASE("Open meshes are shells") {
    const Context context;
    {
        const TriangleMesh mesh = sheet();
        const Field field = baked_volume(context, mesh, 40);
        const ReceiverList below = plane(-0.6f, 2), above = plane(0.6f, 2);
        const Error error =
            error_of(visibility_past(context, field, kPlace, below), ray_cast(mesh, kPlace, below));
        report("below a sheet", error);
        CHECK(255 * error.rms < 18);
        for (const float open : visibility_past(context, field, kPlace, above)) REQUIRE(open == 1);
    }
    const TriangleMesh mesh = bowl();
    const Field field = baked_volume(context, mesh, 40);
    ReceiverList inside;  // in the middle, looking up out of it and down into it
    inside.positions = {{0, 0, -0.2f}, {0, 0, -0.2f}};
    inside.normals = {{0, 0, 1}, {0, 0, -1}};
    const auto open = visibility_past(context, field, kPlace, inside);
    CHECK(open[0] > 0.85f);
    CHECK(open[1] < 0.3f);
    const ReceiverList list = around(1.2, 3, 1000, 9);
    const Error error = error_of(visibility_past(context, field, kPlace, list), ray_cast(mesh, kPlace, list));
    report("around a bowl", error);
    CHECK(255 * error.rms < 12);
}

TEST_CASE("What is inside is told of closed surfaces, whichever way round") {
    const auto inside = [](TriangleMesh mesh, const glm::vec3& point) {
        EmbreeScene scene(EmbreeUse::kBake);
        rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
        scene.add_mesh(mesh);
        scene.commit();
        const SampleGrid grid{{1, 1, 1}, point, 0.1f};
        return samples_inside(scene, mesh, grid, 1).at(0) != 0;
    };
    const TriangleMesh box = box_mesh({-1, -1, -1}, {1, 1, 1});
    CHECK(inside(box, {0, 0, 0}));
    CHECK(inside(box, {0.95f, -0.9f, 0.9f}));
    CHECK(!inside(box, {1.05f, 0, 0}));
    TriangleMesh turned = box;
    for (glm::uvec3& t : turned.triangles) std::swap(t.x, t.y);
    CHECK(inside(turned, {0.2f, 0.3f, 0.4f}));
    TriangleMesh twice = box;  // every triangle twice
    append(twice, box);
    CHECK(inside(twice, {0.2f, 0.3f, 0.4f}));
    TriangleMesh overlapping = box;
    append(overlapping, box_mesh({0, 0, 0}, {2, 2, 2}));
    CHECK(inside(overlapping, {0.5f, 0.5f, 0.5f}));
    CHECK(inside(overlapping, {1.5f, 1.5f, 1.5f}));
    TriangleMesh open = box;  // without its lid: the line along z is not closed
    std::erase_if(open.triangles, [&](const glm::uvec3& t) {
        return box.positions[t.x].z + box.positions[t.y].z + box.positions[t.z].z > 2.9f;
    });
    CHECK(open.triangles.size() == 10);
    CHECK(!inside(open, {0, 0, 0}));
    CHECK(!inside(bowl(), {0, 0, -0.3f}));
}

TEST_CASE("Distances to a mesh are those to its nearest triangle") {
    const TriangleMesh box = box_mesh({-1, -1, -1}, {1, 1, 1});
    EmbreeScene scene(EmbreeUse::kBake);
    scene.add_mesh(box);
    scene.commit();
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 p(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3));
        const glm::vec3 beyond = glm::max(glm::abs(p) - 1.0f, 0.0f);
        const float outside = glm::length(beyond);
        const float inside = 1 - std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
        const NearestPoint nearest = nearest_point(scene, box, p, 10);
        CHECK(nearest.distance == Approx(outside > 0 ? outside : inside).margin(1e-5));
        CHECK(glm::distance(p, nearest.point) == Approx(nearest.distance).margin(1e-5));
    }
    CHECK(nearest_point(scene, box, {5, 0, 0}, 1).distance == 1);
}

TEST_CASE("An object's own vertices see past it by its volume") {
    const Context context;
    const TriangleMesh mesh = sphere_mesh(glm::vec3(0), 1, 24);
    const Field field = baked_volume(context, mesh, 40);
    ReceiverList list;
    list.positions = mesh.positions;
    list.normals = mesh.normals;
    // A sphere hides nothing of itself.
    const auto visibility = visibility_past(context, field, kPlace, list);
    const Error error = error_of(visibility, std::vector<float>(list.size(), 1.0f));
    report("a sphere, of itself", error);
    CHECK(255 * error.rms < 14);
}
