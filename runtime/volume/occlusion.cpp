// The improved form in the skewed layout, slab by slab as the distances are swept (sweep.cpp): up in z for
// octants 0 to 3, down for 4 to 7.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/occlusion.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "simd.hpp"
#include "volume/buffer.hpp"
#include "volume/layout-inl.hpp"
#include "volume/occlusion.hpp"
#include "volume/occlusion_kernel-inl.hpp"
#include "volume/octant_words-inl.hpp"
#include "volume/off_surface-inl.hpp"
#include "volume/pipeline.hpp"
#include "volume/row_gradient-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

class OcclusionSweeps {
    enum Stage : std::size_t { kLoad, kSweep0, kSweep1, kSweep2, kSweep3, kStore, kMove, kStages };

  public:
    explicit OcclusionSweeps(const OcclusionJob& job)
        : job_(job),
          grid_(job.grid),
          pair_(job.grid, kPairRows, (job.grid.ny + kPairRows - 1) / kPairRows, kSlices),
          shape_(job.grid, kLanes, 2 * pair_.groups, kSlices + kLanes),
          lit_(std::any_of(job.intensities.begin(), job.intensities.end(), [](float i) { return i != 1; })),
          brightest_(*std::max_element(job.intensities.begin(), job.intensities.end())),
          pipeline_(job.context, slabs(),
                    {{{kSlices, false},
                      {pair_.groups, true},
                      {pair_.groups, true},
                      {pair_.groups, true},
                      {pair_.groups, true},
                      {kSlices, false},
                      {kSlices, true}}}),
          off_surface_(job.grid, job.distance) {
        dfield_context* const context = job.context;
        const std::size_t workers = pipeline_.workers();
        for (std::size_t i = 0; i < 2; ++i) {
            vertices_[i] = WorkerBuffer<std::uint32_t>(context, workers, shape_.slab_floats(), kOpenVertex);
            if (has_sums()) sums_[i] = WorkerBuffer<std::int16_t>(context, workers, 2 * pair_.slab_floats());
        }
        if (moves()) swept_ = Buffer<float>(context, kept_slices() * grid_.nx * grid_.ny);
        below_ = Buffer<std::int16_t>(context, 4 * job.ordinates * 2 * pair_.layer());
        border_ = WorkerBuffer<std::int16_t>(context, workers, job.ordinates * kSlices * border_size());
        rows_ = WorkerBuffer<float>(context, workers, kRowSets * kLanes * shape_.row_stride);
        if (job.octants) visibility_ = WorkerBuffer<std::uint32_t>(context, workers, 4 * shape_.layer());
    }

    void run() {
        for (const bool down : {false, true}) {
            down_ = down;
            std::fill_n(below_.get(), 4 * job_.ordinates * 2 * pair_.layer(), std::int16_t{0});
            pipeline_.run([this](std::size_t worker, std::size_t slab, std::size_t stage, std::size_t index) {
                const Step step{worker, slab, index};
                if (stage == kLoad && index == 0) prepare(worker);
                if (stage == kLoad)
                    load(step);
                else if (stage == kStore)
                    store(step);
                else if (stage != kMove)
                    sweep(step, stage - kSweep0);
                else if (down_ && moves())
                    move(step);
            });
        }
    }

  private:
    static constexpr std::size_t kRowSets = 4;
    // Before x = 0 and after x = nx - 1 of what a pair leaves for the next: its rows' skew and a slice's lag.
    static constexpr std::size_t kBorderPad = kPairRows + 2 * kSlices;
    static_assert(2 * OffSurface::kReach <= kSlices);

    struct Step {
        std::size_t worker, slab, index;  // of a slice of the slab, or of a pair of groups in a sweep's order
    };

    std::size_t slabs() const { return (job_.grid.nz + kSlices - 1) / kSlices; }
    // The kernel for spacings that differ always makes sums.
    bool has_sums() const { return job_.visibility || !grid_.isotropic(); }
    bool moves() const { return job_.visibility && job_.off_surface; }
    // Slices of swept visibility that wait to be moved off the surface, by the order in which the second pass
    // meets them: a slab is moved with the one before, while other workers store the next ones.
    std::size_t kept_slices() const { return (pipeline_.workers() + 1) * kSlices; }
    float* kept(std::size_t z) const {
        return swept_ + (grid_.nz - 1 - z) % kept_slices() * grid_.nx * grid_.ny;
    }
    std::size_t border_size() const { return grid_.nx + 2 * kBorderPad; }
    float* rows_of(const Step& step) const { return rows_.of(step.worker) + Shape::kPad; }
    std::size_t slice_of(std::size_t slab, std::size_t slice) const {
        const std::size_t k = slab * kSlices + slice;
        return k >= grid_.nz ? grid_.nz : down_ ? grid_.nz - 1 - k : k;
    }
    std::size_t octant_of(std::size_t index) const { return (down_ ? 4 : 0) + index; }
    std::uint32_t* words_of(const Step& step, std::size_t group, std::size_t index) const {
        return visibility_.of(step.worker) + index * shape_.layer() + shape_.at(0, group);
    }
    // Vector 0 of a pair in a slice.
    std::int16_t* sums_of(Skew skew, const Step& step, std::size_t slice, std::size_t pair) const {
        return sums_[static_cast<std::size_t>(skew)].of(step.worker) + 2 * pair_.at(slice, pair);
    }
    // A pair's rows are skewed as one: by so many vectors do its lower (0) and upper (1) group's come after.
    static std::size_t lag_of(Skew skew, std::size_t half) {
        return half == (skew == Skew::kFalling ? 1 : 0) ? kLanes : 0;
    }

    void prepare(std::size_t worker) {
        if (std::exchange(prepared_[worker], true)) return;
        for (std::size_t i = 0; i < 2; ++i) {
            vertices_[i].prepare(worker);
            sums_[i].prepare(worker);
        }
        border_.prepare(worker);
        rows_.prepare(worker);
        visibility_.prepare(worker);
    }

    void load(const Step& step) {
        const std::size_t z = slice_of(step.slab, step.index);
        float* const rows = rows_of(step);
        for (std::size_t group = 0; group < shape_.groups; ++group) {
            for (std::size_t l = 0; l < kLanes; ++l) {
                const std::size_t y = group * kLanes + l;
                auto* const row = reinterpret_cast<std::uint32_t*>(rows + l * shape_.row_stride);
                std::fill_n(row - Shape::kPad, Shape::kPad, kOpenVertex);
                std::fill_n(row + grid_.nx, Shape::kPad, kOpenVertex);
                if (z == grid_.nz || y >= grid_.ny)
                    std::fill_n(row, grid_.nx, kOpenVertex);
                else
                    load_row(y, z, row);
            }
            const std::size_t at = shape_.at(step.index, group);
            for (const Skew skew : {Skew::kFalling, Skew::kRising})
                skew_rows(
                    shape_, skew, rows,
                    reinterpret_cast<float*>(vertices_[static_cast<std::size_t>(skew)].of(step.worker) + at));
        }
    }

    // A row's words. Made in both passes: keeping them costs as much time, and a word a voxel.
    void load_row(std::size_t y, std::size_t z, std::uint32_t* out) const {
        const RowGradient row(grid_, job_.distance, y, z);
        // Copies, which stores through `out` cannot change.
        const float per_h = 1 / grid_.h(), thin = job_.thin, shift = job_.shift, darkest = 255 * job_.alpha;
        row.for_vertices([&](auto tag, std::size_t x) HWY_ATTR {
            const hn::RebindToUnsigned<decltype(tag)> u32;
            const auto g = row.at(tag, x);
            const auto some = hn::Gt(g.square, hn::Zero(tag));
            const auto inverse = hn::IfThenElseZero(some, hn::ApproximateReciprocalSqrt(g.square));
            const auto scale = hn::Mul(inverse, hn::Set(tag, kNormalScale));
            // Added to 3 * 2^22, a number's last bits are its nearest integer's, negative ones too.
            const auto magic = hn::Set(tag, 0x3p22f);
            const auto component = [&](auto along) HWY_ATTR {
                return hn::BitCast(u32, hn::MulAdd(hn::IfThenElseZero(some, along), scale, magic));
            };
            const auto d = hn::LoadU(tag, row.here() + x);
            const auto length = hn::IfThenElseZero(some, hn::Mul(g.square, inverse));
            const auto deeper = hn::IfThenElseZero(
                hn::Le(d, hn::Zero(tag)), hn::Max(hn::Sub(hn::Set(tag, 1.0f), length), hn::Zero(tag)));
            const auto tau = hn::MulAdd(d, hn::Set(tag, per_h),
                                        hn::NegMulAdd(deeper, hn::Set(tag, thin), hn::Set(tag, shift)));
            const auto opacity =
                hn::Sub(hn::Set(tag, 1.0f), hn::Clamp(tau, hn::Zero(tag), hn::Set(tag, 1.0f)));
            const auto dark =
                hn::BitCast(u32, hn::MulAdd(opacity, hn::Set(tag, darkest), hn::Set(tag, 0x3p22f)));
            auto word = component(g.z);
            for (const auto& byte : {component(g.y), component(g.x), dark})
                word = select_bits(hn::Set(u32, 0xff), byte, hn::ShiftLeft<8>(word));
            hn::StoreU(word, u32, out + x);
        });
    }

    bool is_swept(std::size_t index) const {
        const std::size_t octant = octant_of(index);
        return (job_.intensities[octant] != 0 || job_.octants) &&
               (job_.only == kOctants || job_.only == octant);
    }
    // Whether octant `index` of this pass, or one before it, has sums in this layout.
    bool has_sums(Skew skew, std::size_t index) const {
        for (std::size_t i = 0; i <= index; ++i)
            if (skew_of(octant_of(i)) == skew && is_swept(i)) return true;
        return false;
    }

    void sweep(const Step& step, std::size_t index) {
        if (!is_swept(index)) return;
        const float intensity = job_.intensities[octant_of(index)];
        if (job_.ordinates == 1)
            sweep_rows<1>(step, index, intensity);
        else if (job_.ordinates == 3)
            sweep_rows<3>(step, index, intensity);
        else
            sweep_rows<6>(step, index, intensity);
    }

    template<std::size_t kOrdinates>
    void sweep_rows(const Step& step, std::size_t index, float intensity) {
        const std::size_t octant = octant_of(index);
        const Skew skew = skew_of(octant);
        OrdinateSweep s;
        s.direction = kSweeps[octant];
        s.vectors = static_cast<std::ptrdiff_t>(pair_.vectors);
        s.ascending = s.direction.x > 0;
        s.vertices_stride = static_cast<std::ptrdiff_t>(shape_.layer());
        s.sum_stride = static_cast<std::ptrdiff_t>(2 * pair_.layer());
        constexpr std::size_t kLeft = kOrdinates * kSlices;
        std::int16_t* const border = border_.of(step.worker);
        if (step.index == 0) std::fill_n(border, kLeft * border_size(), std::int16_t{0});
        s.border = border + kLeft * kBorderPad;
        s.ordinates = ordinates_of(octant, kOrdinates);
        for (std::size_t i = 0; i < kOrdinates; ++i) s.weights[i] = weights_of(s.ordinates[i], grid_);
        s.cubic = grid_.isotropic();
        const float share = brightest_ > 0 ? intensity / brightest_ : 0;
        s.weight = share / (static_cast<float>(kOctants * kOrdinates) * (job_.through ? 0.5f : 0.25f));
        s.lit = lit_;
        s.through = job_.through;
        s.first = index == 0 || !has_sums(skew, index - 1);
        const bool upward = s.direction.y > 0;
        const std::size_t pair = upward ? step.index : pair_.groups - 1 - step.index;
        for (std::size_t half = 0; half < 2; ++half) {
            const std::size_t group = 2 * pair + half, lag = lag_of(skew, half) * kLanes;
            s.vertices[half] =
                vertices_[static_cast<std::size_t>(skew)].of(step.worker) + shape_.at(0, group) - lag;
            if (visibility_) s.visibility[half] = words_of(step, group, index) - lag;
        }
        if (has_sums()) s.sum = sums_of(skew, step, 0, pair);
        s.below = below_ +
                  static_cast<std::ptrdiff_t>(2 * kOrdinates * (index * pair_.layer() + pair_.at(0, pair)));
        if (upward)
            sweep_ordinates<true, kOrdinates>(s);
        else
            sweep_ordinates<false, kOrdinates>(s);
    }

    void store(const Step& step) {
        if (visibility_)
            for (std::size_t group = step.index; group * kLanes < grid_.ny; group += kSlices) {
                OctantWords from{};
                from.group = group;
                for (std::size_t i = 0; i < 4; ++i) {
                    from.octants[i] = octant_of(i);
                    from.words[i] = words_of(step, group, i);
                    from.slices[i] = slice_of(step.slab, i);
                }
                store_octants(grid_, shape_, from, rows_of(step), job_.octants);
            }
        const std::size_t z = slice_of(step.slab, step.index);
        if (z == grid_.nz || !job_.visibility) return;
        float* const rows = rows_of(step);
        float* const rising = rows + kLanes * shape_.row_stride;
        for (std::size_t group = 0; group * kLanes < grid_.ny; ++group) {
            for (const Skew skew : {Skew::kFalling, Skew::kRising}) {
                float* const to = skew == Skew::kFalling ? rows : rising;
                if (has_sums(skew, 3))
                    unskew_sums(skew, step, group, to);
                else
                    std::fill_n(to - Shape::kPad, kLanes * shape_.row_stride, 0.0f);
            }
            for (std::size_t l = 0; l < std::min(kLanes, grid_.ny - group * kLanes); ++l) {
                const std::size_t y = group * kLanes + l;
                float* const visibility = job_.visibility + grid_.index(0, y, z);
                add_row(rows + l * shape_.row_stride, rising + l * shape_.row_stride, visibility,
                        down_ && moves() ? kept(z) + y * grid_.nx : visibility);
            }
        }
    }

    // A group's sums, in rows.
    void unskew_sums(Skew skew, const Step& step, std::size_t group, float* rows) const {
        const I32 i32;
        const std::size_t half = group % 2;
        const auto* const sums =
            reinterpret_cast<const std::int32_t*>(sums_of(skew, step, step.index, group / 2)) +
            lag_of(skew, half) * kLanes;
        const VF scale = hn::Set(F(), brightest_ / kOne);
        unskew_rows(
            shape_, skew,
            [&](std::ptrdiff_t t) HWY_ATTR {
                VI both = hn::Load(i32, sums + t * static_cast<std::ptrdiff_t>(kLanes));
                if (half == 0) both = hn::ShiftLeft<16>(both);
                return hn::Mul(hn::ConvertTo(F(), hn::ShiftRight<16>(both)), scale);
            },
            rows);
    }

    // Both layouts' sums, and in the second pass the first one's, to visibility.
    void add_row(const float* a, const float* b, const float* before, float* out) const {
        const auto row = [&](const auto& finish) {
            for (std::size_t x = 0; x < grid_.nx; ++x) out[x] = finish(before[x], a[x] + b[x]);
        };
        if (!down_)
            row([](float, float sum) { return sum; });
        else if (lit_)
            row([](float first, float sum) { return first + sum; });
        else
            row([](float first, float sum) { return std::max(0.0f, 1 - (first + sum)); });
    }

    // The slices that the second pass met kReach before this slab's, which now have all their neighbours.
    void move(const Step& step) const {
        const std::size_t met = step.slab * kSlices + step.index;
        if (met >= OffSurface::kReach) move_slice(met - OffSurface::kReach);
        if (step.slab + 1 == slabs() && step.index < OffSurface::kReach)
            move_slice(met + kSlices - OffSurface::kReach);
    }
    void move_slice(std::size_t met) const {
        if (met >= grid_.nz) return;
        const std::size_t z = grid_.nz - 1 - met;
        OffSurface::Slices slices{};
        for (std::size_t i = 0; i < slices.size(); ++i)
            if (z + i >= OffSurface::kReach && z + i < grid_.nz + OffSurface::kReach)
                slices[i] = kept(z + i - OffSurface::kReach);
        for (std::size_t y = 0; y < grid_.ny; ++y)
            off_surface_.move_row(y, z, slices, job_.visibility + grid_.index(0, y, z));
    }

    const OcclusionJob& job_;
    const Grid grid_;
    const Shape pair_, shape_;  // of sums and what passes between vertices, and of all else
    const bool lit_;
    const float brightest_;  // intensity
    const SlabPipeline<kStages> pipeline_;
    const OffSurface off_surface_;
    bool down_ = false;
    std::array<WorkerBuffer<std::uint32_t>, 2> vertices_;  // by Skew
    std::array<WorkerBuffer<std::int16_t>, 2> sums_;
    Buffer<std::int16_t> below_;
    WorkerBuffer<std::int16_t> border_;
    WorkerBuffer<float> rows_;
    Buffer<float> swept_;
    WorkerBuffer<std::uint32_t> visibility_;
    std::array<bool, kMostWorkers> prepared_{};  // by worker: its buffers are
};

void sweep_occlusion(const OcclusionJob& job) {
    OcclusionSweeps(job).run();
}

#else
void sweep_occlusion(const OcclusionJob& job) {
    sweep_occlusion_reference(job);
}
#endif

}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::volume {

HWY_EXPORT(sweep_occlusion);

OcclusionFunction* occlusion_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(sweep_occlusion), targets, &sweep_occlusion_reference);
}

}  // namespace dfield::runtime::volume
#endif
