// What can be asked of a sweep: octants, intensities, gamma, translucency, lights, points.
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>

#include "tests/volume/sweeping.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

double mean_of(const std::vector<float>& values) {
    double sum = 0;
    for (const float v : values) sum += double{v};
    return sum / static_cast<double>(values.size());
}

}  // namespace

TEST_CASE("Octants' light adds up", "[volume][forms]") {
    const auto volume = models::floor_volume({40, 40, 30});
    for (const dfield_occlusion_form form : {DFIELD_FORM_IMPROVED, DFIELD_FORM_PAPER}) {
        const Swept all = sweep(volume, form_desc(form));
        std::vector<float> sum(all.size());
        for (std::uint32_t s = 0; s < 8; ++s) {
            dfield_sweep_desc one = form_desc(form);
            one.octants = 1u << s;
            one.intensities[s] = 0.5f;
            const Swept lit = sweep(volume, one);
            for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += 2 * lit.visibility[i];
        }
        float largest = 0;
        for (std::size_t i = 0; i < sum.size(); ++i)
            largest = std::max(largest, std::abs(sum[i] - all.visibility[i]));
        // The improved form's geometry terms are a sum over directions, 3 per cent off its mean in the worst
        // one.
        CHECK(largest < (form == DFIELD_FORM_PAPER ? 3e-3f : 0.04f));
    }
}

TEST_CASE("COMBINED is the mean of the octants that shine", "[volume][forms]") {
    const auto volume = models::gyroid_volume({33, 28, 30}, 2);
    const Swept octants = sweep(volume, form_desc(DFIELD_FORM_PAPER));
    dfield_sweep_desc cloudy = form_desc(DFIELD_FORM_COMBINED);
    cloudy.octants = 0xf0;
    cloudy.intensities[5] = 3;
    const Swept combined = sweep(volume, cloudy);
    for (std::size_t i = 0; i < octants.size(); ++i) {
        const float sum = static_cast<float>(octants.octant(4, i) + 3 * octants.octant(5, i) +
                                             octants.octant(6, i) + octants.octant(7, i));
        REQUIRE(combined.visibility[i] == Approx(sum / (4 * 255)).margin(3.1 / 255));
    }
}

TEST_CASE("Gamma is applied to the visibility alone", "[volume][forms]") {
    const auto volume = models::gyroid_volume({24, 28, 30}, 2);
    for (const dfield_occlusion_form form : kForms)
        for (const float gamma : {2.0f, 1.7f}) {
            const Swept plain = sweep(volume, form_desc(form));
            dfield_sweep_desc desc = form_desc(form);
            desc.gamma = gamma;
            const Swept corrected = sweep(volume, desc);
            CHECK(corrected.octants == plain.octants);
            for (std::size_t i = 0; i < plain.size(); ++i)
                REQUIRE(corrected.visibility[i] ==
                        Approx(std::pow(plain.visibility[i], 1 / gamma)).margin(1e-5));
        }
}

TEST_CASE("Less opaque matter lets more light through, none lets all", "[volume][forms]") {
    const auto volume = models::floor_volume({40, 36, 30});
    for (const dfield_occlusion_form form : kForms) {
        double before = -1;
        for (const float alpha : {1.0f, 0.6f, 0.2f, 0.0f}) {
            dfield_sweep_desc desc = form_desc(form);
            desc.alpha = alpha;
            desc.through = 1;
            const double mean = mean_of(sweep(volume, desc).visibility);
            CHECK(mean > before);
            before = mean;
        }
        CHECK(before == Approx(1).margin(1e-3));
    }
}

TEST_CASE("With |N.w| a thin slab is lit from behind", "[volume][forms]") {
    const auto slab = models::slab_volume({31, 31, 21}, {15, 15, 10}, {0, 0, 1}, 3);
    for (const dfield_occlusion_form form : {DFIELD_FORM_IMPROVED, DFIELD_FORM_PAPER}) {
        dfield_sweep_desc desc = form_desc(form);
        desc.octants = 0x0f;  // from below
        const std::size_t above = 15 + 31 * (15 + 31 * 14);
        CHECK(sweep(slab, desc).visibility[above] < 0.05f);
        desc.through = 1;
        const float opaque = sweep(slab, desc).visibility[above];
        desc.alpha = 0.1f;
        CHECK(sweep(slab, desc).visibility[above] > opaque + 0.05f);
    }
}

TEST_CASE("A light's shadow lies opposite to it", "[volume][forms]") {
    // A ball in mid-air: what lies behind it is in its shadow, what lies beside it is lit.
    const auto ball = models::sphere_volume({49, 49, 49}, {24, 24, 24}, 7);
    for (const dfield_occlusion_form form : {DFIELD_FORM_IMPROVED, DFIELD_FORM_PAPER})
        for (const glm::vec3 light : {glm::vec3(0, 0, 2), glm::vec3(1, -0.3, 0.2), glm::vec3(-1, -1, -1)}) {
            dfield_sweep_desc desc = form_desc(form);
            for (int axis = 0; axis < 3; ++axis) desc.light[axis] = light[axis];
            const Swept swept = sweep(ball, desc);
            const glm::vec3 towards = glm::normalize(light),
                            aside = glm::normalize(glm::cross(towards, glm::vec3(0.3, 1, 0.2)));
            const auto at = [&](const glm::vec3& from_centre) {
                const glm::vec3 p = glm::round(glm::vec3(24) + from_centre);
                return swept
                    .visibility[swept.index(static_cast<std::size_t>(p.x), static_cast<std::size_t>(p.y),
                                            static_cast<std::size_t>(p.z))];
            };
            CHECK(at(-11.0f * towards) < 0.25f);
            CHECK(at(11.0f * towards) > 0.95f);
            CHECK(at(20.0f * aside) > 0.9f);
        }
}

TEST_CASE("A light along an octant's diagonal is that octant", "[volume][forms]") {
    const auto volume = models::floor_volume({36, 36, 36});
    const Swept octants = sweep(volume, form_desc(DFIELD_FORM_PAPER));
    dfield_sweep_desc desc = form_desc(DFIELD_FORM_PAPER);
    desc.light[0] = 1;
    desc.light[1] = -1;
    desc.light[2] = 1;
    const Swept light = sweep(volume, desc);
    double sum = 0;
    for (std::size_t i = 0; i < light.size(); ++i) {
        const double e = double{light.visibility[i]} - octants.octant(5, i) / 255.0;
        sum += e * e;
    }
    // Another grid, turned around the diagonal: the same up to its resolution.
    CHECK(std::sqrt(sum / static_cast<double>(light.size())) < 0.1);
}

TEST_CASE("Points read between the voxels", "[volume][forms]") {
    const Context context;
    const auto volume = models::gyroid_volume({30, 26, 22}, 1.5);
    const Swept swept = sweep(volume, form_desc(DFIELD_FORM_PAPER));
    std::vector<float> at_voxels, between;
    for (std::size_t x = 3; x < 26; ++x)
        for (const float part : {0.0f, 0.25f}) {
            auto& to = part == 0 ? at_voxels : between;
            to.insert(to.end(), {static_cast<float>(x) + part, 11, 9});
        }
    const std::size_t count = at_voxels.size() / 3;
    const VolumeField field(context, swept.grid, swept.distance.data());
    dfield_volume_points points{};
    points.count = count;
    points.positions = at_voxels.data();
    std::vector<float> values(count), gradients(3 * count), more(count), gathered(count);
    field.interpolate(swept.distance.data(), points, values.data(), gradients.data());
    field.gather_octants(swept.octants.data(), points, gathered.data());
    points.positions = between.data();
    field.interpolate(swept.distance.data(), points, more.data());
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t voxel = swept.index(i + 3, 11, 9);
        CHECK(values[i] == swept.distance[voxel]);
        CHECK(more[i] ==
              Approx(0.75f * swept.distance[voxel] + 0.25f * swept.distance[voxel + 1]).margin(1e-5));
        CHECK(glm::length(glm::vec3(gradients[3 * i], gradients[3 * i + 1], gradients[3 * i + 2])) ==
              Approx(1).epsilon(1e-5));
        CHECK(gathered[i] == Approx(swept.visibility[voxel]).margin(0.01));
    }
}

TEST_CASE("Monte Carlo knows the plane, and its rays come from their index", "[volume][forms]") {
    const Context context;
    const auto plane = models::plane_volume({40, 40, 40}, {0, 0, 8}, {0, 0, 1});
    const Swept swept = sweep(plane);
    const VolumeField field(context, swept.grid, swept.distance.data());
    const std::vector<float> positions{20, 20, 8, 20, 20, 8, 11.5f, 30.25f, 8};
    const std::vector<float> normals{0, 0, 1, 1, 0, 0, 0, 0, 0};  // the last: the gradient
    dfield_volume_points points{};
    points.count = 3;
    points.positions = positions.data();
    points.normals = normals.data();
    std::vector<float> visibility(3), again(3), one(1);
    field.visibility_by_rays(points, 4096, 5, visibility.data());
    CHECK(visibility[0] == 1);
    CHECK(visibility[1] == Approx(0.5).margin(0.01));  // half the hemisphere of x lies below
    CHECK(visibility[2] == 1);
    field.visibility_by_rays(points, 4096, 5, again.data());
    CHECK(again == visibility);
    points.count = 1;
    points.positions = positions.data() + 3;
    points.normals = normals.data() + 3;
    field.visibility_by_rays(points, 4096, 6, one.data());
    CHECK(one[0] == visibility[1]);
}
