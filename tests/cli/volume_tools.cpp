// What the volume commands are made of: flags, directions, points of the surface, errors.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>

#include "baker/cli/surface_points.hpp"
#include "baker/cli/volume_sweep.hpp"
#include "baker/error.hpp"

using namespace dfield;
using namespace dfield::cli;

TEST_CASE("Flags of a sweep") {
    SweepOptions options;
    options.octants = "6,0";
    options.intensity = "0.5,2";
    options.form = "improved-48";
    options.alpha = 0.5f;
    const dfield_sweep_desc desc = sweep_desc(options, 7);
    CHECK(desc.isovalue == 7);
    CHECK(desc.form == DFIELD_FORM_IMPROVED);
    CHECK(desc.ordinates == 48);
    CHECK(desc.octants == 0x41);
    CHECK(desc.intensities[6] == 0.5f);
    CHECK(desc.intensities[0] == 2);
    CHECK(desc.through == 1);

    SweepOptions plain;
    const dfield_sweep_desc usual = sweep_desc(plain, 0);
    CHECK(usual.octants == DFIELD_ALL_OCTANTS);
    CHECK(usual.ordinates == 24);
    CHECK(usual.through == 0);
    for (const float intensity : usual.intensities) CHECK(intensity == 1);
}

TEST_CASE("Directions of the world in the frame of a sweep") {
    VolumeGrid grid;
    const auto turned = [&](const glm::vec3& direction) {
        const glm::vec3 result = to_sweep_frame(grid, direction);
        return std::array<float, 3>{result.x, result.y, result.z};
    };
    using Three = std::array<float, 3>;
    grid.directions = glm::dmat3({2, 0, 0}, {0, 3, 0}, {0, 0, 4});
    CHECK(turned({1, 2, 3}) == Three{1, 2, 3});  // anisotropic voxels leave directions as they are
    grid.directions = glm::dmat3({-2, 0, 0}, {0, 3, 0}, {0, 0, 4});
    CHECK(turned({1, 2, 3}) == Three{-1, 2, 3});
    grid.directions = glm::dmat3({0, 2, 0}, {0, 0, 3}, {4, 0, 0});
    CHECK(turned({1, 2, 3}) == Three{2, 3, 1});
    // Oblique: the line through the same voxels.
    grid.directions = glm::dmat3({1, 0, 0}, {0, 1, 0}, {3, 0, 4});
    CHECK(turned({3, 0, 4}) == Three{0, 0, 5});
}

TEST_CASE("Points of the surface: where the distance changes its sign, evenly chosen") {
    dfield_volume_grid grid{{12, 5, 10}, {2, 1, 0.5f}};
    std::vector<float> distance;
    for (int z = 0; z < 10; ++z)
        for (int y = 0; y < 5; ++y)
            for (int x = 0; x < 12; ++x) distance.push_back(2 * (static_cast<float>(x) - 4.25f));
    std::size_t crossings = 0;
    const std::vector<float> all = surface_points(grid, distance, SIZE_MAX / 1000, &crossings);
    CHECK(crossings == 5 * 6);  // two voxels at both ends of z, none of y, which is short
    REQUIRE(all.size() == 3 * crossings);
    for (std::size_t i = 0; i < crossings; ++i) {
        CHECK(all[3 * i] == 8.5f);
        CHECK(all[3 * i + 1] == static_cast<float>(i % 5));
        CHECK(all[3 * i + 2] == 0.5f * static_cast<float>(2 + i / 5));
    }
    const std::vector<float> some = surface_points(grid, distance, 4);
    REQUIRE(some.size() == 3 * 4);
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t taken = (i * crossings + 3) / 4;
        for (std::size_t axis = 0; axis < 3; ++axis) CHECK(some[3 * i + axis] == all[3 * taken + axis]);
    }
    // -0 is inside, 0 would be outside: the crossing lies at the vertex.
    for (float& value : distance) value = value < 0 ? -0.0f : 0.0f;
    CHECK(surface_points(grid, distance, 1)[0] == 8);
    for (float& value : distance) value = 1;
    CHECK(surface_points(grid, distance, 10).empty());
}

TEST_CASE("Errors of visibility") {
    const std::vector<float> truth{0, 0.5f, 1};
    const VisibilityError exact = visibility_error(truth, truth);
    CHECK(exact.rms == 0);
    CHECK(exact.bias == 0);
    CHECK(exact.correlation == Approx(1));
    const VisibilityError darker = visibility_error(std::vector<float>{0, 0.25f, 0.5f}, truth);
    CHECK(darker.bias == Approx(-0.25));
    CHECK(darker.rms == Approx(std::sqrt((0.0625 + 0.25) / 3)));
    CHECK(darker.correlation == Approx(1));
    CHECK(visibility_error(std::vector<float>{1, 0.5f, 0}, truth).correlation == Approx(-1));
    CHECK(std::isnan(visibility_error(std::vector<float>(3, 0.3f), truth).correlation));
}
