// The distance field in eight sweeps, with or without visibility carried along, in the skewed layout. The
// volume goes through it slab by slab, twice: up in z for sweeps 1 to 4, down for 5 to 8, a slab's four
// sweeps one after the other while it is in the cache. That is the order of the reference: sweep s of a slab
// reads, from the slab before, the slice as sweep s left it (kept aside), not as later sweeps did.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/sweep.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <type_traits>
#include <utility>

#include "simd.hpp"
#include "volume/buffer.hpp"
#include "volume/distance_kernel-inl.hpp"
#include "volume/initialise-inl.hpp"
#include "volume/layout-inl.hpp"
#include "volume/octant_words-inl.hpp"
#include "volume/pipeline.hpp"
#include "volume/sweep.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

// What happens to a slab in a pass.
enum Stage : std::size_t { kLoad, kSweep0, kSweep1, kTurn, kSweep2, kSweep3, kStore, kStages };

class DistanceSweeps {
  public:
    explicit DistanceSweeps(const DistanceJob& job)
        : job_(job),
          grid_(job.grid),
          shape_(job.grid),
          load_row_(load_row_of(job.samples.type)),
          pipeline_(job.context, (job.grid.nz + kSlices - 1) / kSlices,
                    {{{kSlices, false},
                      {shape_.groups, true},
                      {shape_.groups, true},
                      {kSlices, false},
                      {shape_.groups, true},
                      {shape_.groups, true},
                      {kSlices, false}}}) {
        const std::size_t slab = shape_.slab_floats(), layer = shape_.slice_stride * kLanes;
        const bool light = job.carried != Carried::kNone;
        dfield_context* const context = job.context;
        distance_ = WorkerBuffer<float>(context, workers(), slab, -kFar);
        below_ = Buffer<float>(context, 4 * layer);
        border_ = WorkerBuffer<float>(context, workers(), kSlices * row());
        rows_ = WorkerBuffer<float>(context, workers(), row_sets() * kLanes * shape_.row_stride, -kFar);
        samples_ = WorkerBuffer<float>(context, workers(), kSampleRows * row());
        if (light) {
            dark_below_ = Buffer<float>(context, 4 * layer);
            dark_border_ = WorkerBuffer<float>(context, workers(), kSlices * row());
        }
        if (job.carried == Carried::kOctants)
            visibility_ = WorkerBuffer<std::uint32_t>(context, workers(), 4 * layer);
        if (job.carried == Carried::kCombined) sum_ = WorkerBuffer<float>(context, workers(), slab);
    }

    SweepResult run() {
        for (down_ = false;; down_ = true) {
            std::fill_n(below_.get(), 4 * shape_.slice_stride * kLanes, kFar);
            if (dark_below_) std::fill_n(dark_below_.get(), 4 * shape_.slice_stride * kLanes, 0.0f);
            pipeline_.run([this](std::size_t worker, std::size_t slab, std::size_t stage, std::size_t step) {
                run_step({worker, slab, step}, stage);
            });
            if (!finite_.load(std::memory_order_relaxed)) return SweepResult::kNotFinite;
            if (down_) return SweepResult::kDone;
        }
    }

  private:
    static constexpr std::size_t kSampleRows = 5;  // three rows of a slice, one of each beside it

    struct Step {
        std::size_t worker, slab, index;  // of a slice of the slab, or of a group in a sweep's order
    };
    std::size_t workers() const { return pipeline_.workers(); }
    std::size_t row_sets() const { return job_.carried == Carried::kOctants ? 4 : 1; }
    std::size_t row() const { return Shape::row_size(grid_.nx); }

    void prepare(std::size_t worker) {
        if (std::exchange(prepared_[worker], true)) return;
        for (const auto* buffer : {&distance_, &border_, &rows_, &samples_, &dark_border_, &sum_})
            buffer->prepare(worker);
        visibility_.prepare(worker);
    }

    void run_step(const Step& step, std::size_t stage) {
        if (stage == kLoad && step.index == 0) prepare(step.worker);
        switch (stage) {
            case kLoad:
                return load(step);
            case kTurn:
                return turn(step);
            case kStore:
                return store(step);
            default: {
                const std::size_t index = stage < kTurn ? stage - kSweep0 : stage - kSweep2 + 2;
                if (grid_.isotropic()) return sweep<UnitEikonal>(step, index);
                return sweep<Eikonal>(step, index);
            }
        }
    }

    std::size_t octant_of(std::size_t index) const { return kSweepOrder[(down_ ? 4 : 0) + index]; }
    // The z of a slab's slice in this pass, or nz where there is none.
    std::size_t slice_of(std::size_t slab, std::size_t slice) const {
        const std::size_t k = slab * kSlices + slice;
        return k >= grid_.nz ? grid_.nz : down_ ? grid_.nz - 1 - k : k;
    }
    // A worker's row buffers: x = 0 of the first row.
    float* rows_of(const Step& step) const { return rows_.of(step.worker) + Shape::kPad; }
    float* sample_rows(const Step& step) const { return samples_.of(step.worker) + Shape::kPad; }

    void load(const Step& step) {
        const std::size_t z = slice_of(step.slab, step.index);
        float* const rows = rows_of(step);
        for (std::size_t group = 0; group < shape_.groups; ++group) {
            for (std::size_t l = 0; l < kLanes; ++l) {
                const std::size_t y = group * kLanes + l;
                float* const row = rows + l * shape_.row_stride;
                if (z == grid_.nz || y >= grid_.ny) {
                    std::fill_n(row, grid_.nx, -kFar);
                    continue;
                }
                if (down_)
                    std::copy_n(job_.distance + grid_.index(0, y, z), grid_.nx, row);
                else
                    initialise(y, z, sample_rows(step), row);
            }
            clear_pads(rows);  // the last vectors of rows went beyond them
            const std::size_t at = shape_.at(step.index, group);
            skew_rows(shape_, Skew::kFalling, rows, distance_.of(step.worker) + at);
            if (sum_) std::fill_n(sum_.of(step.worker) + at, 4 * shape_.blocks * kLanes, 0.0f);
        }
    }

    // A row of the initial field. Row y of the slice is kept at y % 3 among the sample
    // rows.
    void initialise(std::size_t y, std::size_t z, float* samples, float* row_out) {
        const auto read = [&](std::size_t row_y, std::size_t row_z, float* to) {
            if (!load_row_(job_.samples.row(row_y, row_z), grid_.nx, job_.samples.isovalue, to))
                finite_.store(false, std::memory_order_relaxed);
        };
        const auto kept = [&](std::size_t row_y) { return samples + row_y % 3 * row(); };
        if (y == 0) read(0, z, kept(0));
        if (y + 1 < grid_.ny) read(y + 1, z, kept(y + 1));
        RowStencil stencil{kept(y),
                           kept(y),
                           kept(y),
                           kept(y),
                           kept(y),
                           y == 0 || y + 1 == grid_.ny,
                           z == 0 || z + 1 == grid_.nz};
        if (y > 0) stencil.below_y = kept(y - 1);
        if (y + 1 < grid_.ny) stencil.above_y = kept(y + 1);
        if (z > 0) {
            read(y, z - 1, samples + 3 * row());
            stencil.below_z = samples + 3 * row();
        }
        if (z + 1 < grid_.nz) {
            read(y, z + 1, samples + 4 * row());
            stencil.above_z = samples + 4 * row();
        }
        initialise_row(grid_, stencil, row_out);
    }

    template<class Solver>
    void sweep(const Step& step, std::size_t index) {
        const std::size_t octant = octant_of(index);
        if (job_.carried == Carried::kOctants) return sweep_rows<Carried::kOctants, Solver>(step, index);
        if (job_.carried == Carried::kCombined && job_.intensities[octant] != 0)
            return sweep_rows<Carried::kCombined, Solver>(step, index);
        return sweep_rows<Carried::kNone, Solver>(step, index);
    }

    template<Carried kCarried, class Solver>
    void sweep_rows(const Step& step, std::size_t index) {
        const std::size_t octant = octant_of(index);
        const Sweep& direction = kSweeps[octant];
        const Solver solver(grid_);
        GroupSweep s;
        s.vectors = static_cast<std::ptrdiff_t>(shape_.vectors);
        s.ascending = direction.x > 0;
        s.slice_stride = static_cast<std::ptrdiff_t>(shape_.slice_stride * kLanes);
        s.border_stride = static_cast<std::ptrdiff_t>(row());
        s.border = border_.of(step.worker) + Shape::kPad;
        if (step.index == 0) std::fill_n(s.border - Shape::kPad, kSlices * row(), kFar);
        if constexpr (kCarried != Carried::kNone) {
            s.dark_border = dark_border_.of(step.worker) + Shape::kPad;
            if (step.index == 0) std::fill_n(s.dark_border - Shape::kPad, kSlices * row(), 0.0f);
            s.intensity = job_.intensities[octant];
            s.alpha = job_.alpha;
        }
        const bool upward = direction.y > 0;
        const std::size_t group = upward ? step.index : shape_.groups - 1 - step.index;
        const std::size_t at = shape_.at(0, group);
        const std::size_t layer = index * shape_.slice_stride * kLanes + shape_.at(0, group);
        s.distance = distance_.of(step.worker) + at;
        s.below = below_ + layer;
        if constexpr (kCarried != Carried::kNone) s.dark_below = dark_below_ + layer;
        if constexpr (kCarried == Carried::kOctants) s.visibility = words_of(step, group, index);
        if constexpr (kCarried == Carried::kCombined) s.sum = sum_.of(step.worker) + at;
        if (upward)
            sweep_group<true, kCarried>(s, solver);
        else
            sweep_group<false, kCarried>(s, solver);
    }

    // From the layout of sweeps (+,+) and (-,-) to that of (+,-) and (-,+).
    void turn(const Step& step) {
        if (slice_of(step.slab, step.index) == grid_.nz) return;
        float* const rows = rows_of(step);
        const auto turn_one = [&](float* vectors) {
            unskew_rows(
                shape_, Skew::kFalling,
                [&](std::ptrdiff_t t)
                    HWY_ATTR { return hn::Load(F(), vectors + t * static_cast<std::ptrdiff_t>(kLanes)); },
                rows);
            skew_rows(shape_, Skew::kRising, rows, vectors);
        };
        for (std::size_t group = 0; group < shape_.groups; ++group) {
            const std::size_t at = shape_.at(step.index, group);
            clear_pads(rows);
            turn_one(distance_.of(step.worker) + at);
            if (sum_) turn_one(sum_.of(step.worker) + at);
        }
    }

    void store(const Step& step) {
        if (visibility_)
            for (std::size_t group = step.index; group < shape_.groups; group += kSlices)
                store_group(step, group);
        const std::size_t z = slice_of(step.slab, step.index);
        if (z == grid_.nz) return;
        float* const rows = rows_of(step);
        for (std::size_t group = 0; group < shape_.groups; ++group) {
            const std::size_t at = shape_.at(step.index, group);
            const std::size_t count = std::min(kLanes, grid_.ny - group * kLanes);
            const auto vector_of = [](const float* vectors) {
                return [vectors](std::ptrdiff_t t) HWY_ATTR {
                    return hn::Load(F(), vectors + t * static_cast<std::ptrdiff_t>(kLanes));
                };
            };
            unskew_rows(shape_, Skew::kRising, vector_of(distance_.of(step.worker) + at), rows);
            for (std::size_t l = 0; l < count; ++l) {
                const std::size_t y = group * kLanes + l;
                float* const out = job_.distance + grid_.index(0, y, z);
                if (down_)
                    finish_row(rows + l * shape_.row_stride, out);
                else
                    std::copy_n(rows + l * shape_.row_stride, grid_.nx, out);
            }
            if (sum_) {
                unskew_rows(shape_, Skew::kRising, vector_of(sum_.of(step.worker) + at), rows);
                for (std::size_t l = 0; l < count; ++l) {
                    float* const out = job_.combined + grid_.index(0, group * kLanes + l, z);
                    const float* const row = rows + l * shape_.row_stride;
                    for (std::size_t x = 0; x < grid_.nx; ++x)
                        out[x] = down_ ? std::max(0.0f, out[x] + row[x]) : row[x];
                }
            }
        }
    }

    void store_group(const Step& step, std::size_t group) const {
        OctantWords from{};
        from.group = group;
        for (std::size_t i = 0; i < 4; ++i) {
            from.octants[i] = octant_of(i);
            from.words[i] = words_of(step, group, i);
            from.slices[i] = slice_of(step.slab, i);
        }
        store_octants(grid_, shape_, from, rows_of(step), job_.octants);
    }
    // Vector 0 of an octant's words.
    std::uint32_t* words_of(const Step& step, std::size_t group, std::size_t index) const {
        const std::size_t layer = shape_.slice_stride * kLanes;
        return visibility_.of(step.worker) + index * layer + shape_.at(0, group);
    }

    // Sign, unit and cut-off.
    void finish_row(const float* row, float* out) const {
        const F f;
        const VF h = hn::Set(f, grid_.h()), far = hn::Set(f, kFar), band = hn::Set(f, job_.band);
        const VF none = hn::Set(f, std::numeric_limits<float>::infinity());
        const hn::RebindToSigned<F> i32;
        const VF bit = hn::BitCast(f, hn::Set(i32, kInsideBit));
        const auto finish = [&](std::size_t x) HWY_ATTR {
            const VF swept = hn::LoadU(f, row + x), units = hn::AndNot(bit, hn::Abs(swept));
            const VF sign = hn::BitCast(f, hn::ShiftLeft<31>(hn::BitCast(i32, swept)));
            const VF d = hn::Min(hn::IfThenElse(hn::Ge(units, far), none, hn::Mul(units, h)), band);
            return hn::Or(d, sign);
        };
        std::size_t x = 0;
        for (; x + kLanes <= grid_.nx; x += kLanes) hn::StoreU(finish(x), f, out + x);
        if (x < grid_.nx) {
            HWY_ALIGN float last[kLanes];
            hn::Store(finish(x), f, last);
            std::copy_n(last, grid_.nx - x, out + x);
        }
    }

    void clear_pads(float* rows) const {
        for (std::size_t l = 0; l < kLanes; ++l) {
            float* const row = rows + l * shape_.row_stride;
            std::fill_n(row - Shape::kPad, Shape::kPad, -kFar);
            std::fill_n(row + grid_.nx, Shape::kPad, -kFar);
        }
    }

    const DistanceJob& job_;
    const Grid grid_;
    const Shape shape_;
    LoadRow* const load_row_;
    const SlabPipeline<kStages> pipeline_;
    bool down_ = false;
    std::atomic<bool> finite_{true};
    Buffer<float> below_, dark_below_;
    WorkerBuffer<float> distance_, border_, rows_, samples_, dark_border_, sum_;
    WorkerBuffer<std::uint32_t> visibility_;
    std::array<bool, kMostWorkers> prepared_{};  // by worker: its buffers are
};

SweepResult sweep_distance(const DistanceJob& job) {
    return DistanceSweeps(job).run();
}

#else
SweepResult sweep_distance(const DistanceJob& job) {
    return sweep_distance_reference(job);
}
#endif

}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::volume {

HWY_EXPORT(sweep_distance);

DistanceFunction* distance_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(sweep_distance), targets, &sweep_distance_reference);
}

}  // namespace dfield::runtime::volume
#endif
