// Occlusion sweeping against rays through the same field, at points of the isosurface.
#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>

#include "tests/volume/sweeping.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

// Where grid edges cross the isosurface, every n-th.
std::vector<float> surface_points(const Swept& swept, std::size_t wanted) {
    std::vector<float> all;
    const auto& dims = swept.grid.dims;
    for (std::size_t z = 2; z + 3 < dims[2]; ++z)
        for (std::size_t y = 2; y + 3 < dims[1]; ++y)
            for (std::size_t x = 2; x + 3 < dims[0]; ++x)
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const float a = swept.distance[swept.index(x, y, z)];
                    const float b =
                        swept.distance[swept.index(x + (axis == 0), y + (axis == 1), z + (axis == 2))];
                    if (std::signbit(a) == std::signbit(b)) continue;
                    float point[3] = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
                    point[axis] += a / (a - b);
                    for (int i = 0; i < 3; ++i) point[i] *= swept.grid.spacing[i];
                    all.insert(all.end(), point, point + 3);
                }
    const std::size_t step = std::max<std::size_t>(1, all.size() / 3 / wanted);
    std::vector<float> chosen;
    for (std::size_t i = 0; i < all.size() / 3; i += step)
        chosen.insert(chosen.end(), all.begin() + static_cast<std::ptrdiff_t>(3 * i),
                      all.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
    return chosen;
}

double rms(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(double{a[i]} - double{b[i]}, 2);
    return std::sqrt(sum / static_cast<double>(a.size()));
}

struct Quality {
    double paper, improved24, improved48;
};

Quality quality_of(const models::ScalarVolume& volume) {
    const Context context;
    const Swept paper = sweep(volume, form_desc(DFIELD_FORM_PAPER));
    const std::vector<float> positions = surface_points(paper, 2000);
    dfield_volume_points points{};
    points.count = positions.size() / 3;
    points.positions = positions.data();
    const VolumeField field(context, paper.grid, paper.distance.data());
    std::vector<float> truth(points.count), found(points.count);
    field.visibility_by_rays(points, 512, 1, truth.data());

    Quality quality{};
    field.gather_octants(paper.octants.data(), points, found.data());
    quality.paper = rms(found, truth);
    for (const std::uint32_t ordinates : {24u, 48u}) {
        dfield_sweep_desc desc = sweep_defaults();
        desc.ordinates = ordinates;
        const Swept improved = sweep(volume, desc);
        field.interpolate(improved.visibility.data(), points, found.data());
        (ordinates == 24 ? quality.improved24 : quality.improved48) = rms(found, truth);
    }
    std::cout << "RMS against rays: paper " << quality.paper << ", 24 ordinates " << quality.improved24
              << ", 48 ordinates " << quality.improved48 << "\n";
    return quality;
}

}  // namespace

TEST_CASE("Gyroid: the paper's form is as far from the truth as published, the improved one close",
          "[volume]") {
    const Quality q = quality_of(models::gyroid_volume({128, 128, 128}, 6));
    CHECK(q.paper > 0.06);
    CHECK(q.paper < 0.14);
    CHECK(q.improved24 < 0.03);
    CHECK(q.improved48 < q.improved24);
}

TEST_CASE("Floor with boxes: likewise", "[volume]") {
    const Quality q = quality_of(models::floor_volume({128, 128, 128}));
    CHECK(q.paper > 0.25);
    CHECK(q.paper < 0.4);
    CHECK(q.improved24 < 0.06);
    CHECK(q.improved48 < q.improved24);
}

TEST_CASE("Vessels: matter a few voxels thick holds its light back", "[volume]") {
    const Quality q = quality_of(models::vessels_volume({128, 128, 128}, 1));
    CHECK(q.improved24 < 0.06);
    CHECK(q.improved48 < q.improved24);
}

TEST_CASE("Voxels longer along some axes are lit alike", "[volume]") {
    const auto dense = models::gyroid_volume({128, 128, 128}, 3);
    models::ScalarVolume sparse{{43, 43, 128}, {3, 3, 1}, {}};
    for (std::uint32_t z = 0; z < 128; ++z)
        for (std::uint32_t y = 0; y < 43; ++y)
            for (std::uint32_t x = 0; x < 43; ++x)
                sparse.values.push_back(dense.values[dense.index(3 * x, 3 * y, z)]);
    const Quality q = quality_of(sparse);
    CHECK(q.improved24 < 0.045);
    CHECK(q.improved24 < q.paper);
}
