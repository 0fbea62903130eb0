// The C ABI of screen.h.
#include <limits>

#include "screen/checks.hpp"
#include "screen/screen.hpp"
#include "status.hpp"

using namespace dfield::runtime;
using namespace dfield::runtime::screen;

extern "C" {

void dfield_screen_desc_init(dfield_screen_desc* desc) {
    if (!desc) return;
    *desc = {};
    desc->struct_size = sizeof *desc;
    desc->estimator = DFIELD_ESTIMATOR_DISK;
    desc->measure = DFIELD_MEASURE_QUARTIC;
    desc->radius = 1;
    desc->sigma = 1;
    desc->samples = 16;
    desc->march_steps = 16;
    desc->interleave = 4;
    desc->filter = 1;
    desc->filter_limit = 0.25f;
    desc->sight = DFIELD_SIGHT_VIEW;
    desc->weights = DFIELD_WEIGHTS_RATIO;
    for (float& ambient : desc->ambient) ambient = 1;
}

float dfield_screen_measure(const dfield_screen_desc* desc, float distance) {
    float value = std::numeric_limits<float>::quiet_NaN();
    guarded([&] {
        const Settings settings(desc);
        require(distance >= 0, "dfield_screen_measure: distance must not be negative");
        // Nothing is within a radius of 0.
        value = settings.desc.radius > 0 ? settings.measure.value(distance / settings.desc.radius) : 1;
    });
    return value;
}

dfield_status dfield_screen_create(dfield_context* context, const dfield_screen_desc* desc,
                                   dfield_screen** screen) {
    return guarded([&] {
        require(context && screen, "dfield_screen_create: context or screen is null");
        *screen = Shared<dfield_screen>::make<>(context, Settings(desc));
    });
}

void dfield_screen_release(dfield_screen* screen) {
    if (screen) screen->release();
}

dfield_status dfield_screen_shade(dfield_screen* screen, const dfield_screen_buffers* buffers,
                                  const dfield_screen_outputs* outputs) {
    return guarded([&] {
        require(screen, "dfield_screen_shade: screen is null");
        const dfield_screen_buffers checked = checked_buffers(buffers);
        screen->shade(checked, checked_outputs(outputs, checked));
    });
}

dfield_status dfield_screen_integral(dfield_screen* screen, const dfield_screen_buffers* buffers,
                                     const uint32_t* pixels, size_t count, float* visibility,
                                     float* indirect) {
    return guarded([&] {
        require(screen && visibility, "dfield_screen_integral: screen or visibility is null");
        const dfield_screen_buffers checked = checked_buffers(buffers);
        require(!indirect || checked.radiance.data, "dfield_screen_integral: indirect light needs radiance");
        const std::size_t all = std::size_t{checked.width} * checked.height;
        for (std::size_t i = 0; pixels && i < count; ++i)
            require(pixels[i] < all, "dfield_screen_integral: a pixel lies outside the picture");
        screen->integral(checked, pixels, pixels ? count : all, visibility, indirect);
    });
}

dfield_status dfield_screen_normals(dfield_context* context, const dfield_screen_buffers* buffers,
                                    const dfield_screen_target* normals) {
    return guarded([&] {
        require(context && normals && normals->data, "dfield_screen_normals: context or normals is null");
        const dfield_screen_buffers checked = checked_buffers(buffers);
        check_target(*normals, checked.width,
                     "dfield_screen_normals: strides must be multiples of 4 that hold a row");
        Frame frame = frame_of(checked, 1, DFIELD_SIGHT_VIEW);
        const Layout& layout = frame.layout;
        const Buffer<float> depth(context, layout.size());
        decode_depth(*context, frame, depth.get());
        frame.depth = depth.get();
        const StridedPixels<float> out(normals->data, normals->pixel_stride, normals->row_stride,
                                       checked.width, 3);
        context->for_ranges(checked.height, [&](std::size_t begin, std::size_t end) {
            for (auto row = static_cast<std::int32_t>(begin); row < static_cast<std::int32_t>(end); ++row)
                for (std::int32_t column = 0; column < layout.width; ++column) {
                    const bool sky = !(frame.depth[layout.index(column, row)] < kSky);
                    const glm::vec3 normal = sky ? glm::vec3(0) : shaded_at(frame, column, row).normal;
                    float* const to = out.at(static_cast<std::size_t>(column), static_cast<std::size_t>(row));
                    for (int i = 0; i < 3; ++i) to[i] = normal[i];
                }
        });
    });
}
}
