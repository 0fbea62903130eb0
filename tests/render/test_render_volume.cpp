// Pictures of volumes against closed forms.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <stdexcept>

#include "baker/error.hpp"
#include "baker/volume/render_volume.hpp"

using namespace dfield;
using Catch::Contains;

namespace {

VolumeGrid grid_of(std::array<std::size_t, 3> size, const glm::dmat3& directions = glm::dmat3(1)) {
    VolumeGrid grid;
    grid.size = size;
    grid.directions = directions;
    // The middle of the grid lies at the world's origin.
    grid.origin = -(directions * (0.5 * glm::dvec3(size[0] - 1.0, size[1] - 1.0, size[2] - 1.0)));
    return grid;
}

std::vector<float> sampled(const VolumeGrid& grid, const std::function<double(const glm::dvec3&)>& value) {
    std::vector<float> values;
    for (std::size_t z = 0; z < grid.size[2]; ++z)
        for (std::size_t y = 0; y < grid.size[1]; ++y)
            for (std::size_t x = 0; x < grid.size[0]; ++x)
                values.push_back(static_cast<float>(value(grid.position(glm::dvec3(x, y, z)))));
    return values;
}

constexpr double kRadius = 20;

std::vector<float> sphere(const VolumeGrid& grid) {
    return sampled(grid, [](const glm::dvec3& p) { return glm::length(p) - kRadius; });
}

// Oblique, anisotropic and mirrored; the sphere fits in.
VolumeGrid skewed_grid() {
    return grid_of({70, 50, 90},
                   glm::dmat3(glm::dvec3(0.8, 0.3, 0), glm::dvec3(-0.4, 1.2, 0.1), glm::dvec3(0.1, 0, -0.7)));
}

constexpr float kDistance = 100;
const Camera kCamera{{0, -kDistance, 0}, {0, 0, 0}, {0, 0, 1}, 35};

RenderOptions small(std::uint32_t samples = 1) {
    return {.width = 160, .height = 120, .samples = samples, .background = glm::vec3(0)};
}

// The ray through the middle of a pixel of kCamera's picture.
glm::dvec3 pixel_direction(const RenderOptions& options, std::uint32_t x, std::uint32_t y) {
    const double pixel = 2 * std::tan(glm::radians(17.5)) / options.height;
    return glm::normalize(
        glm::dvec3((x + 0.5 - 0.5 * options.width) * pixel, 1, (0.5 * options.height - y - 0.5) * pixel));
}

int lit_pixels(const Image& image) {
    int count = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) count += image.rgb[i] > 0;
    return count;
}

double mean_grey(const Image& image) {
    double sum = 0;
    for (const std::uint8_t byte : image.rgb) sum += byte;
    return sum / static_cast<double>(image.rgb.size());
}

TransferFunction constant(float opacity, const glm::vec3& rgb = glm::vec3(1)) {
    return TransferFunction({{0, opacity}}, {{0, rgb}});
}

}  // namespace

TEST_CASE("shadows: hard ones where the light is hidden, soft ones over the ambient part") {
    // A ball of radius 6 over a floor, seen from above at an angle; the light stands in the zenith.
    const VolumeGrid grid = grid_of({64, 64, 48});
    const glm::dvec3 ball(0, 0, 4);
    const auto distance =
        sampled(grid, [&](const glm::dvec3& p) { return std::min(p.z + 12, glm::length(p - ball) - 6); });
    const Camera camera{{0, -100, 60}, {0, 0, -12}, {0, 0, 1}, 20};
    IsosurfaceStyle style;
    style.ambient = 0.2f;
    style.light = {0, 0, 1};
    const auto grey_at = [&](const glm::vec3& point) {
        // The pixel that shows a point: the camera looks along its target.
        const RenderOptions options = small();
        const glm::vec3 forward = glm::normalize(camera.target - camera.eye), right(1, 0, 0),
                        up = glm::cross(right, forward), to = point - camera.eye;
        const float scale =
            0.5f * static_cast<float>(options.height) / std::tan(glm::radians(10.0f)) / glm::dot(to, forward);
        const Image image = render_isosurface({grid, distance}, camera, style, options);
        const auto x = static_cast<std::uint32_t>(0.5f * static_cast<float>(options.width) +
                                                  scale * glm::dot(to, right));
        const auto y =
            static_cast<std::uint32_t>(0.5f * static_cast<float>(options.height) - scale * glm::dot(to, up));
        return int{*image.at(x, y)};
    };
    const glm::vec3 below(0, -3, -12), beside(12, -3, -12);
    CHECK(grey_at(below) == Approx(255).margin(2));
    style.hard_shadows = true;
    CHECK(grey_at(below) == Approx(51).margin(2));
    CHECK(grey_at(beside) == Approx(255).margin(2));
    style.hard_shadows = false;
    style.shadows = true;
    style.visibility_at = [&](const glm::vec3& index) { return index.x > 36 ? 0.5f : 0.0f; };
    CHECK(grey_at(below) == Approx(51).margin(2));
    CHECK(grey_at(beside) == Approx(255 * (0.2 + 0.8 * 0.5)).margin(2));
    style.shadows = false;
    CHECK(grey_at(beside) == Approx(255 * 0.5).margin(2));
}

TEST_CASE("a sphere's silhouette is the cone that touches it") {
    for (const VolumeGrid& grid : {grid_of({48, 48, 48}), skewed_grid()}) {
        const std::vector<float> distance = sphere(grid);
        RenderOptions options = small(4);
        const Image image = render_isosurface({grid, distance}, kCamera, {.local = false}, options);
        // tan of the cone's angle is r / sqrt(d^2 - r^2), in a picture plane at distance 1.
        const double tangent = kRadius / std::sqrt(kDistance * kDistance - kRadius * kRadius);
        const double plane = 2 * std::tan(glm::radians(17.5));
        const double share = M_PI * tangent * tangent / (plane * plane * options.width / options.height);
        CHECK(mean_grey(image) / 255 == Approx(share).epsilon(0.004));
    }
}

TEST_CASE("a sphere is shaded by its normals, whatever the grid") {
    const glm::vec3 light = glm::normalize(glm::vec3(1, -2, 3));
    for (const VolumeGrid& grid : {grid_of({48, 48, 48}), skewed_grid()})
        for (const glm::vec3& towards : {glm::vec3(0), 7.0f * light}) {
            const std::vector<float> distance = sphere(grid);
            const RenderOptions options = small();
            const Image image =
                render_isosurface({grid, distance}, kCamera, {.ambient = 0.2f, .light = towards}, options);
            int checked = 0;
            double worst = 0;
            for (std::uint32_t y = 0; y < options.height; y += 3)
                for (std::uint32_t x = 0; x < options.width; x += 3) {
                    const glm::dvec3 eye(kCamera.eye), ray = pixel_direction(options, x, y);
                    const double b = glm::dot(eye, ray), c = glm::dot(eye, eye) - kRadius * kRadius;
                    if (b * b - c < 100) continue;  // beside the sphere or at its rim
                    const glm::dvec3 normal = (eye + (-b - std::sqrt(b * b - c)) * ray) / kRadius;
                    const glm::dvec3 to_light = towards == glm::vec3(0) ? -ray : glm::dvec3(light);
                    const double expected = 255 * (0.2 + 0.8 * std::max(0.0, glm::dot(normal, to_light)));
                    worst = std::max(worst, std::abs(image.at(x, y)[0] - expected));
                    ++checked;
                }
            CHECK(checked > 100);
            CHECK(worst < 3);  // grey levels of 255: the curvature between voxels
        }
}

TEST_CASE("visibility is sampled at the surface, or along its normal") {
    const VolumeGrid grid = grid_of({48, 48, 48});
    const std::vector<float> distance = sphere(grid);
    // 0.5 at the surface, a tenth more every voxel outwards.
    const std::vector<float> visibility =
        sampled(grid, [](const glm::dvec3& p) { return 0.5 + 0.1 * (glm::length(p) - kRadius); });
    const RenderOptions options = small();
    const auto middle = [&](const IsosurfaceStyle& style) {
        return render_isosurface({grid, distance}, kCamera, style, options)
            .at(options.width / 2, options.height / 2)[0];
    };
    CHECK(middle({.local = false, .visibility = visibility}) == Approx(0.5 * 255).margin(2));
    CHECK(middle({.local = false, .visibility = visibility, .visibility_offset = 2}) ==
          Approx(0.7 * 255).margin(2));
    CHECK(middle({.ambient = 0.2f, .visibility = visibility}) == Approx(0.5 * 255).margin(2));
    // A whole grey scale within a voxel tells how exactly the surface is found.
    const std::vector<float> steep =
        sampled(grid, [](const glm::dvec3& p) { return 0.5 + glm::length(p) - kRadius; });
    const Image exact =
        render_isosurface({grid, distance}, kCamera, {.local = false, .visibility = steep}, options);
    int worst = 0;
    for (std::uint32_t y = 45; y < 75; ++y)
        for (std::uint32_t x = 65; x < 95; ++x) worst = std::max(worst, std::abs(exact.at(x, y)[0] - 128));
    CHECK(worst <= 2);
    const Image red = render_isosurface(
        {grid, distance}, kCamera, {.local = false, .albedo = {1, 0, 0}, .visibility = visibility}, options);
    CHECK(red.at(80, 60)[0] == Approx(0.5 * 255).margin(2));
    CHECK(red.at(80, 60)[1] == 0);
}

TEST_CASE("matter that the grid cuts is seen at the cut, and empty grids are not seen") {
    const VolumeGrid grid = grid_of({21, 11, 21});
    const std::vector<float> inside(grid.voxels(), -1.0f), outside(grid.voxels(), 1.0f);
    const IsosurfaceStyle flat{.local = false};
    const Image full = render_isosurface({grid, inside}, kCamera, flat, small(4));
    // The near face, 20 x 20 world units at distance 95.
    const double plane = 2 * std::tan(glm::radians(17.5));
    CHECK(mean_grey(full) / 255 == Approx(20.0 / 95 * 20 / 95 / (plane * plane * 4 / 3)).epsilon(0.01));
    // Beyond the border all is open, whatever is known of the inside.
    const std::vector<float> dark(grid.voxels(), 0.0f);
    CHECK(render_isosurface({grid, inside}, kCamera, {.local = false, .visibility = dark}, small(4)).rgb ==
          full.rgb);
    const Image shaded =
        render_isosurface({grid, inside}, kCamera, {.ambient = 0, .light = {0, -3, 4}}, small());
    CHECK(shaded.at(80, 60)[0] == Approx(255 * 0.6).margin(1));  // the face's normal, -y
    Camera within = kCamera;
    within.eye = {0, 0, 1};
    CHECK(mean_grey(render_isosurface({grid, inside}, within, {}, small())) == 255);
    CHECK(lit_pixels(render_isosurface({grid, outside}, kCamera, flat, small())) == 0);
}

TEST_CASE("a slab of constant opacity lets through what Beer and Lambert say, whatever the step") {
    // 41 x 17 x 31 voxels of 1 x 0.25 x 2: a slab 4 thick along the view.
    const VolumeGrid grid = grid_of({41, 17, 31}, glm::dmat3(1, 0, 0, 0, 0.25, 0, 0, 0, 2));
    const std::vector<float> values(grid.voxels(), 7.0f);
    RenderOptions options = small();
    options.background = {1, 0, 0};
    for (const double reference : {0.0, 1.0, 3.0})
        for (const double step : {0.0, 0.1, 1.7, 1e-300})
            for (const float opacity : {0.01f, 0.1f, 0.4f}) {
                const Image image = render_volume({grid, values}, constant(opacity, {0, 0, 1}), kCamera,
                                                  {.reference_length = reference, .step = step}, options);
                INFO(reference << " " << step << " " << opacity);
                for (const std::uint32_t x : {80u, 95u}) {
                    const double length = 4 / pixel_direction(options, x, 60).y;
                    const double through =
                        std::pow(1 - double{opacity}, length / (reference > 0 ? reference : 0.25));
                    CHECK(std::abs(image.at(x, 60)[0] - 255 * through) < 1);
                    CHECK(std::abs(image.at(x, 60)[2] - 255 * (1 - through)) < 1);
                }
            }
}

TEST_CASE("opacity follows a ramp along the ray to the integral of its logarithm") {
    // The value is the depth y + 5 in 0..10, the layer's opacity a = 1 - exp(-depth / 20) per unit: the
    // optical depth is the integral of depth / 20, which is 10^2 / 40.
    const VolumeGrid grid = grid_of({41, 101, 41}, glm::dmat3(1, 0, 0, 0, 0.1, 0, 0, 0, 1));
    const std::vector<float> values = sampled(grid, [](const glm::dvec3& p) { return p.y + 5; });
    std::vector<TransferFunction::Opacity> points;
    for (int i = 0; i <= 1000; ++i)
        points.push_back({0.01 * i, static_cast<float>(1 - std::exp(-0.01 * i / 20))});
    RenderOptions options = small();
    options.background = glm::vec3(1);
    const Image image = render_volume({grid, values}, TransferFunction(points, {{0, glm::vec3(0)}}), kCamera,
                                      {.reference_length = 1, .step = 1}, options);
    const double slant = 1 / pixel_direction(options, 80, 60).y;
    CHECK(image.at(80, 60)[0] == Approx(255 * std::exp(-2.5 * slant)).margin(1));
}

TEST_CASE("what is in front hides what is behind") {
    const VolumeGrid grid = grid_of({41, 41, 41});
    // 1 in the near half (y < 0), 3 in the far one.
    const std::vector<float> values = sampled(grid, [](const glm::dvec3& p) { return p.y < 0 ? 1 : 3; });
    const TransferFunction transfer({{1, 0.05f}, {3, 0.05f}},
                                    {{1, {1, 0, 0}}, {2, {1, 0, 0}}, {2, {0, 0, 1}}, {3, {0, 0, 1}}});
    const RenderOptions options = small();
    const double half = 1 - std::pow(0.95, 20);
    const Image front = render_volume({grid, values}, transfer, kCamera, {}, options);
    CHECK(front.at(80, 60)[0] == Approx(255 * half).margin(4));  // the colour turns within a voxel
    CHECK(front.at(80, 60)[2] == Approx(255 * half * (1 - half)).margin(4));
    Camera behind = kCamera;
    behind.eye = -kCamera.eye;
    const Image back = render_volume({grid, values}, transfer, behind, {}, options);
    CHECK(back.at(80, 60)[2] == Approx(255 * half).margin(4));
}

TEST_CASE("local shading and visibility of volumes multiply their colours") {
    // Values rise along (1, 1, 0) / sqrt 2: every normal is at 45 degrees to the view.
    const VolumeGrid grid = grid_of({41, 41, 41});
    const std::vector<float> ramp = sampled(grid, [](const glm::dvec3& p) { return p.x + p.y; });
    const std::vector<float> flat(grid.voxels(), 0.0f), half(grid.voxels(), 0.5f);
    const RenderOptions options = small();
    const auto grey = [&](const std::vector<float>& values, const VolumeStyle& style) {
        return render_volume({grid, values}, constant(0.9f), kCamera, style, options).at(80, 60)[0];
    };
    CHECK(grey(ramp, {}) == Approx(255).margin(1));
    CHECK(grey(ramp, {.local = true, .ambient = 0.2f}) ==
          Approx(255 * (0.2 + 0.8 * std::sqrt(0.5))).margin(2));
    CHECK(grey(ramp, {.local = true, .ambient = 0.2f, .light = {-3, 3, 0}}) == Approx(255 * 0.2).margin(2));
    CHECK(grey(flat, {.local = true, .ambient = 0.2f}) == Approx(255).margin(1));  // no gradient, no shading
    CHECK(grey(ramp, {.visibility = half}) == Approx(127.5).margin(1));
    CHECK(grey(ramp, {.visibility = half, .visibility_gain = 1.5f}) == Approx(255 * 0.75).margin(1));
    CHECK(grey(ramp, {.visibility = half, .visibility_gain = 3}) == Approx(255).margin(1));
}

TEST_CASE("the whole volume is in the default camera's picture, and fills it") {
    for (const VolumeGrid& grid : {grid_of({21, 11, 51}), skewed_grid()}) {
        const std::vector<float> inside(grid.voxels(), -1.0f);
        const RenderOptions options = small();
        const Image image = render_isosurface({grid, inside}, frame_volume(grid), {.local = false}, options);
        std::uint32_t left = options.width, right = 0, top = options.height, bottom = 0;
        for (std::uint32_t y = 0; y < options.height; ++y)
            for (std::uint32_t x = 0; x < options.width; ++x)
                if (image.at(x, y)[0] > 0) {
                    left = std::min(left, x), right = std::max(right, x);
                    top = std::min(top, y), bottom = std::max(bottom, y);
                }
        CHECK(left > 0);
        CHECK(top > 0);
        CHECK(right < options.width - 1);
        CHECK(bottom < options.height - 1);
        CHECK((right - left > options.width * 0.6 || bottom - top > options.height * 0.6));
    }
}

TEST_CASE("pictures do not depend on threads, and what does not match is refused") {
    const VolumeGrid grid = skewed_grid();
    const std::vector<float> distance = sphere(grid);
    RenderOptions one = small(), three = small();
    one.threads = 1, three.threads = 3;
    CHECK(render_isosurface({grid, distance}, kCamera, {}, one).rgb ==
          render_isosurface({grid, distance}, kCamera, {}, three).rgb);
    CHECK(render_volume({grid, distance}, constant(0.01f), kCamera, {}, one).rgb ==
          render_volume({grid, distance}, constant(0.01f), kCamera, {}, three).rgb);
    const std::vector<float> few(10);
    CHECK_THROWS_AS(render_isosurface({grid, few}, kCamera), std::invalid_argument);
    CHECK_THROWS_AS(render_isosurface({grid, distance}, kCamera, {.visibility = few}), std::invalid_argument);
    CHECK_THROWS_AS(render_volume({grid, few}, constant(1), kCamera), std::invalid_argument);
    CHECK_THROWS_AS(render_volume({grid, distance}, constant(1), kCamera, {.visibility = few}),
                    std::invalid_argument);
    CHECK_THROWS_AS(render_isosurface({grid, distance}, Camera{.eye = {}, .target = {}}),
                    std::invalid_argument);
    VolumeGrid flat = grid;
    flat.directions[1] = flat.directions[0];
    CHECK_THROWS_AS(render_isosurface({flat, distance}, kCamera), std::invalid_argument);
}

TEST_CASE("transfer functions are piecewise linear and constant beyond their ends") {
    const TransferFunction transfer =
        parse_transfer_function(R"({"points": [[10, 0], [20, 0.5], [20, 1], [40, 0]],
                                    "colors": [[0, 1, 0, 0], [100, 0, 0.5, 1]]})",
                                "a.json");
    CHECK(transfer.opacity(-1e9) == 0);
    CHECK(transfer.opacity(15) == 0.25f);
    CHECK(transfer.opacity(19.9999999) == Approx(0.5));
    CHECK(transfer.opacity(20) == 1);
    CHECK(transfer.opacity(30) == 0.5f);
    CHECK(transfer.opacity(1e9) == 0);
    CHECK(transfer.colour(-5) == glm::vec3(1, 0, 0));
    CHECK(transfer.colour(50) == glm::vec3(0.5f, 0.25f, 0.5f));
    CHECK(transfer.colour(500) == glm::vec3(0, 0.5f, 1));
    CHECK(parse_transfer_function(R"({"points": [[1, 0.5]]})", "a.json").colour(7) == glm::vec3(1));
    for (const auto& [text, said] : std::vector<std::pair<std::string, std::string>>{
             {"", "no transfer function"},
             {" \n", "or lines of text: value opacity"},
             {"[]", "no transfer function"},
             {"{}", "no transfer function"},
             {R"({"points": 3})", "no transfer function"},
             {R"({"points": []})", "no points"},
             {R"({"points": [[1, 0], [2]]})", "point 1 is not [value, opacity]"},
             {R"({"points": [[1, "0"]]})", "point 0"},
             {R"({"points": [[1, 0, 0]]})", "point 0"},
             {R"({"points": [[1, 1.5]]})", "outside 0..1"},
             {R"({"points": [[1, -0.5]]})", "outside 0..1"},
             {R"({"points": [[2, 0], [1, 1]]})", "point 1 has a smaller value"},
             {R"({"points": [[1, 0]], "colors": 1})", "'colors' is no list"},
             {R"({"points": [[1, 0]], "colors": [[1, 0, 0]]})", "color 0 is not"},
             {R"({"points": [[1, 0]], "colors": [[1, 0, 0, 255]]})", "color 0 has a component outside"}}) {
        INFO(text);
        CHECK_THROWS_WITH(parse_transfer_function(text, "a.json"), Contains("a.json: ") && Contains(said));
    }
    CHECK_THROWS_AS(TransferFunction({{NAN, 0.5f}}), std::invalid_argument);
    CHECK_THROWS_AS(TransferFunction({{1, NAN}}), std::invalid_argument);
    CHECK_THROWS_AS(read_transfer_function("/nowhere/a.json"), InputError);
}
