// A frame from buffers to outputs.
#include "screen/screen.hpp"

#include "screen/checks.hpp"
#include "screen/disk.hpp"
#include "screen/filter.hpp"

using namespace dfield::runtime;
using namespace dfield::runtime::screen;

namespace {

struct Outputs {
    StridedPixels<float> visibility, indirect, reflected;

    Outputs(const dfield_screen_outputs& given, std::uint32_t width)
        : visibility(pixels(given.visibility, width, 1)),
          indirect(pixels(given.indirect, width, 3)),
          reflected(pixels(given.reflected, width, 3)) {}
    static StridedPixels<float> pixels(const dfield_screen_target& target, std::uint32_t width,
                                       std::ptrdiff_t values) {
        return {target.data, target.pixel_stride, target.row_stride, width, values};
    }
};

// L' = a (La O + I), and what else is wanted, of a pixel.
void write_pixel(const Frame& frame, const float ambient[3], const Outputs& outputs, std::size_t column,
                 std::size_t row, float visibility, const glm::vec3& light) {
    if (outputs.visibility) *outputs.visibility.at(column, row) = visibility;
    for (int i = 0; outputs.indirect && i < 3; ++i) outputs.indirect.at(column, row)[i] = light[i];
    if (!outputs.reflected) return;
    const bool sky = !(frame.depth[frame.layout.index(static_cast<std::ptrdiff_t>(column),
                                                      static_cast<std::ptrdiff_t>(row))] < kSky);
    for (int i = 0; i < 3; ++i) {
        const float albedo = frame.albedo ? frame.albedo.at(column, row)[i] : 1;
        outputs.reflected.at(column, row)[i] = sky ? 0 : albedo * (ambient[i] * visibility + light[i]);
    }
}

void write_row(const FilterJob& job, bool filter, const float ambient[3], const Outputs& outputs,
               std::int32_t row) {
    const Layout& layout = job.frame->layout;
    float filtered[5 * kFilterColumns];
    for (std::int32_t first = 0; first < layout.width; first += kFilterColumns) {
        const std::int32_t count = std::min(kFilterColumns, layout.width - first);
        const std::ptrdiff_t from = layout.index(first, row);
        if (filter) filter_reference(job, row, first, filtered);
        const float* const visibility = filter ? filtered : job.visibility + from;
        const float* const light = filter ? filtered + kFilterColumns : job.light + from;
        const std::size_t channel = filter ? kFilterColumns : layout.size();
        for (std::int32_t i = 0; i < count; ++i) {
            glm::vec3 value(0);  // I = L~ (1 - O)
            const float weight = job.channels > 1 ? light[3 * channel + static_cast<std::size_t>(i)] : 0;
            if (weight > 0)
                value = glm::vec3(light[i], light[channel + static_cast<std::size_t>(i)],
                                  light[2 * channel + static_cast<std::size_t>(i)]) *
                        (std::max(0.0f, 1 - visibility[i]) / weight);
            write_pixel(*job.frame, ambient, outputs, static_cast<std::size_t>(first + i),
                        static_cast<std::size_t>(row), visibility[i], value);
        }
    }
}

}  // namespace

dfield_screen::dfield_screen(dfield_context* context, const Settings& settings)
    : Shared(context),
      settings_(settings),
      disk_(settings.disk_sets(context)),
      points_(settings.point_sets(context)) {}

float* dfield_screen::memory_of(std::size_t count) {
    if (size_ < count) {
        memory_ = {};
        size_ = 0;
        memory_ = Buffer<float>(context(), count);
        size_ = count;
    }
    return memory_.get();
}

Frame dfield_screen::decoded(const dfield_screen_buffers& buffers, float* depth) const {
    Frame frame = frame_of(buffers, settings_.desc.radius, settings_.desc.sight);
    decode_depth(*context(), frame, depth);
    frame.depth = depth;
    return frame;
}

void dfield_screen::shade(const dfield_screen_buffers& buffers, const dfield_screen_outputs& given) {
    const Outputs outputs(given, buffers.width);
    if (!outputs.visibility && !outputs.indirect && !outputs.reflected) return;
    const bool filter = settings_.desc.filter && settings_.desc.interleave > 1;
    const bool indirect = buffers.radiance.data && (outputs.indirect || outputs.reflected);
    const std::size_t plane = Layout(buffers.width, buffers.height).size();
    DiskFunction* const disk =
        settings_.disk() && settings_.measure.kind == DFIELD_MEASURE_QUARTIC && settings_.desc.radius > 0
            ? disk_function(context()->simd_targets)
            : nullptr;
    Lattice lattice(Layout(buffers.width, buffers.height), settings_.desc.interleave);
    float* next = memory_of((disk ? lattice.size() * (indirect ? 10 : 4) : 0) +
                            plane * (2 + (indirect ? 4 : 0) + (filter ? 2 : 0)));
    const auto take = [&](std::size_t planes) { return std::exchange(next, next + planes * plane); };
    const auto take_lattice = [&](std::size_t planes) {
        return std::exchange(next, next + planes * lattice.size());
    };
    const Frame frame = decoded(buffers, take(1));

    EstimateJob job;
    job.frame = &frame;
    job.settings = &settings_;
    job.disk = &disk_;
    job.points = &points_;
    job.indirect = indirect;
    job.visibility = take(1);
    if (indirect) job.light = take(4);
    if (filter) job.slopes = take(2);
    const auto rows = static_cast<std::size_t>(frame.layout.height);
    const auto for_rows = [&](const auto& body) {
        context()->for_ranges(rows, [&](std::size_t begin, std::size_t end) {
            body(static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end));
        });
    };
    if (disk) {
        lattice.depth = take_lattice(1);
        lattice.normals = take_lattice(3);
        if (indirect) {
            lattice.surfaces = take_lattice(3);
            lattice.radiance = take_lattice(3);
        }
        surround(frame, lattice);
        for_rows([&](std::int32_t begin, std::int32_t end) {
            for (std::int32_t row = begin; row < end; ++row) take_apart(frame, lattice, row);
        });
        for_rows([&](std::int32_t begin, std::int32_t end) { disk(job, lattice, begin, end); });
    } else {
        for_rows([&](std::int32_t begin, std::int32_t end) {
            for (std::int32_t row = begin; row < end; ++row) estimate_reference(job, row);
        });
    }

    FilterJob filtering;
    filtering.frame = &frame;
    filtering.side = static_cast<std::int32_t>(settings_.desc.interleave);
    filtering.limit = settings_.desc.filter_limit * settings_.desc.radius;
    filtering.channels = indirect ? 5 : 1;
    filtering.visibility = job.visibility;
    filtering.light = job.light;
    filtering.slopes = job.slopes;
    for_rows([&](std::int32_t begin, std::int32_t end) {
        for (std::int32_t row = begin; row < end; ++row)
            write_row(filtering, filter, settings_.desc.ambient, outputs, row);
    });
}
