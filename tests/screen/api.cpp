// Errors at the C boundary, memory through the hooks.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <limits>
#include <string>

#include "tests/screen/scenes.hpp"

using namespace dfield;
using namespace dfield::test;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInfinity = std::numeric_limits<float>::infinity();

struct Call {
    Picture picture = take(room(), 12, 9, perspective(0.5, 0.375));
    dfield_screen_desc desc = screen_defaults();
    dfield_screen_buffers buffers = picture.buffers();
    dfield_screen_outputs outputs = no_screen_outputs();
    std::vector<float> visibility = std::vector<float>(12 * 9), light = std::vector<float>(3 * 12 * 9);

    Call() {
        outputs.visibility.data = visibility.data();
        outputs.indirect.data = light.data();
    }
    dfield_status create() const {
        const Context context;
        dfield_screen* screen = nullptr;
        const dfield_status status = dfield_screen_create(context.get(), &desc, &screen);
        CHECK((screen != nullptr) == (status == DFIELD_OK));
        dfield_screen_release(screen);
        return status;
    }
    dfield_status shade() const {
        const Context context;
        Screen screen(context, desc);
        return dfield_screen_shade(screen.get(), &buffers, &outputs);
    }
};

void check_message() {
    CHECK(std::string(dfield_error_message()).rfind("screen: ", 0) == 0);
}

template<class Change>
void check_desc_refused(const Change& change) {
    Call call;
    change(call.desc);
    CHECK(call.create() == DFIELD_INVALID_ARGUMENT);
    check_message();
}
template<class Change>
void check_refused(const Change& change) {
    Call call;
    change(call);
    CHECK(call.shade() == DFIELD_INVALID_ARGUMENT);
    check_message();
}

}  // namespace

TEST_CASE("Descs that make no sense are refused", "[screen][api]") {
    CHECK(Call().create() == DFIELD_OK);
    using Desc = dfield_screen_desc;
    check_desc_refused([](Desc& d) { d.struct_size = 8; });
    check_desc_refused([](Desc& d) { d.estimator = 6; });
    check_desc_refused([](Desc& d) { d.measure = 4; });
    check_desc_refused([](Desc& d) { d.radius = -1; });
    check_desc_refused([](Desc& d) { d.radius = kNan; });
    check_desc_refused([](Desc& d) { d.radius = kInfinity; });
    check_desc_refused([](Desc& d) { d.radius = 1e-30f; });
    check_desc_refused([](Desc& d) {
        d.measure = DFIELD_MEASURE_EXPONENTIAL;
        d.sigma = 0;
    });
    check_desc_refused([](Desc& d) { d.samples = 0; });
    check_desc_refused([](Desc& d) { d.samples = DFIELD_MAX_SCREEN_SAMPLES + 1; });
    check_desc_refused([](Desc& d) {
        d.estimator = DFIELD_ESTIMATOR_MARCH;
        d.march_steps = 0;
    });
    check_desc_refused([](Desc& d) { d.interleave = 0; });
    check_desc_refused([](Desc& d) { d.interleave = 9; });
    check_desc_refused([](Desc& d) { d.filter_limit = 0; });
    check_desc_refused([](Desc& d) { d.filter_limit = kNan; });
    check_desc_refused([](Desc& d) { d.sight = 2; });
    check_desc_refused([](Desc& d) { d.weights = 2; });
    check_desc_refused([](Desc& d) { d.ambient[1] = -1; });
    check_desc_refused([](Desc& d) { d.ambient[2] = kNan; });
    const Context context;
    dfield_screen* screen = nullptr;
    CHECK(dfield_screen_create(context.get(), nullptr, &screen) == DFIELD_INVALID_ARGUMENT);
    const dfield_screen_desc desc = screen_defaults();
    CHECK(dfield_screen_create(nullptr, &desc, &screen) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_screen_create(context.get(), &desc, nullptr) == DFIELD_INVALID_ARGUMENT);
    dfield_screen_desc_init(nullptr);
    dfield_screen_release(nullptr);
}

TEST_CASE("Buffers that make no sense are refused", "[screen][api]") {
    CHECK(Call().shade() == DFIELD_OK);
    check_refused([](Call& c) { c.buffers.struct_size = 0; });
    check_refused([](Call& c) { c.buffers.width = 0; });
    check_refused([](Call& c) { c.buffers.height = DFIELD_MAX_SCREEN_DIM + 1; });
    check_refused([](Call& c) { c.buffers.depth.data = nullptr; });
    check_refused([](Call& c) { c.buffers.depth.pixel_stride = 6; });
    check_refused([](Call& c) { c.buffers.depth.pixel_stride = -4; });
    check_refused([](Call& c) { c.buffers.depth.row_stride = 44; });
    check_refused([](Call& c) { c.buffers.normals.pixel_stride = 8; });
    check_refused([](Call& c) { c.buffers.radiance.row_stride = PTRDIFF_MAX - 3; });
    check_refused([](Call& c) { c.outputs.struct_size = 1; });
    check_refused([](Call& c) { c.outputs.visibility.row_stride = 4; });
    check_refused([](Call& c) { c.outputs.indirect.pixel_stride = 4; });
    check_refused([](Call& c) { c.buffers.radiance.data = nullptr; });
    check_refused([](Call& c) { c.buffers.camera.projection = 2; });
    check_refused([](Call& c) { c.buffers.camera.half_width = 0; });
    check_refused([](Call& c) { c.buffers.camera.half_height = kNan; });
    check_refused([](Call& c) { c.buffers.camera.offset_y = kInfinity; });
    check_refused([](Call& c) { c.buffers.depth_encoding = 2; });
    check_refused([](Call& c) { c.buffers.depth_encoding = DFIELD_DEPTH_DEVICE; });  // near and far are 0
    check_refused([](Call& c) {
        c.buffers.depth_encoding = DFIELD_DEPTH_DEVICE;
        c.buffers.camera.projection = DFIELD_PROJECTION_ORTHOGRAPHIC;
        c.buffers.camera.far_plane = kInfinity;
    });
    Call call;
    const Context context;
    Screen screen(context);
    const std::uint32_t outside = 12 * 9;
    float value = 0;
    CHECK(dfield_screen_integral(screen.get(), &call.buffers, &outside, 1, &value, nullptr) ==
          DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_screen_integral(screen.get(), &call.buffers, nullptr, 0, nullptr, nullptr) ==
          DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_screen_shade(nullptr, &call.buffers, &call.outputs) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_screen_shade(screen.get(), nullptr, &call.outputs) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_screen_shade(screen.get(), &call.buffers, nullptr) == DFIELD_INVALID_ARGUMENT);
    CHECK(dfield_screen_normals(context.get(), &call.buffers, nullptr) == DFIELD_INVALID_ARGUMENT);
    call.outputs = no_screen_outputs();  // nothing is wanted
    CHECK(dfield_screen_shade(screen.get(), &call.buffers, &call.outputs) == DFIELD_OK);
}

TEST_CASE("All memory of a screen comes from the hooks and goes back", "[screen][api]") {
    struct Count {
        std::size_t held = 0, calls = 0, fail_at = ~std::size_t{0};
    };
    Count count;
    dfield_context_desc desc{};
    desc.struct_size = sizeof desc;
    desc.user = &count;
    desc.allocate = [](void* user, std::size_t size, std::size_t alignment) -> void* {
        auto& c = *static_cast<Count*>(user);
        if (c.calls++ == c.fail_at) return nullptr;
        c.held += size;
        return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    };
    desc.deallocate = [](void* user, void* memory, std::size_t size, std::size_t) {
        static_cast<Count*>(user)->held -= size;
        std::free(memory);
    };
    {
        const Context context(&desc);
        Call call;
        {
            Screen screen(context);
            screen.shade(call.buffers, call.outputs);
            const std::size_t calls = count.calls;
            screen.shade(call.buffers, call.outputs);
            CHECK(count.calls == calls);  // the second frame allocates nothing
        }
        const std::size_t before = count.held;
        bool made = false;
        for (std::size_t failing = 0; !made; ++failing) {
            REQUIRE(failing < 20);
            count.fail_at = count.calls + failing;
            dfield_screen* screen = nullptr;
            const dfield_screen_desc defaults = screen_defaults();
            dfield_status status = dfield_screen_create(context.get(), &defaults, &screen);
            if (status == DFIELD_OK) status = dfield_screen_shade(screen, &call.buffers, &call.outputs);
            made = status == DFIELD_OK;
            if (!made) CHECK(status == DFIELD_OUT_OF_MEMORY);
            dfield_screen_release(screen);
            CHECK(count.held == before);
        }
        count.fail_at = ~std::size_t{0};
    }
    CHECK(count.held == 0);
}
