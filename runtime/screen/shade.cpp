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

// What is done with the rows that the estimators leave.
struct Finish {
    FilterJob job;
    FilterFunction* filter;
    ZipFunction* zip;
    Outputs outputs;
    const float* ambient;

    void row(std::int32_t row) const {
        const Layout& layout = job.frame->layout;
        float values[4][kFilterColumns];  // O, I
        for (std::int32_t first = 0; first < layout.width; first += kFilterColumns) {
            const std::int32_t count = std::min(kFilterColumns, layout.width - first);
            filter(job, row, first, values);
            if (!job.indirect)
                for (int i = 1; i < 4; ++i) std::fill_n(values[i], count, 0.0f);
            write(outputs.visibility, row, first, count, values[0]);
            write(outputs.indirect, row, first, count, values[1], values[2], values[3]);
            if (!outputs.reflected) continue;
            reflect(row, first, count, values);
            write(outputs.reflected, row, first, count, values[1], values[2], values[3]);
        }
    }

  private:
    // L' = a (La O + I) in the place of I; sky reflects nothing.
    void reflect(std::int32_t row, std::int32_t first, std::int32_t count,
                 float (*values)[kFilterColumns]) const {
        const float* const depth = job.frame->depth + job.frame->layout.index(first, row);
        const auto& albedo = job.frame->albedo;
        for (std::int32_t i = 0; i < count; ++i) {
            const float* const a =
                albedo ? albedo.at(static_cast<std::size_t>(first + i), static_cast<std::size_t>(row))
                       : nullptr;
            for (std::size_t k = 0; k < 3; ++k) {
                const float incoming = ambient[k] * values[0][i] + values[1 + k][i];
                values[1 + k][i] = depth[i] < kSky ? (a ? a[k] : 1) * incoming : 0;
            }
        }
    }
    template<class... Rows>
    void write(const StridedPixels<float>& to, std::int32_t row, std::int32_t first, std::int32_t count,
               const Rows*... rows) const {
        if (!to) return;
        constexpr auto kRows = static_cast<std::ptrdiff_t>(sizeof...(Rows));
        const auto at = [&](std::int32_t i) {
            return to.at(static_cast<std::size_t>(first + i), static_cast<std::size_t>(row));
        };
        if (to.packed(kRows)) {
            if constexpr (kRows == 1)
                std::copy_n(rows..., count, at(0));
            else
                zip(rows..., count, at(0));
            return;
        }
        for (std::int32_t i = 0; i < count; ++i) {
            float* value = at(i);
            ((*value++ = rows[i]), ...);
        }
    }
};

}  // namespace

dfield_screen::dfield_screen(dfield_context* context, const Settings& settings)
    : Shared(context), settings_(settings), disk_(settings.disk_sets(context)), points_(context, settings) {}

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
    const dfield_screen_desc& desc = settings_.desc;
    const std::int64_t targets = context()->simd_targets;
    const bool filter = desc.filter != 0 && desc.interleave > 1;
    const bool indirect = buffers.radiance.data && (outputs.indirect || outputs.reflected);
    const bool vectors = desc.radius > 0;
    DiskFunction* const disk =
        vectors && settings_.disk() ? disk_function(targets, settings_.measure.kind) : nullptr;
    PointsFunction* const points = vectors && !settings_.disk() ? points_function(targets) : nullptr;

    const Layout layout(buffers.width, buffers.height);
    Lattice lattice(layout, disk ? desc.interleave : 1);
    const std::size_t planes = 2 + (indirect ? 4 : 0) + (filter ? 2 : 0);
    const std::size_t parts = !disk && !points ? 0 : !indirect ? 4 : disk ? 7 : 12;
    float* next = memory_of(planes * layout.size() + parts * lattice.size());
    const auto take = [&](std::size_t count, std::size_t size) {
        return std::exchange(next, next + count * size);
    };
    const Frame frame = decoded(buffers, take(1, layout.size()));
    const auto for_rows = [&](const auto& body) {
        context()->for_ranges(buffers.height, [&](std::size_t begin, std::size_t end) {
            body(static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end));
        });
    };

    EstimateJob job;
    job.frame = &frame;
    job.settings = &settings_;
    job.disk = &disk_;
    job.points = &points_;
    job.indirect = indirect;
    job.visibility = take(1, layout.size());
    if (indirect) job.light = take(4, layout.size());
    if (filter) job.slopes = take(2, layout.size());
    if (parts > 0) {
        lattice.depth = take(1, lattice.size());
        lattice.normals = take(3, lattice.size());
        if (indirect && disk) lattice.radiance = take(3, lattice.size());
        if (indirect && points) lattice.quads = take(8, lattice.size());
        surround(frame, lattice);
        TakeApartFunction* const take_apart = take_apart_function(targets);
        for_rows([&](std::int32_t begin, std::int32_t end) { take_apart(frame, lattice, begin, end); });
        for_rows(
            [&](std::int32_t begin, std::int32_t end) { (disk ? disk : points)(job, lattice, begin, end); });
    } else {
        for_rows([&](std::int32_t begin, std::int32_t end) {
            for (std::int32_t row = begin; row < end; ++row) estimate_reference(job, row);
        });
    }

    FilterJob filtering;
    filtering.frame = &frame;
    if (filter) filtering.side = static_cast<std::int32_t>(desc.interleave);
    filtering.limit = desc.filter_limit * desc.radius;
    filtering.indirect = indirect;
    filtering.visibility = job.visibility;
    filtering.light = job.light;
    filtering.slopes = job.slopes;
    const Finish finish{filtering, filter_function(targets), zip_function(targets), outputs, desc.ambient};
    for_rows([&](std::int32_t begin, std::int32_t end) {
        for (std::int32_t row = begin; row < end; ++row) finish.row(row);
    });
}
