// The baselines of the measurements are right: a peer that is wrong would make the project look better than
// it is.
#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include "baker/cli/corner.hpp"
#include "baker/ray_visibility.hpp"
#include "bench/kinds/distance_field.hpp"
#include "bench/kinds/occlusion_grid.hpp"
#include "bench/paper/measure.hpp"
#include "format/hemisphere_map.hpp"
#include "tests/shapes.hpp"

namespace {

using namespace dfield;

struct Corner {
    TriangleMesh mesh;
    cli::Receivers receivers;
    std::vector<glm::vec3> directions = cosine_directions(256);
    std::vector<float> reference;

    explicit Corner(TriangleMesh object) : mesh(std::move(object)) {
        receivers = cli::placed_vertices(cli::corner_room(triangle_bounds(mesh), 0.1f), glm::mat4(1));
        EmbreeScene scene(EmbreeUse::kFast);
        scene.add_mesh(mesh);
        scene.commit();
        RayVisibilityOptions options;
        options.directions = directions;
        reference = ray_visibility(scene, receivers.positions, receivers.normals, options);
    }
    double rms(const std::vector<float>& visibility) const {
        return paper::errors_of(visibility, reference).rms;
    }
    double rms(std::uint32_t size, kinds::Inside inside) const {
        return rms(kinds::DistanceField(mesh, {size, inside}).visibility(receivers, directions));
    }
};

TriangleMesh sheet() {
    TriangleMesh mesh;
    mesh.positions = {{0, 0.5f, 0}, {1, 0.5f, 0}, {1, 0.5f, 1}, {0, 0.5f, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

}  // namespace

TEST_CASE("A sphere traced distance field sees what ray casting sees, and finer ones see it better") {
    const Corner corner(test::sphere_mesh({0.3f, 1, -2}, 0.7f));
    const double coarse = corner.rms(16, kinds::Inside::kVotes), fine = corner.rms(48, kinds::Inside::kVotes);
    CHECK(fine < 1);
    CHECK(fine < coarse);
    CHECK(coarse < 6);
}

TEST_CASE("A distance field without a sign sees an open sheet") {
    const Corner corner(sheet());
    const double none = corner.rms(std::vector<float>(corner.receivers.size(), 1.0f));
    CHECK(corner.rms(64, kinds::Inside::kNowhereThick) < 0.25 * none);
}

TEST_CASE("A distance field takes a byte a node") {
    CHECK(kinds::DistanceField(test::sphere_mesh({0, 0, 0}, 1, 8), {16}).memory_bytes() >= 16 * 16 * 16);
    CHECK(kinds::DistanceField(test::sphere_mesh({0, 0, 0}, 1, 8), {16}).memory_bytes() <= 16 * 16 * 16 + 4);
}

TEST_CASE("A grid of caps is nearly exact round a sphere, whose occlusion is a cap") {
    const Corner corner(test::sphere_mesh({0.3f, 1, -2}, 0.7f));
    const kinds::OcclusionGrid grid(corner.mesh, {32});
    CHECK(grid.memory_bytes() == 32 * 32 * 32 * 4);
    CHECK(corner.rms(grid.visibility(corner.receivers)) < 2.5);
}

TEST_CASE("A grid of caps continues beyond its box") {
    const TriangleMesh sphere = test::sphere_mesh({0.3f, 1, -2}, 0.7f);
    const kinds::OcclusionGrid grid(sphere, {32});
    const Bounds box = triangle_bounds(sphere);
    const float radius = 0.5f * box.size().x;
    cli::Receivers receivers;
    for (const float distance : {4.0f, 8.0f, 16.0f}) {
        receivers.positions.push_back(box.centre() - glm::vec3(0, distance * radius, 0));
        receivers.normals.emplace_back(0, 1, 0);
    }
    const std::vector<float> visibility = grid.visibility(receivers);
    const float exact[] = {1 - 1 / 16.0f, 1 - 1 / 64.0f, 1 - 1 / 256.0f};  // sine squared of the cap's angle
    for (int i = 0; i < 3; ++i) CHECK(visibility[i] == Approx(exact[i]).margin(0.008));
}
