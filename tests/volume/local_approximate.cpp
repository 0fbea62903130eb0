// Long rays taken two and four samples at a time, against exact ones.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "tests/volume/local_volumes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

dfield_local_desc approximate(dfield_local_desc desc) {
    desc.approximate = 1;
    return desc;
}

double rms_difference(const std::vector<float>& a, const std::vector<float>& b) {
    double squares = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
        squares += difference * difference;
    }
    return std::sqrt(squares / static_cast<double>(a.size()));
}

// Balls with skins of eight voxels, in empty space.
models::ScalarVolume balls(models::Dims dims, std::uint32_t period, double radius) {
    models::ScalarVolume volume{dims, models::kUnitSpacing, {}};
    const auto beside = [&](std::uint32_t at) { return at % period - period / 2.0; };
    for (std::uint32_t z = 0; z < dims[2]; ++z)
        for (std::uint32_t y = 0; y < dims[1]; ++y)
            for (std::uint32_t x = 0; x < dims[0]; ++x) {
                const double depth = radius - std::hypot(beside(x), beside(y), beside(z));
                volume.values.push_back(static_cast<float>(std::fmin(255.0, std::fmax(0.0, 30 * depth))));
            }
    return volume;
}

}  // namespace

TEST_CASE("Approximate long rays are near exact ones", "[volume][local]") {
    const dfield_local_desc desc = local_desc(54, 50);
    const auto check = [&](const models::ScalarVolume& volume, double most) {
        const auto exact = local_ao(volume, desc), near = local_ao(volume, approximate(desc));
        const double rms = rms_difference(exact, near);
        CHECK(rms > 0);
        CHECK(rms < most);
        CHECK(largest_difference(exact, near) < 0.015f);
    };
    check(balls({120, 120, 60}, 120, 27), 5e-4);  // as large as things are in scans of many voxels
    check(balls({120, 60, 60}, 60, 9), 5.5e-4);   // smaller ones
}

TEST_CASE("Groups of approximate rays are no longer than four voxels", "[volume][local]") {
    const models::ScalarVolume small = balls({60, 60, 40}, 30, 9);
    const auto rms = [&](float step, dfield_step_unit unit, models::Spacing spacing) {
        models::ScalarVolume volume = small;
        volume.spacing = spacing;
        dfield_local_desc desc = local_desc(54, 40);
        desc.step = step;
        desc.step_unit = unit;
        return rms_difference(local_ao(volume, desc), local_ao(volume, approximate(desc)));
    };
    const auto voxels = [&](float step) { return rms(step, DFIELD_STEP_VOXELS, models::kUnitSpacing); };
    CHECK(voxels(0.5f) > 0);
    CHECK(voxels(0.5f) < 7e-4);
    CHECK(voxels(2) > 0);
    CHECK(voxels(2) < 2.5e-3);
    CHECK(voxels(2.01f) == 0);
    // Along the axis that has the most voxels.
    CHECK(rms(1, DFIELD_STEP_WORLD, {1, 1, 0.5f}) > 0);
    CHECK(rms(1, DFIELD_STEP_WORLD, {1, 1, 0.45f}) == 0);
}

TEST_CASE("Approximate rays at every level, and where they are exact", "[volume][local]") {
    const models::ScalarVolume volume = blobs({45, 30, 21}, 3);
    for (const std::uint32_t samples : {7u, 26u, 41u, 52u}) {
        dfield_local_desc desc = local_desc(samples == 26 ? 33 : 26, samples);
        const std::vector<float> weights(desc.ray_count, 0.7f);
        if (samples == 41) desc.weights = weights.data();
        const auto reference = local_ao(volume, approximate(desc), {}, DFIELD_SIMD_SCALAR);
        for (const dfield_simd level : {DFIELD_SIMD_BEST, DFIELD_SIMD_AVX2, DFIELD_SIMD_SSE4})
            CHECK(largest_difference(local_ao(volume, approximate(desc), {}, level), reference) < 1e-4f);
        // Rays too short to have far samples.
        const auto exact = local_ao(volume, desc, {}, DFIELD_SIMD_SCALAR);
        CHECK((largest_difference(exact, reference) == 0) == (samples == 7));
    }
    // Of a haze so thin that nothing is lost twice, samples are taken at the middles of their groups.
    models::ScalarVolume haze{{90, 90, 90}, models::kUnitSpacing, std::vector<float>(90 * 90 * 90, 1.0f)};
    Transfer thin;
    thin.points = {{0, 1e-5f}};
    const auto desc = local_desc(14, 44);
    const std::size_t middle = haze.index(45, 45, 45);
    CHECK(local_ao(haze, approximate(desc), thin)[middle] ==
          Approx(local_ao(haze, desc, thin)[middle]).margin(1e-7));
}

TEST_CASE("Approximate rays of a clipped volume, and what cannot be approximate", "[volume][local]") {
    const Context context;
    const models::ScalarVolume volume = blobs({40, 30, 20}, 4);
    const Transfer transfer;
    dfield_local_desc desc = approximate(local_desc(14, 50));
    std::vector<float> clipped(volume.values.size());
    local_ao_volume_clipped(context, samples_of(volume), transfer.desc(), desc, nullptr, 0, 32,
                            clipped.data());
    CHECK(largest_difference(clipped, local_ao(volume, desc)) == 0);

    dfield_contextual_desc session = contextual_defaults();
    session.samples = samples_of(volume);
    session.opacity = transfer.desc();
    session.local = desc;
    dfield_contextual* handle = nullptr;
    CHECK(dfield_contextual_create(context.get(), &session, &handle) == DFIELD_INVALID_ARGUMENT);
    CHECK(std::strstr(dfield_error_message(), "exact") != nullptr);
    const dfield_opacity_desc opacity = transfer.desc();
    const dfield_volume_samples samples = samples_of(volume);
    desc.jitter = 0.5f;
    CHECK(dfield_volume_local_ao(context.get(), &samples, &opacity, &desc, clipped.data()) ==
          DFIELD_INVALID_ARGUMENT);
    desc.jitter = 0;
    desc.approximate = 2;
    CHECK(dfield_volume_local_ao(context.get(), &samples, &opacity, &desc, clipped.data()) ==
          DFIELD_INVALID_ARGUMENT);
}
