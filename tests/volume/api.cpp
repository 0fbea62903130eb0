// Errors at the C boundary, memory through the hooks.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "tests/volume/sweeping.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

struct Call {
    models::ScalarVolume volume = models::sphere_volume({9, 8, 7}, {4, 4, 3}, 2.5);
    dfield_volume_samples samples = samples_of(volume);
    dfield_sweep_desc desc = sweep_defaults();
    dfield_sweep_outputs outputs = no_sweep_outputs();
    std::vector<float> distance = std::vector<float>(9 * 8 * 7);

    Call() { outputs.distance = distance.data(); }
    dfield_status run() {
        const Context context;
        return dfield_volume_sweep(context.get(), &samples, &desc, &outputs, nullptr);
    }
};

template<class Change>
void check_refused(const Change& change) {
    Call call;
    change(call);
    CHECK(call.run() == DFIELD_INVALID_ARGUMENT);
    CHECK(std::string(dfield_error_message()).size() > 20);
}

}  // namespace

TEST_CASE("Sweeps refuse what makes no sense", "[volume][api]") {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                    kInfinity = std::numeric_limits<float>::infinity();
    CHECK(Call().run() == DFIELD_OK);
    check_refused([](Call& c) { c.samples.struct_size = 3; });
    check_refused([](Call& c) { c.desc.struct_size = 0; });
    check_refused([](Call& c) { c.outputs.struct_size += 8; });
    check_refused([](Call& c) { c.outputs.distance = nullptr; });
    check_refused([](Call& c) { c.samples.data = nullptr; });
    check_refused([](Call& c) { c.samples.type = 5; });
    check_refused([](Call& c) { c.samples.row_stride = 8; });
    check_refused([](Call& c) { c.samples.grid.dims[1] = 0; });
    check_refused([](Call& c) { c.samples.grid.dims[2] = 65537; });
    check_refused([](Call& c) { c.samples.grid.dims[0] = c.samples.grid.dims[1] = 65536; });
    check_refused([](Call& c) { c.samples.grid.spacing[0] = 0; });
    check_refused([](Call& c) { c.samples.grid.spacing[1] = -1; });
    check_refused([&](Call& c) { c.samples.grid.spacing[2] = kNan; });
    check_refused([](Call& c) { c.samples.grid.spacing[2] = 2000; });
    check_refused([&](Call& c) { c.desc.isovalue = kInfinity; });
    check_refused([](Call& c) { c.desc.form = 3; });
    check_refused([](Call& c) { c.desc.ordinates = 25; });
    check_refused([](Call& c) { c.desc.octants = 0; });
    check_refused([](Call& c) { c.desc.octants = 256; });
    check_refused([](Call& c) { c.desc.intensities[7] = -1; });
    check_refused([&](Call& c) { c.desc.intensities[0] = kNan; });
    check_refused([](Call& c) { c.desc.gamma = 0; });
    check_refused([](Call& c) { c.desc.alpha = 1.5f; });
    check_refused([](Call& c) { c.desc.band = 0; });
    check_refused([&](Call& c) { c.desc.light[1] = kNan; });
    std::vector<std::uint8_t> octants(8 * 9 * 8 * 7);
    check_refused([&](Call& c) {
        c.desc.form = DFIELD_FORM_COMBINED;
        c.outputs.octants = octants.data();
    });
}

TEST_CASE("Samples that are not finite are refused wherever they are", "[volume][api]") {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()})
        for (const std::size_t at :
             {std::size_t{0}, std::size_t{8}, std::size_t{300}, std::size_t{9 * 8 * 7 - 1}})
            for (const dfield_simd simd : {DFIELD_SIMD_BEST, DFIELD_SIMD_SCALAR}) {
                Call call;
                call.volume.values[at] = bad;
                const dfield_context_desc how = context_desc(simd);
                const Context context(&how);
                CHECK(dfield_volume_sweep(context.get(), &call.samples, &call.desc, &call.outputs, nullptr) ==
                      DFIELD_INVALID_ARGUMENT);
            }
}

TEST_CASE("Points are checked", "[volume][api]") {
    Call call;
    REQUIRE(call.run() == DFIELD_OK);
    const Context context;
    const VolumeField field(context, call.samples.grid, call.distance.data());
    float position[3] = {1, 2, NAN}, value = 0;
    dfield_volume_points points{};
    points.count = 1;
    CHECK_THROWS_AS(field.interpolate(call.distance.data(), points, &value), Exception);
    points.positions = position;
    CHECK_THROWS_AS(field.interpolate(call.distance.data(), points, &value), Exception);
    position[2] = 1e30f;  // beyond the border
    CHECK_NOTHROW(field.interpolate(call.distance.data(), points, &value));
    CHECK_THROWS_AS(field.visibility_by_rays(points, 0, 0, &value), Exception);
}

TEST_CASE("All memory of a sweep comes from the hooks and goes back", "[volume][api]") {
    struct Count {
        std::size_t held = 0, most = 0, calls = 0, fail_at = ~std::size_t{0};
    };
    Count count;
    dfield_context_desc desc{};
    desc.struct_size = sizeof desc;
    desc.user = &count;
    desc.allocate = [](void* user, std::size_t size, std::size_t alignment) -> void* {
        auto& c = *static_cast<Count*>(user);
        if (c.calls++ == c.fail_at) return nullptr;
        c.most = std::max(c.most, c.held += size);
        return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    };
    desc.deallocate = [](void* user, void* memory, std::size_t size, std::size_t) {
        static_cast<Count*>(user)->held -= size;
        std::free(memory);
    };
    const auto volume = models::gyroid_volume({64, 64, 64}, 3);
    {
        const Context context(&desc);
        const std::size_t before = count.held;
        for (const dfield_occlusion_form form : kForms) {
            count.most = count.held;
            sweep(context, samples_of(volume), form_desc(form));
            CHECK(count.held == before);
            CHECK(count.most > before);
        }
        // Out of memory, at any of the allocations.
        for (const dfield_occlusion_form form : kForms)
            for (std::size_t failing = 0; failing < 4; ++failing) {
                count.fail_at = count.calls + failing;
                Call call;
                call.desc.form = form;
                std::vector<float> visibility(call.distance.size());
                call.outputs.visibility = visibility.data();
                CHECK(dfield_volume_sweep(context.get(), &call.samples, &call.desc, &call.outputs, nullptr) ==
                      DFIELD_OUT_OF_MEMORY);
                CHECK(count.held == before);
            }
        count.fail_at = ~std::size_t{0};
    }
    CHECK(count.held == 0);
}
