// What an object hides of its own vertices, by masks.
#include "baker/cli/self_masks.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "baker/cli/runtime_scene.hpp"
#include "baker/ray_visibility.hpp"
#include "format/hemisphere_map.hpp"
#include "tests/shapes.hpp"

using namespace dfield;
using namespace dfield::cli;

namespace {

// Cosine-weighted share of a vertex's directions that a mask leaves open.
double open_share(const std::uint32_t* mask, const glm::vec3& normal,
                  const std::vector<glm::vec3>& directions) {
    double open = 0, all = 0;
    for (std::size_t r = 0; r < directions.size(); ++r) {
        const double cosine = std::max(0.0f, glm::dot(normal, directions[r]));
        all += cosine;
        if (!(mask[r / 32] >> (r % 32) & 1)) open += cosine;
    }
    return open / all;
}

}  // namespace

TEST_CASE("self masks are the object's own rays, for instances placed in any way") {
    // Two spheres side by side in one mesh, which hide each other.
    TriangleMesh mesh = test::sphere_mesh({0, 0, -1.1f}, 1, 12);
    const TriangleMesh other = test::sphere_mesh({0, 0, 1.1f}, 1, 12);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    for (const glm::uvec3& triangle : other.triangles) mesh.triangles.push_back(triangle + first);
    mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());

    const std::vector<glm::vec3> directions = fibonacci_sphere(200);
    const std::size_t words = (directions.size() + 31) / 32;
    SelfMasks few(mesh, 1, 1), many(mesh, 1000, 1);
    const glm::mat4 turned = glm::rotate(glm::translate(glm::mat4(1), {3, 4, 5}), 0.7f, {1, 2, 3});
    for (const glm::mat4& transform :
         {glm::mat4(1), turned, glm::scale(turned, {2, 0.5f, 1}), glm::scale(turned, {-1, 1, 1})}) {
        // The same rays in world space.
        const Receivers receivers = placed_vertices(mesh, transform);
        std::vector<glm::vec3> origins;
        for (const glm::vec3& origin : vertex_ray_origins(mesh))
            origins.emplace_back(transform * glm::vec4(origin, 1));
        EmbreeScene scene(EmbreeUse::kFast);
        scene.add_mesh(mesh, transform);
        scene.commit(1);
        RayVisibilityOptions options;
        options.directions = directions;
        options.shared = true;
        const std::vector<float> cast = ray_visibility(scene, origins, receivers.normals, options);

        const std::vector<std::uint32_t> exact = few.of_instance(transform, directions),
                                         near = many.of_instance(transform, directions);
        REQUIRE(exact.size() == cast.size() * words);
        REQUIRE(near.size() == exact.size());
        double exact_squares = 0, near_squares = 0, hidden = 0;
        for (std::size_t i = 0; i < cast.size(); ++i) {
            const glm::vec3& normal = receivers.normals[i];
            exact_squares += std::pow(255 * (open_share(&exact[i * words], normal, directions) - cast[i]), 2);
            near_squares += std::pow(255 * (open_share(&near[i * words], normal, directions) - cast[i]), 2);
            hidden += 1 - cast[i];
        }
        const auto count = static_cast<double>(cast.size());
        CHECK(hidden / count > 0.05);                   // there is something to get wrong
        CHECK(std::sqrt(exact_squares / count) < 0.5);  // but for rays that graze an edge
        CHECK(std::sqrt(near_squares / count) < 4);     // the nearest of 2048 directions
        CHECK(near_squares > 0);
    }
}
