// The distance field in eight sweeps, with or without visibility carried along, in the skewed layout. The
// volume goes through it slab by slab, twice: up in z for sweeps 1 to 4, down for 5 to 8, a slab's four
// sweeps one after the other while it is in the cache. That is the order of the reference: sweep s of a slab
// reads, from the slab before, the slice as sweep s left it (kept aside), not as later sweeps did.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/sweep.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <type_traits>

#include "simd.hpp"
#include "volume/buffer.hpp"
#include "volume/distance_kernel-inl.hpp"
#include "volume/initialise-inl.hpp"
#include "volume/layout-inl.hpp"
#include "volume/sweep.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

// What happens to a slab in a pass, in this order. A step of the pipeline does stage i to slab k - i.
enum Stage : std::size_t { kLoad, kSweep0, kSweep1, kTurn, kSweep2, kSweep3, kStore, kStages };

class DistanceSweeps {
  public:
    explicit DistanceSweeps(const DistanceJob& job)
        : job_(job),
          grid_(job.grid),
          shape_(job.grid),
          load_row_(load_row_of(job.samples.type)),
          slabs_((job.grid.nz + kSlices - 1) / kSlices),
          parallel_(job.context->hooks.parallel_for != nullptr && slabs_ > 1),
          ring_(parallel_ ? std::min<std::size_t>(slabs_, kStages) : 1) {
        const std::size_t slab = shape_.slab_floats(), layer = shape_.slice_stride * kLanes;
        const bool light = job.carried != Carried::kNone;
        dfield_context* const context = job.context;
        distance_ = Buffer<float>(context, ring_ * slab, -kFar);
        below_ = Buffer<float>(context, 4 * layer);
        border_ = Buffer<float>(context, 4 * kSlices * row());
        rows_ = Buffer<float>(context, workers() * row_sets() * kLanes * shape_.row_stride, -kFar);
        samples_ = Buffer<float>(context, workers() * kSampleRows * row());
        if (light) {
            light_below_ = Buffer<float>(context, 4 * layer);
            light_border_ = Buffer<float>(context, 4 * kSlices * row());
        }
        if (job.carried == Carried::kOctants)
            visibility_ = Buffer<std::uint32_t>(context, 4 * ring_ * layer, 0);
        if (job.carried == Carried::kCombined) sum_ = Buffer<float>(context, ring_ * slab, 0);
    }

    SweepResult run() {
        for (down_ = false;; down_ = true) {
            std::fill_n(below_.get(), 4 * shape_.slice_stride * kLanes, kFar);
            if (light_below_) std::fill_n(light_below_.get(), 4 * shape_.slice_stride * kLanes, 1.0f);
            if (parallel_)
                run_pipeline();
            else
                for (std::size_t slab = 0; slab < slabs_; ++slab)
                    for (std::size_t stage = 0; stage < kStages; ++stage)
                        for (std::size_t part = 0; part < parts(stage); ++part) run_part(stage, slab, part);
            if (!finite_.load(std::memory_order_relaxed)) return SweepResult::kNotFinite;
            if (down_) return SweepResult::kDone;
        }
    }

  private:
    static constexpr std::size_t kSampleRows = 5;  // three rows of a slice, one of each beside it

    // Stages that work slice by slice are split.
    static bool is_sweep(std::size_t stage) { return stage != kLoad && stage != kTurn && stage != kStore; }
    static std::size_t parts(std::size_t stage) { return is_sweep(stage) ? 1 : kSlices; }
    static std::size_t first_worker(std::size_t stage) {
        return stage == kLoad ? 0 : stage == kTurn ? kSlices : 2 * kSlices;
    }
    std::size_t workers() const { return parallel_ ? 3 * kSlices : 1; }
    std::size_t row_sets() const { return job_.carried == Carried::kOctants ? 4 : 1; }
    std::size_t row() const { return Shape::row_size(grid_.nx); }

    void run_pipeline() {
        struct Part {
            std::size_t stage, part;
        };
        std::array<Part, 4 + 3 * kSlices> all;
        std::size_t count = 0;
        for (std::size_t stage = 0; stage < kStages; ++stage)  // the long ones first
            if (is_sweep(stage)) all[count++] = {stage, 0};
        for (std::size_t stage = 0; stage < kStages; ++stage)
            if (!is_sweep(stage))
                for (std::size_t part = 0; part < kSlices; ++part) all[count++] = {stage, part};
        for (std::size_t step = 0; step < slabs_ + kStages - 1; ++step)
            job_.context->for_ranges(count, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i)
                    if (step >= all[i].stage && step - all[i].stage < slabs_)
                        run_part(all[i].stage, step - all[i].stage, all[i].part);
            });
    }

    void run_part(std::size_t stage, std::size_t slab, std::size_t part) {
        switch (stage) {
            case kLoad:
                return load(slab, part);
            case kTurn:
                return turn(slab, part);
            case kStore:
                return store(slab, part);
            default: {
                const std::size_t index = stage < kTurn ? stage - kSweep0 : stage - kSweep2 + 2;
                if (grid_.isotropic()) return sweep<UnitEikonal>(slab, index);
                return sweep<Eikonal>(slab, index);
            }
        }
    }

    static Skew skew_of(std::size_t octant) {
        return kSweeps[octant].x == kSweeps[octant].y ? Skew::kFalling : Skew::kRising;
    }
    // The slice that part `part` of a slab is in this pass, or nz where there is none.
    std::size_t slice_of(std::size_t slab, std::size_t part) const {
        const std::size_t k = slab * kSlices + part;
        return k >= grid_.nz ? grid_.nz : down_ ? grid_.nz - 1 - k : k;
    }
    std::size_t offset_of(std::size_t slab) const { return slab % ring_ * shape_.slab_floats(); }
    // Row buffers of a task: x = 0 of the first row of a set.
    float* rows_of(std::size_t stage, std::size_t part, std::size_t set = 0) const {
        const std::size_t worker = parallel_ ? first_worker(stage) + part : 0;
        return rows_ + (row_sets() * worker + set) * kLanes * shape_.row_stride + Shape::kPad;
    }
    float* sample_rows(std::size_t part) const {
        return samples_ + (parallel_ ? part : 0) * kSampleRows * row() + Shape::kPad;
    }

    void load(std::size_t slab, std::size_t part) {
        const std::size_t z = slice_of(slab, part);
        float* const rows = rows_of(kLoad, part);
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
                    initialise(y, z, sample_rows(part), row);
            }
            clear_pads(rows);  // the last vectors of rows went beyond them
            const std::size_t at = offset_of(slab) + shape_.at(part, group);
            skew_rows(shape_, Skew::kFalling, rows, distance_ + at);
            if (sum_) std::fill_n(sum_ + at, 4 * shape_.blocks * kLanes, 0.0f);
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
    void sweep(std::size_t slab, std::size_t index) {
        const std::size_t octant = kSweepOrder[(down_ ? 4 : 0) + index];
        if (job_.carried == Carried::kOctants) return sweep_rows<Carried::kOctants, Solver>(slab, index);
        if (job_.carried == Carried::kCombined && job_.intensities[octant] != 0)
            return sweep_rows<Carried::kCombined, Solver>(slab, index);
        return sweep_rows<Carried::kNone, Solver>(slab, index);
    }

    template<Carried kCarried, class Solver>
    void sweep_rows(std::size_t slab, std::size_t index) {
        const std::size_t octant = kSweepOrder[(down_ ? 4 : 0) + index];
        const Sweep& direction = kSweeps[octant];
        const Solver solver(grid_);
        GroupSweep s;
        s.vectors = static_cast<std::ptrdiff_t>(shape_.vectors);
        s.ascending = direction.x > 0;
        s.falling = skew_of(octant) == Skew::kFalling;
        s.slice_stride = static_cast<std::ptrdiff_t>(shape_.slice_stride * kLanes);
        s.border_stride = static_cast<std::ptrdiff_t>(row());
        s.border = border_ + index * kSlices * row() + Shape::kPad;
        s.nx = grid_.nx;
        std::fill_n(s.border - Shape::kPad, kSlices * row(), kFar);
        if constexpr (kCarried != Carried::kNone) {
            s.light_border = light_border_ + index * kSlices * row() + Shape::kPad;
            std::fill_n(s.light_border - Shape::kPad, kSlices * row(), 1.0f);
            s.intensity = job_.intensities[octant];
        }
        const bool upward = direction.y > 0;
        for (std::size_t i = 0; i < shape_.groups; ++i) {
            const std::size_t group = upward ? i : shape_.groups - 1 - i;
            const std::size_t at = offset_of(slab) + shape_.at(0, group);
            const std::size_t layer = index * shape_.slice_stride * kLanes + shape_.at(0, group);
            s.rows = std::min(kLanes, grid_.ny - group * kLanes);
            s.distance = distance_ + at;
            s.below = below_ + layer;
            if constexpr (kCarried != Carried::kNone) {
                s.alpha = job_.alpha;
                s.light_below = light_below_ + layer;
            }
            if constexpr (kCarried == Carried::kOctants)
                s.visibility = visibility_ + index * ring_ * shape_.slice_stride * kLanes +
                               offset_of(slab) / kSlices + shape_.at(0, group);
            if constexpr (kCarried == Carried::kCombined) s.sum = sum_ + at;
            if (upward)
                sweep_group<true, kCarried>(s, solver);
            else
                sweep_group<false, kCarried>(s, solver);
        }
    }

    // From the layout of sweeps (+,+) and (-,-) to that of (+,-) and (-,+).
    void turn(std::size_t slab, std::size_t part) {
        if (slice_of(slab, part) == grid_.nz) return;
        float* const rows = rows_of(kTurn, part);
        const auto turn_one = [&](float* vectors) {
            unskew_rows(
                shape_, Skew::kFalling,
                [&](std::ptrdiff_t t)
                    HWY_ATTR { return hn::Load(F(), vectors + t * static_cast<std::ptrdiff_t>(kLanes)); },
                rows);
            skew_rows(shape_, Skew::kRising, rows, vectors);
        };
        for (std::size_t group = 0; group < shape_.groups; ++group) {
            const std::size_t at = offset_of(slab) + shape_.at(part, group);
            clear_pads(rows);
            turn_one(distance_ + at);
            if (sum_) turn_one(sum_ + at);
        }
    }

    void store(std::size_t slab, std::size_t part) {
        if (visibility_)
            for (std::size_t group = part; group < shape_.groups; group += kSlices)
                store_octants(slab, group, part);
        const std::size_t z = slice_of(slab, part);
        if (z == grid_.nz) return;
        float* const rows = rows_of(kStore, part);
        for (std::size_t group = 0; group < shape_.groups; ++group) {
            const std::size_t at = offset_of(slab) + shape_.at(part, group);
            const std::size_t count = std::min(kLanes, grid_.ny - group * kLanes);
            const auto vector_of = [](const float* vectors) {
                return [vectors](std::ptrdiff_t t) HWY_ATTR {
                    return hn::Load(F(), vectors + t * static_cast<std::ptrdiff_t>(kLanes));
                };
            };
            unskew_rows(shape_, Skew::kRising, vector_of(distance_ + at), rows);
            for (std::size_t l = 0; l < count; ++l) {
                const std::size_t y = group * kLanes + l;
                float* const out = job_.distance + grid_.index(0, y, z);
                if (down_)
                    finish_row(rows + l * shape_.row_stride, out);
                else
                    std::copy_n(rows + l * shape_.row_stride, grid_.nx, out);
            }
            if (sum_) {
                unskew_rows(shape_, Skew::kRising, vector_of(sum_ + at), rows);
                for (std::size_t l = 0; l < count; ++l) {
                    float* const out = job_.combined + grid_.index(0, group * kLanes + l, z);
                    const float* const row = rows + l * shape_.row_stride;
                    for (std::size_t x = 0; x < grid_.nx; ++x) out[x] = down_ ? out[x] + row[x] : row[x];
                }
            }
        }
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

    // The four octants of this pass as one word a voxel, from words of four slices.
    void store_octants(std::size_t slab, std::size_t group, std::size_t part) {
        const F f;
        const hn::RebindToUnsigned<F> u32;
        const std::size_t at = offset_of(slab) / kSlices + shape_.at(0, group);
        const std::size_t field = ring_ * shape_.slice_stride * kLanes;
        std::array<const float*, 4> rows;
        std::array<std::size_t, 4> channel;
        std::array<std::ptrdiff_t, 4> lag;  // in x, of a slice against the one before
        for (std::size_t index = 0; index < 4; ++index) {
            const std::size_t octant = kSweepOrder[(down_ ? 4 : 0) + index];
            const std::uint32_t* const words = visibility_ + index * field + at;
            float* const to = rows_of(kStore, part, index);
            unskew_rows(
                shape_, skew_of(octant),
                [&](std::ptrdiff_t t) HWY_ATTR {
                    return hn::BitCast(f, hn::Load(u32, words + t * static_cast<std::ptrdiff_t>(kLanes)));
                },
                to, true);
            rows[index] = to;
            channel[index] = octant % 4;
            lag[index] = kSweeps[octant].x;
        }
        std::uint8_t* const volume = job_.octants + (down_ ? 4 * grid_.size() : 0);
        const std::size_t count = std::min(kLanes, grid_.ny - group * kLanes);
        for (std::size_t slice = 0; slice < kSlices; ++slice) {
            const std::size_t z = slice_of(slab, slice);
            if (z == grid_.nz) break;
            for (std::size_t l = 0; l < count; ++l) {
                std::array<const std::uint32_t*, 4> from;  // by channel
                for (std::size_t index = 0; index < 4; ++index)
                    from[channel[index]] = reinterpret_cast<const std::uint32_t*>(
                        rows[index] + l * shape_.row_stride +
                        lag[index] * static_cast<std::ptrdiff_t>(slice));
                const auto merged = [&](std::size_t x) HWY_ATTR {
                    auto word = hn::Zero(u32);
                    for (std::size_t c = 0; c < 4; ++c) {
                        const auto mask = hn::Set(u32, 0xffu << 8 * c);
                        auto v = hn::LoadU(u32, from[c] + x);
                        v = c > slice ? hn::ShiftLeftSame(v, static_cast<int>(8 * (c - slice)))
                                      : hn::ShiftRightSame(v, static_cast<int>(8 * (slice - c)));
                        word = hn::OrAnd(word, v, mask);
                    }
                    return word;
                };
                stream_words(grid_.nx, merged, volume + 4 * grid_.index(0, group * kLanes + l, z));
            }
        }
    }

    // Writes word(x), vectors of four bytes a voxel, past the cache: nobody reads them soon.
    template<class Word>
    static HWY_INLINE void stream_words(std::size_t n, const Word& word, std::uint8_t* out) {
        const hn::Repartition<std::uint8_t, F> bytes;
        constexpr std::size_t kBytes = 4 * kLanes;
        const auto some = [&](std::size_t x, std::size_t count) HWY_ATTR {
            HWY_ALIGN std::uint8_t words[kBytes];
            hn::Store(hn::BitCast(bytes, word(x)), bytes, words);
            std::copy_n(words, 4 * count, out + 4 * x);
        };
        // The rows of a dense volume begin anywhere; vectors are streamed from the first cache line on.
        const std::size_t misaligned = reinterpret_cast<std::uintptr_t>(out) % kBytes;
        std::size_t x = 0;
        if (misaligned % 4 == 0) {
            x = std::min(n, misaligned == 0 ? 0 : (kBytes - misaligned) / 4);
            if (x > 0) some(0, x);
            for (; x + kLanes <= n; x += kLanes) hn::Stream(hn::BitCast(bytes, word(x)), bytes, out + 4 * x);
        }
        for (; x < n; x += kLanes) some(x, std::min(kLanes, n - x));
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
    const std::size_t slabs_;
    const bool parallel_;
    const std::size_t ring_;  // slabs in flight
    bool down_ = false;
    std::atomic<bool> finite_{true};
    Buffer<float> distance_, below_, border_, rows_, samples_, light_below_, light_border_, sum_;
    Buffer<std::uint32_t> visibility_;
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
