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
    float* sum = nullptr;                 // sum of term (1 - V), or of term V where `lit`
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

// kLit: intensities other than 1.
template<bool kUpward, std::size_t kOrdinates, bool kLit>
class OrdinateKernel {
  public:
    HWY_INLINE explicit OrdinateKernel(const OrdinateSweep& sweep)
        : s_(sweep),
          order_(),
          direction_(sweep.ascending ? 1 : -1),
          start_(sweep.ascending ? 0 : sweep.vectors - 1),
          enters_(sweep.ascending ? 0 : kN - 1),
          leaves_(kN - 1 - enters_ + direction_),
          least_(hn::Set(F(), sweep.through ? -1.0f : 0.0f)) {
        // All ordinates are permutations of one: their directions are as long.
        const Ordinate& any = sweep.ordinates[0];
        const float scale =
            -sweep.weight / (kNormalScale * std::sqrt(any.x * any.x + any.y * any.y + any.z * any.z));
        nx_ = hn::Set(F(), scale * static_cast<float>(sweep.direction.x));
        ny_ = hn::Set(F(), scale * static_cast<float>(sweep.direction.y));
        nz_ = hn::Set(F(), scale * static_cast<float>(sweep.direction.z));
        for (std::size_t o = 0; o < kOrdinates; ++o) {
            const Ordinate& w = sweep.ordinates[o];
            wx_[o] = hn::Set(F(), w.x);
            wy_[o] = hn::Set(F(), w.y);
            wz_[o] = hn::Set(F(), w.z);
            for (std::size_t p = 0; p < kSlices; ++p) dark_[p][o] = hn::Zero(F());
        }
    }

    HWY_INLINE void run() {
        for (std::ptrdiff_t i = 0; i < s_.vectors + kS; ++i) {
#pragma GCC unroll 4
            for (std::ptrdiff_t p = kS - 1; p >= 0; --p) vertex(p, start_ + direction_ * (i - p));
        }
    }

  private:
    static constexpr std::ptrdiff_t kN = kLanes, kS = kSlices;

    HWY_INLINE void vertex(std::ptrdiff_t p, std::ptrdiff_t t) {
        const F f;
        const I32 i32;
        const std::ptrdiff_t voxel = p * s_.slice_stride + t * kN;
        const auto word = hn::BitCast(i32, hn::Load(U32(), s_.vertices + voxel));
        const VF tau = hn::Mul(hn::ConvertTo(f, hn::And(word, hn::Set(i32, 0xff))), hn::Set(f, 1.0f / 255));
        const VF opacity = hn::Sub(hn::Set(f, 1.0f), tau);
        const VF nx = hn::Mul(nx_, hn::ConvertTo(f, hn::ShiftRight<24>(hn::ShiftLeft<16>(word))));
        const VF ny = hn::Mul(ny_, hn::ConvertTo(f, hn::ShiftRight<24>(hn::ShiftLeft<8>(word))));
        const VF nz = hn::Mul(nz_, hn::ConvertTo(f, hn::ShiftRight<24>(word)));
        VF sum = hn::Load(f, s_.sum + voxel), darkness = hn::Zero(f);
#pragma GCC unroll 6
        for (std::size_t o = 0; o < kOrdinates; ++o) {
            float* const border =
                s_.border + (static_cast<std::ptrdiff_t>(o) * kS + p) * s_.border_stride + t;
            float* const below = s_.below + static_cast<std::ptrdiff_t>(o) * s_.below_stride + t * kN;
            const VF dx = dark_[p][o], dy = order_.previous_row(dx, border - leaves_, border - enters_);
            const VF dz = p > 0 ? dark_[p > 0 ? p - 1 : 0][o] : hn::Load(f, below);
            // Equation 6 for u = 1 - V, and 1 - V tau = (1 - tau) + tau u.
            const VF u = hn::MulAdd(wx_[o], dx, hn::MulAdd(wy_[o], dy, hn::Mul(wz_[o], dz)));
            dark_[p][o] = hn::MulAdd(tau, u, opacity);
            if (p == kS - 1) hn::Store(dark_[p][o], f, below);
            const VF cosine = hn::MulAdd(wx_[o], nx, hn::MulAdd(wy_[o], ny, hn::Mul(wz_[o], nz)));
            const VF term = hn::Max(cosine, hn::Mul(least_, cosine));
            sum = hn::MulAdd(term, kLit ? hn::Sub(hn::Set(f, 1.0f), u) : u, sum);
            darkness = hn::Add(darkness, u);
        }
        hn::Store(sum, f, s_.sum + voxel);
        if (s_.visibility) {
            const VF mean = hn::NegMulAdd(darkness, hn::Set(f, 1.0f / kOrdinates), hn::Set(f, 1.0f));
            bytes_.push(mean, hn::Set(f, 255.0f));
            if (p == 0) hn::Store(bytes_.word, U32(), s_.visibility + t * kN);
        }
    }

    const OrdinateSweep s_;
    const RowOrder<kUpward> order_;
    const std::ptrdiff_t direction_, start_, enters_, leaves_;  // as GroupKernel's
    const VF least_;
    VF wx_[kOrdinates], wy_[kOrdinates], wz_[kOrdinates];
    VF nx_, ny_, nz_;  // of the normal's bytes, to the geometry term's weight
    VF dark_[kSlices][kOrdinates];
    SliceBytes bytes_;
};

template<bool kUpward, std::size_t kOrdinates>
void sweep_ordinates(const OrdinateSweep& sweep) {
    if (sweep.lit)
        OrdinateKernel<kUpward, kOrdinates, true>(sweep).run();
    else
        OrdinateKernel<kUpward, kOrdinates, false>(sweep).run();
}

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
