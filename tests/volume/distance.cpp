// Distance fields against closed forms.
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>

#include "tests/random.hpp"
#include "tests/volume/sweeping.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

struct Error {
    double rms, largest;
};

// Of the distances nearer than `within` to the surface, the volume's values being minus the exact ones.
Error error_of(const Swept& swept, const models::ScalarVolume& exact, double within) {
    double sum = 0, largest = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < swept.size(); ++i) {
        if (std::abs(exact.values[i]) >= within) continue;
        const double e = double{swept.distance[i]} + double{exact.values[i]};
        sum += e * e;
        largest = std::max(largest, std::abs(e));
        ++count;
    }
    REQUIRE(count > 0);
    return {std::sqrt(sum / static_cast<double>(count)), largest};
}

constexpr double kFar = 1e9;

}  // namespace

TEST_CASE("Axis-aligned planes and slabs are exact", "[volume][distance]") {
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 normal(0);
        normal[axis] = axis == 1 ? -1 : 1;
        const glm::dvec3 centre(7.25, 8.75, 6.5);
        const auto plane = models::plane_volume({21, 18, 15}, centre, normal);
        CHECK(error_of(sweep(plane), plane, kFar).largest < 2e-6 * 21);
        // A slab's two sides: every voxel belongs to the nearer one.
        const auto slab = models::slab_volume({21, 18, 15}, centre, normal, 5);
        CHECK(error_of(sweep(slab), slab, kFar).largest < 2e-6 * 21);
    }
}

TEST_CASE("A plane across anisotropic voxels is measured in world units", "[volume][distance]") {
    const auto plane = models::plane_volume({15, 14, 40}, {6, 13, 9.3}, {0, 0, 1}, {0.8, 2.0, 0.5});
    CHECK(error_of(sweep(plane), plane, kFar).largest < 1e-4);
    const auto across = models::plane_volume({15, 14, 40}, {6, 13, 9.3}, {0, 1, 0}, {0.8, 2.0, 0.5});
    CHECK(error_of(sweep(across), across, kFar).largest < 1e-4);
}

TEST_CASE("An oblique plane is exact where nothing enters through the border", "[volume][distance]") {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(1, 2, 3));
    for (const models::Spacing spacing : {models::Spacing{1, 1, 1}, models::Spacing{1.5, 1, 0.75}}) {
        const glm::dvec3 centre = 19.5 * glm::dvec3(spacing[0], spacing[1], spacing[2]);
        const auto plane = models::plane_volume({40, 40, 40}, centre, normal, spacing);
        const Swept swept = sweep(plane);
        double largest = 0;
        std::size_t count = 0;
        for (std::size_t z = 12; z < 28; ++z)
            for (std::size_t y = 12; y < 28; ++y)
                for (std::size_t x = 12; x < 28; ++x) {
                    const std::size_t i = swept.index(x, y, z);
                    if (std::abs(plane.values[i]) >= 5) continue;
                    largest =
                        std::max(largest, std::abs(double{swept.distance[i]} + double{plane.values[i]}));
                    ++count;
                }
        CHECK(count > 1000);
        CHECK(largest < 1e-4);
    }
}

TEST_CASE("Spheres within five voxels of the surface", "[volume][distance]") {
    struct Case {
        double radius, limit;
    };
    for (const Case& c : {Case{20.3, 0.06}, Case{33.7, 0.04}, Case{45.1, 0.03}}) {
        const auto sphere = models::sphere_volume({101, 103, 105}, {50.2, 51.7, 52.4}, c.radius);
        CHECK(error_of(sweep(sphere), sphere, 5).rms < c.limit);
    }
    const auto flat = models::sphere_volume({61, 60, 121}, {30.2, 29.7, 30.1}, 20, {1, 1, 0.5});
    CHECK(error_of(sweep(flat), flat, 5).rms < 0.06);
}

TEST_CASE("A value equal to the isovalue is inside, at distance -0", "[volume][distance]") {
    models::ScalarVolume volume{{5, 1, 1}, models::kUnitSpacing, {-2, -1, 0, 1, 2}};
    for (const dfield_simd simd : {DFIELD_SIMD_BEST, DFIELD_SIMD_SCALAR}) {
        const Swept swept = sweep(volume, sweep_defaults(), simd);
        CHECK(swept.distance == std::vector<float>{2, 1, 0, -1, -2});
        CHECK(std::signbit(swept.distance[2]));
        CHECK(!std::signbit(swept.distance[1]));
    }
    volume.values = {0, 0, 0, 0, 0};  // touches nothing outside
    for (const float d : sweep(volume).distance) CHECK(d == -INFINITY);
    dfield_sweep_desc above = sweep_defaults();
    above.isovalue = 1;
    for (const float d : sweep(volume, above).distance) CHECK(d == INFINITY);
}

TEST_CASE("Every type of sample and any strides give the same field", "[volume][distance]") {
    const models::Dims dims{37, 19, 11};
    const auto blob = models::sphere_volume(dims, {17, 9, 5}, 4.4);
    std::vector<std::int8_t> i8;
    for (const float v : blob.values)
        i8.push_back(static_cast<std::int8_t>(std::lround(std::clamp(v * 20, -127.f, 127.f))));
    const auto as = [&](auto zero, int offset, std::size_t row_pad) {
        using Type = decltype(zero);
        const std::size_t row = dims[0] + row_pad;
        std::vector<Type> values(row * dims[1] * dims[2] + row_pad, Type(99));
        for (std::size_t i = 0; i < i8.size(); ++i)
            values[i / dims[0] * row + i % dims[0]] = static_cast<Type>(i8[i] + offset);
        return values;
    };
    const Context context;
    dfield_sweep_desc desc = sweep_defaults();
    dfield_volume_samples samples = samples_of(blob);
    const auto check = [&](const auto& values, std::uint32_t type, float iso, std::size_t row_pad) {
        samples.data = values.data();
        samples.type = type;
        samples.row_stride = row_pad ? (dims[0] + row_pad) * sizeof values[0] : 0;
        desc.isovalue = iso;
        return sweep(context, samples, desc);
    };
    const Swept first = check(as(float{}, 0, 0), DFIELD_SAMPLE_F32, 0.5f, 0);
    CHECK(check(as(float{}, 0, 3), DFIELD_SAMPLE_F32, 0.5f, 3).distance == first.distance);
    CHECK(check(as(std::int8_t{}, 0, 0), DFIELD_SAMPLE_I8, 0.5f, 0).distance == first.distance);
    CHECK(check(as(std::uint8_t{}, 128, 5), DFIELD_SAMPLE_U8, 128.5f, 5).distance == first.distance);
    CHECK(check(as(std::int16_t{}, -1000, 0), DFIELD_SAMPLE_I16, -999.5f, 0).distance == first.distance);
    CHECK(check(as(std::uint16_t{}, 40000, 1), DFIELD_SAMPLE_U16, 40000.5f, 1).distance == first.distance);
}

TEST_CASE("A narrow band holds what the full field holds within it", "[volume][distance]") {
    const auto volume = models::gyroid_volume({50, 41, 33}, 2);
    for (const dfield_occlusion_form form : kForms) {
        const Swept full = sweep(volume, form_desc(form));
        dfield_sweep_desc narrow = form_desc(form);
        narrow.band = 2.5f;
        const Swept band = sweep(volume, narrow);
        std::size_t cut = 0;
        for (std::size_t i = 0; i < full.size(); ++i) {
            REQUIRE(band.distance[i] == std::clamp(full.distance[i], -2.5f, 2.5f));
            if (std::abs(full.distance[i]) > 2.5f) ++cut;
        }
        CHECK(cut > 0);
    }
}

TEST_CASE("Mirrored and turned volumes have mirrored and turned distances", "[volume][distance]") {
    // The order of the sweeps is not symmetric: one round of them leaves a few vertices, where fronts meet,
    // short of where further rounds would bring them, and not the same ones in a mirrored volume.
    const auto volume = models::floor_volume({33, 33, 33});
    const Swept swept = sweep(volume);
    for (int change = 0; change < 4; ++change) {
        models::ScalarVolume changed = volume;
        const auto from = [&](std::size_t x, std::size_t y, std::size_t z) {
            return change == 0   ? volume.index(32 - x, y, z)
                   : change == 1 ? volume.index(x, 32 - y, z)
                   : change == 2 ? volume.index(x, y, 32 - z)
                                 : volume.index(y, z, x);
        };
        for (std::size_t i = 0; i < changed.values.size(); ++i)
            changed.values[i] = volume.values[from(i % 33, i / 33 % 33, i / (33 * 33))];
        const Swept other = sweep(changed);
        double sum = 0;
        for (std::size_t i = 0; i < swept.size(); ++i) {
            const std::size_t j = from(i % 33, i / 33 % 33, i / (33 * 33));
            sum += std::pow(double{other.distance[i]} - double{swept.distance[j]}, 2);
            // What the first step sets does not depend on the sweeps.
            if (std::abs(swept.distance[j]) < 0.5f)
                REQUIRE(other.distance[i] == Approx(swept.distance[j]).margin(1e-5));
        }
        CHECK(std::sqrt(sum / static_cast<double>(swept.size())) < 0.015);
    }
}
