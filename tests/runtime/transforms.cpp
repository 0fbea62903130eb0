// Instances under any invertible affine transform: t stays the world's, results are those of the transformed
// object.
#include <catch2/catch.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include "baker/ray_visibility.hpp"
#include "format/hemisphere_map.hpp"
#include "tests/random.hpp"
#include "tests/runtime/baked.hpp"
#include "tests/shapes.hpp"

using namespace dfield;
using test::Random;

namespace {

TriangleMesh caster() {
    TriangleMesh mesh = test::sphere_mesh({-0.6f, 0, 0.1f}, 0.5f, 24);
    test::append(mesh, test::box_mesh({0, -0.3f, -0.6f}, {1, 0.5f, 0.4f}));
    return mesh;
}

glm::mat4 placed(const glm::dmat3& linear, const glm::dvec3& translation) {
    glm::mat4 m{glm::mat3(linear)};
    m[3] = glm::vec4(glm::vec3(translation), 1);
    return m;
}

}  // namespace

TEST_CASE("Visibility past a transformed instance equals ray casting of the transformed mesh") {
    const Context context;
    const TriangleMesh mesh = caster();
    const Field field = test::baked(context, mesh, 32, 32, 8);
    Random random(31);
    const auto directions = cosine_directions(256);
    const Ao ao(context);
    const glm::dmat3 rotation = random.rotation();
    struct Case {
        const char* name;
        glm::dmat3 linear;
        double limit;  // RMS, grey
    };
    const glm::dmat3 identity(1);
    const glm::dmat3 stretched(glm::dvec3(3, 0, 0), glm::dvec3(0, 0.7, 0), glm::dvec3(0, 0, 1.5));
    const glm::dmat3 mirrored(glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1));
    const glm::dmat3 sheared(glm::dvec3(1, 0, 0), glm::dvec3(0.8, 1, 0), glm::dvec3(0, -0.5, 1));
    for (const Case& c : {Case{"identity", identity, 2.0}, Case{"rotated", rotation, 2.0},
                          Case{"scaled", 40.0 * rotation, 2.0}, Case{"tiny", 1e-3 * rotation, 2.0},
                          Case{"stretched", rotation * stretched, 2.6},
                          Case{"mirrored", rotation * mirrored, 2.0}, Case{"sheared", sheared, 2.6},
                          Case{"mirrored and stretched", mirrored * rotation * stretched, 2.6}}) {
        const glm::mat4 transform = placed(c.linear, {5, -7, 11});
        EmbreeScene embree(EmbreeUse::kFast);
        embree.add_mesh(mesh, transform);
        embree.commit();
        Scene scene(context);
        scene.add(field, &transform[0][0]);
        // Receivers on the object-space sphere of twice the bounding radius, looking about towards it.
        std::vector<glm::vec3> positions, normals;
        Random places(32);
        for (int i = 0; i < 500; ++i) {
            const glm::dvec3 at = 2.0 * places.direction();
            positions.push_back(glm::vec3(transform * glm::vec4(glm::vec3(at), 1)));
            const glm::dvec3 towards = glm::dvec3(c.linear * -at);
            const double size = glm::length(towards);
            normals.push_back(glm::vec3(glm::normalize(towards / size + 0.7 * places.direction())));
        }
        RayVisibilityOptions rays;
        rays.directions = directions;
        const auto reference = ray_visibility(embree, positions, normals, rays);
        std::vector<float> visibility(positions.size());
        dfield_receivers receivers{};
        receivers.count = positions.size();
        receivers.positions = &positions.front().x;
        receivers.normals = &normals.front().x;
        scene.visibility(ao, receivers, visibility.data());
        double squares = 0;
        for (std::size_t i = 0; i < positions.size(); ++i)
            squares += std::pow(255.0 * (visibility[i] - reference[i]), 2) / positions.size();
        INFO(c.name);
        CHECK(std::sqrt(squares) < c.limit);
    }
}

TEST_CASE("Ray parameters stay the world's under non-uniform and mirrored scale") {
    const Context context;
    const Field field = test::baked(context, test::sphere_mesh({0, 0, 0}, 1), 32, 32, 16);
    glm::mat4 transform(0);
    transform[0][0] = -4;  // an ellipsoid with half axes 4, 1, 0.5, mirrored
    transform[1][1] = 1;
    transform[2][2] = 0.5f;
    transform[3] = {10, 0, 0, 1};
    Scene scene(context);
    scene.add(field, &transform[0][0]);
    const float origins[] = {0, 0, 0, 10, 5, 0, 10, 0, -3}, directions[] = {1, 0, 0, 0, -1, 0, 0, 0, 0.25f};
    dfield_rays rays{};
    rays.count = 3, rays.origins = origins, rays.directions = directions;
    float t[3];
    scene.trace(rays, {t, 0, nullptr, 0});
    CHECK(t[0] == Approx(6).margin(0.05));
    CHECK(t[1] == Approx(4).margin(0.05));
    CHECK(t[2] == Approx(10).margin(0.1));
}
