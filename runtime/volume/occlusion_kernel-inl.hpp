// One diagonal sweep of the improved form's fields through a group of rows and kSlices slices. Included once
// a target.
#if defined(DFIELD_VOLUME_OCCLUSION_KERNEL_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_VOLUME_OCCLUSION_KERNEL_INL_HPP
#undef DFIELD_VOLUME_OCCLUSION_KERNEL_INL_HPP
#else
#define DFIELD_VOLUME_OCCLUSION_KERNEL_INL_HPP
#endif

#include <hwy/highway.h>

#include "volume/layout-inl.hpp"
#include "volume/occlusion.hpp"
#include "volume/octant_words-inl.hpp"
#include "volume/row_order-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

// A vertex as these sweeps see it, one word: the transmittance times 255 in the lowest byte, above it the
// normal times 127, x, y and z as signed bytes. Beyond the grid it is open: light comes in unchanged.
constexpr float kNormalScale = 127;
constexpr std::uint32_t kOpenVertex = 255;

struct OrdinateSweep {
    std::ptrdiff_t vectors = 0;
    bool ascending = true;
    std::ptrdiff_t slice_stride = 0;  // vectors' elements
    const std::uint32_t* vertices = nullptr;
    float* sum = nullptr;                 // sum of term (1 - V), or of term V where `lit`; null: not wanted
    bool first = false;                   // begin the sums
    std::uint32_t* visibility = nullptr;  // words for store_octants, or null
    // 1 - V tau of each ordinate: of the slab before and of the group before.
    float* below = nullptr;
    std::ptrdiff_t below_stride = 0;  // to the next ordinate's
    float* border = nullptr;
    std::ptrdiff_t border_stride = 0;  // to the next slice's; kSlices of them to the next ordinate's
    std::array<Ordinate, kMaxOrdinates> ordinates{};
    Sweep direction{};
    float weight = 1;  // of the geometry term: 1 for an open sky of intensity 1
    bool lit = false;  // intensities other than 1
    bool through = false;
};

// What a kernel is made for: an evenly lit visibility volume alone, octants alone, or anything.
enum class Wanted { kVisibility, kOctants, kAnything };

template<bool kUpward, std::size_t kOrdinates, Wanted kWanted>
class OrdinateKernel {
  public:
    HWY_INLINE explicit OrdinateKernel(const OrdinateSweep& sweep)
        : s_(sweep),
          order_(),
          direction_(sweep.ascending ? 1 : -1),
          start_(sweep.ascending ? 0 : sweep.vectors - 1),
          enters_(sweep.ascending ? 0 : kN - 1),
          leaves_(kN - 1 - enters_ + direction_),
          least_(hn::Set(F(), sweep.through ? -1.0f : 0.0f)),
          at_dark_(hn::Set(F(), sweep.lit ? 1.0f : 0.0f)),
          per_dark_(hn::Set(F(), sweep.lit ? -1.0f : 1.0f)) {
        for (std::size_t t = 0; t < kTriples; ++t) {
            const Ordinate& w = sweep.ordinates[3 * t];
            const float weights[3] = {w.x, w.y, w.z};
            const float scale = -sweep.weight / (kNormalScale * std::sqrt(w.x * w.x + w.y * w.y + w.z * w.z));
            for (std::size_t i = 0; i < 3; ++i) {
                weight_[t][i] = hn::Set(F(), weights[i]);
                cosine_x_[t][i] = hn::Set(F(), weights[i] * scale * static_cast<float>(sweep.direction.x));
                cosine_y_[t][i] = hn::Set(F(), weights[i] * scale * static_cast<float>(sweep.direction.y));
                cosine_z_[t][i] = hn::Set(F(), weights[i] * scale * static_cast<float>(sweep.direction.z));
            }
        }
        for (auto& slice : dark_)
            for (VF& ordinate : slice) ordinate = hn::Zero(F());
    }

    HWY_INLINE void run() {
        for (std::ptrdiff_t i = 0; i < s_.vectors + kS; ++i) {
#pragma GCC unroll 4
            for (std::ptrdiff_t p = kS - 1; p >= 0; --p) vertex(p, start_ + direction_ * (i - p));
        }
    }

  private:
    static constexpr std::ptrdiff_t kN = kLanes, kS = kSlices;
    static constexpr bool kSums = kWanted != Wanted::kOctants, kBytes = kWanted != Wanted::kVisibility;
    // Ordinates come in threes, the cyclic permutations of one: few weights have to stay in registers.
    static constexpr std::size_t kTriples = (kOrdinates + 2) / 3;

    HWY_INLINE void vertex(std::ptrdiff_t p, std::ptrdiff_t t) {
        const F f;
        const I32 i32;
        const std::ptrdiff_t voxel = p * s_.slice_stride + t * kN;
        const auto word = hn::BitCast(i32, hn::Load(U32(), s_.vertices + voxel));
        const VF tau = hn::Mul(hn::ConvertTo(f, hn::And(word, hn::Set(i32, 0xff))), hn::Set(f, 1.0f / 255));
        const VF opacity = hn::Sub(hn::Set(f, 1.0f), tau);
        VF nx = hn::Zero(f), ny = nx, nz = nx, sum = nx, darkness = nx;
        if constexpr (kSums) {
            nx = hn::ConvertTo(f, hn::ShiftRight<24>(hn::ShiftLeft<16>(word)));
            ny = hn::ConvertTo(f, hn::ShiftRight<24>(hn::ShiftLeft<8>(word)));
            nz = hn::ConvertTo(f, hn::ShiftRight<24>(word));
            if (!s_.first) sum = hn::Load(f, s_.sum + voxel);
        }
#pragma GCC unroll 6
        for (std::size_t o = 0; o < kOrdinates; ++o) {
            float* const border =
                s_.border + (static_cast<std::ptrdiff_t>(o) * kS + p) * s_.border_stride + t;
            float* const below = s_.below + static_cast<std::ptrdiff_t>(o) * s_.below_stride + t * kN;
            const VF dx = dark_[p][o], dy = order_.previous_row(dx, border - leaves_, border - enters_);
            const VF dz = p > 0 ? dark_[p > 0 ? p - 1 : 0][o] : hn::Load(f, below);
            const std::size_t triple = o / 3, x = (3 - o % 3) % 3, y = (x + 1) % 3, z = (x + 2) % 3;
            // Equation 6 for u = 1 - V, and 1 - V tau = (1 - tau) + tau u.
            const VF u = hn::MulAdd(weight_[triple][x], dx,
                                    hn::MulAdd(weight_[triple][y], dy, hn::Mul(weight_[triple][z], dz)));
            dark_[p][o] = hn::MulAdd(tau, u, opacity);
            if (p == kS - 1) hn::Store(dark_[p][o], f, below);
            if constexpr (kBytes) darkness = hn::Add(darkness, u);
            if constexpr (kSums) {
                const VF cosine =
                    hn::MulAdd(cosine_x_[triple][x], nx,
                               hn::MulAdd(cosine_y_[triple][y], ny, hn::Mul(cosine_z_[triple][z], nz)));
                if constexpr (kWanted == Wanted::kVisibility)
                    sum = hn::MulAdd(hn::Max(cosine, hn::Zero(f)), u, sum);
                else
                    sum = hn::MulAdd(hn::Max(cosine, hn::Mul(least_, cosine)),
                                     hn::MulAdd(u, per_dark_, at_dark_), sum);
            }
        }
        if constexpr (kSums) hn::Store(sum, f, s_.sum + voxel);
        if constexpr (kBytes) {
            const VF mean = hn::NegMulAdd(darkness, hn::Set(f, 1.0f / kOrdinates), hn::Set(f, 1.0f));
            bytes_.push(mean, hn::Set(f, 255.0f));
            if (p == 0 && s_.visibility) hn::Store(bytes_.word, U32(), s_.visibility + t * kN);
        }
    }

    const OrdinateSweep s_;
    const RowOrder<kUpward> order_;
    const std::ptrdiff_t direction_, start_, enters_, leaves_;  // as GroupKernel's
    const VF least_, at_dark_, per_dark_;
    // Ordinate o of a triple has its weights from -o on, cyclically; times the geometry term's weight, of the
    // normal's bytes, for cosines.
    VF weight_[kTriples][3], cosine_x_[kTriples][3], cosine_y_[kTriples][3], cosine_z_[kTriples][3];
    VF dark_[kSlices][kOrdinates];
    SliceBytes bytes_;
};

template<bool kUpward, std::size_t kOrdinates>
void sweep_ordinates(const OrdinateSweep& sweep) {
    if (!sweep.sum)
        OrdinateKernel<kUpward, kOrdinates, Wanted::kOctants>(sweep).run();
    else if (sweep.visibility || sweep.lit || sweep.through)
        OrdinateKernel<kUpward, kOrdinates, Wanted::kAnything>(sweep).run();
    else
        OrdinateKernel<kUpward, kOrdinates, Wanted::kVisibility>(sweep).run();
}

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
