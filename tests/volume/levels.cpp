// Every level of SIMD, any number of threads and any size against the scalar reference.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/random.hpp"
#include "tests/volume/sweeping.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

constexpr dfield_simd kLevels[] = {DFIELD_SIMD_SSE4, DFIELD_SIMD_AVX2, DFIELD_SIMD_AVX512, DFIELD_SIMD_NEON};

// Smooth noise: surfaces of all directions, also where the grid is one voxel thick.
models::ScalarVolume waves(models::Dims dims, models::Spacing spacing, std::uint64_t seed) {
    Random random(seed);
    double k[3], phase[3];
    for (int axis = 0; axis < 3; ++axis) {
        k[axis] = random.uniform(0.3, 0.7);
        phase[axis] = random.uniform(0, 6);
    }
    models::ScalarVolume volume{dims, spacing, {}};
    for (std::uint32_t z = 0; z < dims[2]; ++z)
        for (std::uint32_t y = 0; y < dims[1]; ++y)
            for (std::uint32_t x = 0; x < dims[0]; ++x)
                volume.values.push_back(static_cast<float>(std::sin(k[0] * x + phase[0]) +
                                                           std::sin(k[1] * y + phase[1]) +
                                                           std::sin(k[2] * z + phase[2])));
    return volume;
}

// Distances to 1e-5 of a voxel and octants to a 255th. The improved form has normals of eight bits, 0.01, and
// opacities of eight bits, whose errors add up along a ray.
void check_close(const Swept& a, const Swept& b, dfield_occlusion_form form) {
    float distance = 0, visibility = 0;
    int octant = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        REQUIRE(std::signbit(a.distance[i]) == std::signbit(b.distance[i]));
        if (std::isinf(a.distance[i]) && a.distance[i] == b.distance[i]) continue;
        distance = std::max(distance, std::abs(a.distance[i] - b.distance[i]));
        visibility = std::max(visibility, std::abs(a.visibility[i] - b.visibility[i]));
    }
    for (std::size_t i = 0; i < a.octants.size(); ++i)
        octant = std::max(octant, std::abs(a.octants[i] - b.octants[i]));
    CHECK(distance < 1e-5f * std::max({1.0f, a.grid.spacing[0], a.grid.spacing[1], a.grid.spacing[2]}));
    CHECK(octant <= (form == DFIELD_FORM_IMPROVED ? 2 : 1));
    CHECK(visibility < (form == DFIELD_FORM_IMPROVED ? 0.012f : form == DFIELD_FORM_PAPER ? 0.005f : 1e-4f));
}

}  // namespace

TEST_CASE("Every level of SIMD agrees with the reference, at any size", "[volume][levels]") {
    const models::Dims sizes[] = {{1, 1, 1},  {2, 1, 3},   {1, 17, 2}, {3, 2, 1},   {15, 16, 17},
                                  {16, 4, 4}, {33, 17, 5}, {5, 33, 9}, {64, 31, 6}, {20, 50, 12}};
    const models::Spacing spacings[] = {models::kUnitSpacing, {0.7, 1.9, 1.2}};
    std::uint64_t seed = 0;
    for (const models::Dims& dims : sizes)
        for (const models::Spacing& spacing : spacings) {
            const auto volume = waves(dims, spacing, ++seed);
            for (const dfield_occlusion_form form : kForms) {
                dfield_sweep_desc desc = form_desc(form);
                if (seed % 3 == 0) desc.alpha = 0.7f;
                if (seed % 3 == 1) desc.intensities[seed % 8] = 0.5f;
                if (seed % 4 == 1) desc.through = 1;
                if (form == DFIELD_FORM_IMPROVED && seed % 2 == 0) desc.ordinates = 48;
                const Swept reference = sweep(volume, desc, DFIELD_SIMD_SCALAR);
                for (const dfield_simd level : kLevels) {
                    INFO(dims[0] << "x" << dims[1] << "x" << dims[2] << " level " << level << " form "
                                 << form);
                    check_close(sweep(volume, desc, level), reference, form);
                }
            }
        }
}

TEST_CASE("Results are the same at any number of threads", "[volume][levels]") {
    for (const models::Dims& dims :
         {models::Dims{50, 37, 45}, models::Dims{33, 17, 5}, models::Dims{7, 40, 90}}) {
        const auto volume = waves(dims, models::kUnitSpacing, 77);
        for (const dfield_simd level : {DFIELD_SIMD_BEST, DFIELD_SIMD_SCALAR})
            for (const dfield_occlusion_form form : kForms) {
                const Swept alone = sweep(volume, form_desc(form), level);
                for (const unsigned count : {1u, 3u, 8u}) {
                    Threads threads(count);
                    dfield_context_desc how = context_desc(level);
                    threads.install(how);
                    const Swept together = sweep(Context(&how), samples_of(volume), form_desc(form));
                    CHECK(together.distance == alone.distance);
                    CHECK(together.visibility == alone.visibility);
                    CHECK(together.octants == alone.octants);
                }
            }
    }
}
