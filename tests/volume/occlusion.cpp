// The paper's form: closed forms, symmetry, bounds.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/random.hpp"
#include "tests/volume/sweeping.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

// Equation 6 in front of a wall, in closed form. Light that is followed back takes a step along x, y or z
// with probability 1/3 each. It is dark if it steps into the wall, `to_wall` steps along z away, before it
// leaves the grid sideways, after `to_x` steps along x or `to_y` along y.
double lit_behind_wall(int to_x, int to_y, int to_wall) {
    double dark = 0;
    for (int i = 0; i < to_x; ++i)
        for (int j = 0; j < to_y; ++j) {
            const int others = to_wall - 1;  // z-steps in any order among them, and one last z-step
            dark += std::exp(std::lgamma(i + j + others + 1) - std::lgamma(i + 1) - std::lgamma(j + 1) -
                             std::lgamma(others + 1) - (i + j + to_wall) * std::log(3.0));
        }
    return 1 - dark;
}

// Matter or none: every step of the distances' first step, and of the sweeps, is then monotone in the matter.
models::ScalarVolume random_matter(models::Dims dims, double share, std::uint64_t seed) {
    Random random(seed);
    models::ScalarVolume volume{dims, models::kUnitSpacing, {}};
    for (std::size_t i = 0; i < std::size_t{dims[0]} * dims[1] * dims[2]; ++i)
        volume.values.push_back(random.uniform(0, 1) < share ? 1.0f : -1.0f);
    return volume;
}

}  // namespace

TEST_CASE("In front of a wall each octant sees what the closed form says", "[volume][occlusion]") {
    // The surface half way between two voxels: transmittance 0 and 1 on its sides.
    const int nx = 21, ny = 17, nz = 12, wall = 4;  // voxels z < wall are inside
    const auto volume = models::plane_volume({21, 17, 12}, {0, 0, wall - 0.5}, {0, 0, 1});
    const Swept swept = sweep(volume, form_desc(DFIELD_FORM_PAPER));
    for (int z = wall; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                const std::size_t i = swept.index(static_cast<std::size_t>(x), static_cast<std::size_t>(y),
                                                  static_cast<std::size_t>(z));
                for (std::size_t s = 0; s < 8; ++s) {
                    const int to_x = s & 1 ? nx - x : x + 1, to_y = s & 2 ? ny - y : y + 1;
                    const double lit = s & 4 ? 1 : lit_behind_wall(to_x, to_y, z - wall + 1);
                    REQUIRE(std::abs(swept.octant(s, i) - 255 * lit) < 0.51);
                }
                // The normal is z: the octants below do not count, and those above are open.
                REQUIRE(swept.visibility[i] == Approx(1).margin(1e-3));
            }
}

TEST_CASE("Between two walls only the sides are open", "[volume][occlusion]") {
    // The slab's complement: matter but for the gap of `gap` voxels.
    const int n = 15, gap = 4, low = 5;
    auto volume = models::slab_volume({15, 15, 15}, {0, 0, low + (gap - 1) / 2.0}, {0, 0, 1}, gap);
    for (float& value : volume.values) value = -value;
    const Swept swept = sweep(volume, form_desc(DFIELD_FORM_PAPER));
    for (int z = low; z < low + gap; ++z) {
        const std::size_t i = swept.index(7, 3, static_cast<std::size_t>(z));
        for (std::size_t s = 0; s < 8; ++s) {
            const int to_x = s & 1 ? n - 7 : 8, to_y = s & 2 ? n - 3 : 4;
            const int to_wall = s & 4 ? low + gap - z : z - low + 1;
            REQUIRE(std::abs(swept.octant(s, i) - 255 * lit_behind_wall(to_x, to_y, to_wall)) < 0.51);
        }
    }
}

TEST_CASE("An empty volume is open and a full one dark", "[volume][occlusion]") {
    models::ScalarVolume volume{{9, 7, 5}, models::kUnitSpacing, std::vector<float>(9 * 7 * 5, -1.0f)};
    for (const dfield_occlusion_form form : kForms) {
        const Swept open = sweep(volume, form_desc(form));
        for (const float v : open.visibility) CHECK(v == 1);
        for (const std::uint8_t v : open.octants) CHECK(v == 255);
    }
    std::fill(volume.values.begin(), volume.values.end(), 1.0f);
    const Swept dark = sweep(volume, form_desc(DFIELD_FORM_PAPER));
    for (std::size_t s = 0; s < 8; ++s) CHECK(dark.octant(s, dark.index(4, 3, 2)) == 0);
    CHECK(dark.visibility[dark.index(4, 3, 2)] == 0);
}

TEST_CASE("Mirrored volumes have mirrored octants", "[volume][occlusion]") {
    const models::Dims dims{19, 22, 17};
    const auto volume = random_matter(dims, 0.1, 3);
    const Swept swept = sweep(volume, form_desc(DFIELD_FORM_PAPER));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto mirrored = [&](std::size_t i) {
            std::size_t at[3] = {i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]};
            at[axis] = dims[axis] - 1 - at[axis];
            return volume.index(at[0], at[1], at[2]);
        };
        models::ScalarVolume changed = volume;
        for (std::size_t i = 0; i < changed.values.size(); ++i)
            changed.values[i] = volume.values[mirrored(i)];
        const Swept other = sweep(changed, form_desc(DFIELD_FORM_PAPER));
        int largest = 0;
        for (std::size_t i = 0; i < swept.size(); ++i) {
            for (std::size_t s = 0; s < 8; ++s)
                largest = std::max(largest, std::abs(other.octant(s ^ std::size_t{1} << axis, mirrored(i)) -
                                                     swept.octant(s, i)));
        }
        CHECK(largest <= 1);  // sums in another order
    }
}

TEST_CASE("Turned volumes have turned octants", "[volume][occlusion]") {
    const auto volume = random_matter({18, 18, 18}, 0.12, 4);
    const Swept swept = sweep(volume, form_desc(DFIELD_FORM_PAPER));
    models::ScalarVolume turned = volume;
    const auto from = [&](std::size_t i) {
        return volume.index(i / 18 % 18, i / 324, i % 18);
    };  // x -> z -> y -> x
    for (std::size_t i = 0; i < turned.values.size(); ++i) turned.values[i] = volume.values[from(i)];
    const Swept other = sweep(turned, form_desc(DFIELD_FORM_PAPER));
    int largest = 0;
    for (std::size_t i = 0; i < swept.size(); ++i)
        for (std::size_t s = 0; s < 8; ++s) {
            const std::size_t t = (s >> 1 & 1) | (s >> 2 & 1) << 1 | (s & 1) << 2;
            largest = std::max(largest, std::abs(other.octant(s, i) - swept.octant(t, from(i))));
        }
    CHECK(largest <= 1);
}

TEST_CASE("More matter never lets more light through", "[volume][occlusion]") {
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        auto volume = random_matter({21, 18, 19}, 0.05, seed);
        const Swept before = sweep(volume, form_desc(DFIELD_FORM_PAPER));
        const auto added = random_matter({21, 18, 19}, 0.05, seed + 100);
        for (std::size_t i = 0; i < volume.values.size(); ++i)
            volume.values[i] = std::max(volume.values[i], added.values[i]);
        const Swept after = sweep(volume, form_desc(DFIELD_FORM_PAPER));
        std::size_t darker = 0;
        for (std::size_t i = 0; i < before.octants.size(); ++i) {
            REQUIRE(after.octants[i] <= before.octants[i]);
            darker += after.octants[i] < before.octants[i];
        }
        CHECK(darker > before.octants.size() / 2);
    }
}

TEST_CASE("Visibility lies within [0, 1] in every form", "[volume][occlusion]") {
    for (const auto& volume : {random_matter({25, 20, 18}, 0.2, 9), models::vessels_volume({48, 40, 44}, 5),
                               models::clouds_volume({40, 44, 36}, 5)}) {
        float low = 1, high = 0;
        for (const dfield_occlusion_form form : kForms)
            for (const float v : sweep(volume, form_desc(form)).visibility) {
                REQUIRE((v >= 0 && v <= 1 + 1e-3f));
                low = std::min(low, v);
                high = std::max(high, v);
            }
        CHECK(low < 0.2f);
        CHECK(high > 0.7f);
    }
}
