#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <stdexcept>

#include "baker/picture/render.hpp"
#include "models/shapes.hpp"

using namespace dfield;

namespace {

// In the plane z = 0, facing +z.
TriangleMesh quad(float x0, float x1, float y0, float y1) {
    TriangleMesh mesh;
    mesh.positions = {{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

// Sees -1..1 of the plane z = 0 in both axes.
Camera front_camera() {
    Camera camera;
    camera.eye = {0, 0, 10};
    camera.up = {0, 1, 0};
    camera.vertical_fov_degrees = glm::degrees(2 * std::atan(0.1f));
    return camera;
}

RenderOptions square(std::uint32_t size, int threads = 0) {
    RenderOptions options;
    options.width = options.height = size;
    options.threads = threads;
    return options;
}

int grey_at(const Image& image, std::uint32_t x, std::uint32_t y) {
    REQUIRE(image.at(x, y)[0] == image.at(x, y)[1]);
    REQUIRE(image.at(x, y)[0] == image.at(x, y)[2]);
    return image.at(x, y)[0];
}

TriangleMesh tree() {
    const models::Shape shape = models::leafy_tree();
    TriangleMesh mesh;
    for (const glm::dvec3& position : shape.positions) mesh.positions.emplace_back(position);
    for (const models::Part& part : shape.parts)
        for (const models::Face& face : part.faces) {
            mesh.triangles.emplace_back(face.a, face.b, face.c);
            if (face.d != models::kNoIndex) mesh.triangles.emplace_back(face.a, face.c, face.d);
        }
    return mesh;
}

}  // namespace

TEST_CASE("a quad fills the pixels that geometry predicts") {
    const TriangleMesh mesh = quad(-0.5f, 0.5f, -0.5f, 0.25f);
    const RenderObject objects[] = {{.mesh = &mesh, .visibility = std::vector<float>(4, 0.0f)}};
    const Image image = render(objects, front_camera(), square(80));
    for (std::uint32_t y = 0; y < 80; ++y)
        for (std::uint32_t x = 0; x < 80; ++x) {
            const bool inside = x >= 20 && x < 60 && y >= 30 && y < 60;  // rows from the top
            REQUIRE(grey_at(image, x, y) == (inside ? 0 : 255));
        }
}

TEST_CASE("visibility runs linearly between vertices") {
    const TriangleMesh mesh = quad(-1, 1, -1, 1);
    RenderObject object{.mesh = &mesh, .visibility = {0, 1, 1, 0}};
    const Image image = render(std::span(&object, 1), front_camera(), square(64));
    for (std::uint32_t x = 0; x < 64; ++x) {
        const float expected = 255 * (static_cast<float>(x) + 0.5f) / 64;
        for (const std::uint32_t y : {0u, 17u, 63u})
            REQUIRE(std::abs(static_cast<float>(grey_at(image, x, y)) - expected) <= 0.51f);
    }
}

TEST_CASE("an upright or level edge is as grey as its pixel is covered") {
    for (int sixteenths = 0; sixteenths <= 16; ++sixteenths) {
        const float edge =
            (static_cast<float>(sixteenths) / 16) / 20;  // of pixel 20 of 40, which begins at 0
        const int expected = static_cast<int>(std::lround(255.0f * static_cast<float>(16 - sixteenths) / 16));
        const TriangleMesh upright = quad(-0.7f, edge, -0.7f, 0.7f), level = quad(-0.7f, 0.7f, -edge, 0.7f);
        const RenderObject a[] = {{.mesh = &upright, .visibility = std::vector<float>(4, 0.0f)}};
        const RenderObject b[] = {{.mesh = &level, .visibility = std::vector<float>(4, 0.0f)}};
        REQUIRE(grey_at(render(a, front_camera(), square(40)), 20, 11) == expected);
        REQUIRE(grey_at(render(b, front_camera(), square(40)), 11, 20) == expected);
    }
}

TEST_CASE("the nearer surface hides the other, unless its back is culled") {
    const TriangleMesh mesh = quad(-1, 1, -1, 1);
    const glm::mat4 nearer = glm::translate(glm::mat4(1), {0, 0, 1});
    const glm::mat4 turned = glm::rotate(nearer, glm::radians(180.0f), {0, 1, 0});
    const glm::mat4 mirrored = glm::scale(nearer, {-1, 1, 1});  // as glTF has it, still facing the camera
    const std::vector<float> dark(4, 0.2f), light(4, 0.8f);
    const auto centre = [&](const glm::mat4& transform, bool cull) {
        const RenderObject objects[] = {
            {.mesh = &mesh, .visibility = light},
            {.mesh = &mesh, .transform = transform, .visibility = dark, .cull_back = cull}};
        return grey_at(render(objects, front_camera(), square(9)), 4, 4);
    };
    CHECK(centre(nearer, false) == 51);
    CHECK(centre(nearer, true) == 51);
    CHECK(centre(turned, false) == 51);
    CHECK(centre(turned, true) == 204);
    CHECK(centre(mirrored, true) == 51);
}

TEST_CASE("hemisphere shading and albedo follow their formula") {
    TriangleMesh mesh = quad(-1, 1, -1, 1);
    const float tilt = glm::radians(60.0f);
    const auto centre = [&](bool with_normals) {
        TriangleMesh plain = mesh;
        if (!with_normals) plain.normals.clear();
        const RenderObject objects[] = {
            {.mesh = &plain,
             .transform = glm::rotate(glm::mat4(1), -tilt, {1, 0, 0}),  // normal towards +y
             .albedo = {1, 0.5f, 0.25f},
             .shade = true}};
        return render(objects, front_camera(), square(9));
    };
    const float grey = 0.6f + 0.4f * std::sin(tilt);
    for (const bool with_normals : {true, false}) {
        const Image image = centre(with_normals);
        CHECK(std::abs(image.at(4, 4)[0] - 255 * grey) <= 0.6f);
        CHECK(std::abs(image.at(4, 4)[1] - 127.5f * grey) <= 0.6f);
        CHECK(std::abs(image.at(4, 4)[2] - 63.75f * grey) <= 0.6f);
    }
    mesh.normals.assign(4, {0, 0, -1});  // the file's normals point inwards: the side that is seen counts
    CHECK(std::abs(centre(true).at(4, 4)[0] - 255 * grey) <= 0.6f);
}

TEST_CASE("pictures do not depend on the number of threads") {
    const TriangleMesh mesh = tree();
    RenderObject object{.mesh = &mesh, .shade = true};
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        object.visibility.push_back(static_cast<float>(i % 97) / 96);
    const Camera camera = frame_bounds(triangle_bounds(mesh), {1, 0.4f, 0.7f}, {0, 1, 0}, 35, 1);
    const Image once = render(std::span(&object, 1), camera, square(160, 1));
    CHECK(render(std::span(&object, 1), camera, square(160, 2)).rgb == once.rgb);
    CHECK(render(std::span(&object, 1), camera, square(160, 8)).rgb == once.rgb);
    CHECK(*std::min_element(once.rgb.begin(), once.rgb.end()) < 40);  // there is something in it
}

TEST_CASE("a framed box is all in view and fills the picture") {
    const Bounds bounds{{-1, 2, 0.5f}, {3, 2.5f, 7}};
    for (const glm::vec3 direction :
         {glm::vec3(1, 0.7f, 1.2f), glm::vec3(-3, -1, 0.2f), glm::vec3(0, 1, 0)}) {
        const float aspect = 1.6f, fov = 40;
        const Camera camera = frame_bounds(bounds, direction, {0, 1, 0}, fov, aspect);
        const glm::vec3 back = glm::normalize(camera.eye - camera.target);
        CHECK(glm::dot(back, glm::normalize(direction)) == Approx(1));
        // Looking straight down leaves the turn about the axis open; lookAt needs some up.
        const glm::vec3 up = direction == glm::vec3(0, 1, 0)
                                 ? glm::cross(back, glm::cross(glm::vec3(1, 0, 0), back))
                                 : camera.up;
        const glm::mat4 view = glm::lookAt(camera.eye, camera.target, up);
        float widest = 0, highest = 0;
        for (int i = 0; i < 8; ++i) {
            const glm::vec3 corner(i & 1 ? bounds.max.x : bounds.min.x, i & 2 ? bounds.max.y : bounds.min.y,
                                   i & 4 ? bounds.max.z : bounds.min.z);
            const glm::vec3 p(view * glm::vec4(corner, 1));
            const float reach = -p.z * std::tan(glm::radians(fov / 2));
            REQUIRE(reach > 0);
            widest = std::max(widest, std::abs(p.x) / (reach * aspect));
            highest = std::max(highest, std::abs(p.y) / reach);
        }
        if (direction == glm::vec3(0, 1, 0)) continue;  // the frame's turn is render's own choice there
        CHECK(std::max(widest, highest) == Approx(0.96f).epsilon(1e-3));
    }
}

TEST_CASE("bad objects and cameras are refused") {
    const TriangleMesh mesh = quad(-1, 1, -1, 1);
    RenderObject object{.mesh = &mesh, .visibility = {1, 1}};
    CHECK_THROWS_AS(render(std::span(&object, 1), front_camera()), std::invalid_argument);
    object.visibility.clear();
    object.transform[0] = glm::vec4(0);
    CHECK_THROWS_AS(render(std::span(&object, 1), front_camera()), std::invalid_argument);
    CHECK_THROWS_AS(render({}, Camera{}), std::invalid_argument);

    const TriangleMesh empty;
    const RenderObject nothing[] = {{.mesh = &empty}};
    RenderOptions options = square(4);
    options.background = {0.2f, 0.4f, 0.6f};
    const Image image = render(nothing, front_camera(), options);
    CHECK(image.at(2, 2)[0] == 51);
    CHECK(image.at(2, 2)[1] == 102);
    CHECK(image.at(2, 2)[2] == 153);
}
