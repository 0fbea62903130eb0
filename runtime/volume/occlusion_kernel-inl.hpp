// One diagonal sweep of the improved form's fields through a pair of groups of rows and kSlices slices.
// Included once a target.
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

// A vertex as these sweeps see it, one word: the opacity times 255 in the lowest byte, above it the normal
// times 127, x, y and z as signed bytes. Beyond the grid it is open: light comes in unchanged.
constexpr float kNormalScale = 127;
constexpr std::uint32_t kOpenVertex = 0;

// The kernel works on pairs of groups of rows, in fixed point: kOne is 1.
constexpr std::size_t kPairRows = 2 * kLanes;
constexpr std::int16_t kOne = 0x7fff;

struct OrdinateSweep {
    std::ptrdiff_t vectors = 0;  // of a pair
    bool ascending = true;
    // The two groups' vector 0, moved to where the pair's lies: the pair's rows are skewed as one.
    std::array<const std::uint32_t*, 2> vertices{};
    std::ptrdiff_t vertices_stride = 0;  // to the next slice's, elements
    // Sum of term (1 - V), or of term V where `lit`, in fixed point; null: not wanted.
    std::int16_t* sum = nullptr;
    std::ptrdiff_t sum_stride = 0;               // to the next slice's
    bool first = false;                          // begin the sums
    std::array<std::uint32_t*, 2> visibility{};  // the groups' words for store_octants, or null
    // 1 - V tau: of the slab before, a vector for each ordinate, and of the last row of the pair before, at
    // each x that of kSlices slices, of each the ordinates'. A slice's lag is not counted in this x, as it is
    // the same for both.
    std::int16_t* below = nullptr;
    std::int16_t* border = nullptr;
    std::array<Ordinate, kMaxOrdinates> ordinates{}, weights{};  // as weights_of()
    bool cubic = true;                                           // the weights are the ordinates
    Sweep direction{};
    float weight = 1;  // of the geometry term, 1 at most
    bool lit = false;  // intensities other than 1
    bool through = false;
};

// What a kernel is made for: an evenly lit visibility volume alone, octants alone, or anything.
enum class Wanted { kVisibility, kOctants, kAnything };

template<bool kUpward, std::size_t kOrdinates, Wanted kWanted, bool kCubic>
class OrdinateKernel {
  public:
    HWY_INLINE explicit OrdinateKernel(const OrdinateSweep& sweep)
        : s_(sweep),
          order_(),
          direction_(sweep.ascending ? 1 : -1),
          start_(sweep.ascending ? 0 : sweep.vectors - 1),
          enters_(sweep.ascending ? 0 : kRows - 1),
          leaves_(kRows - 1 - enters_ + direction_),
          through_(hn::Set(I16(), sweep.through ? -1 : 0)),
          lit_(hn::Set(I16(), sweep.lit ? kOne : 0)) {
        for (std::size_t i = 0; i < kSets; ++i) {
            const std::size_t o = kCubic ? 3 * i : i;
            set_parts(parts_[i], sweep.ordinates[o]);
            if constexpr (!kCubic) set_parts(weights_[i], sweep.weights[o]);
        }
        // Of the same length, all of them. A normal's byte is in the upper half of 16 bits: 128 would be 1.
        const Ordinate& any = sweep.ordinates[0];
        const float length = std::sqrt(any.x * any.x + any.y * any.y + any.z * any.z);
        const float scale = -sweep.weight * 128 / (kNormalScale * length);
        scale_x_ = fixed(scale * static_cast<float>(sweep.direction.x));
        scale_y_ = fixed(scale * static_cast<float>(sweep.direction.y));
        scale_z_ = fixed(scale * static_cast<float>(sweep.direction.z));
        for (auto& slice : dark_)
            for (VH& ordinate : slice) ordinate = hn::Zero(I16());
    }

    HWY_INLINE void run() {
        for (std::ptrdiff_t i = 0; i < s_.vectors + kS; ++i) {
#pragma GCC unroll 4
            for (std::ptrdiff_t p = kS - 1; p >= 0; --p) vertex(p, start_ + direction_ * i);
        }
    }

  private:
    static constexpr std::ptrdiff_t kN = kLanes, kRows = kPairRows, kS = kSlices;
    static constexpr bool kSums = kWanted != Wanted::kOctants, kBytes = kWanted != Wanted::kVisibility;
    // Ordinates come in threes, the cyclic permutations of one: few of them have to stay in registers. Where
    // spacings differ the weights are other numbers, different for each.
    static constexpr std::size_t kSets = kCubic ? (kOrdinates + 2) / 3 : kOrdinates;

    static HWY_INLINE VH fixed(float value) {
        return hn::Set(
            I16(), static_cast<std::int16_t>(std::lround(std::clamp(value * 32768, -32767.0f, 32767.0f))));
    }
    static HWY_INLINE void set_parts(VH (&parts)[3], const Ordinate& of) {
        parts[0] = fixed(of.x);
        parts[1] = fixed(of.y);
        parts[2] = fixed(of.z);
    }
    HWY_INLINE VH part(std::size_t ordinate, std::size_t axis) const {
        if constexpr (kCubic)
            return parts_[ordinate / 3][(3 - ordinate % 3 + axis) % 3];
        else
            return parts_[ordinate][axis];
    }
    HWY_INLINE VH weight(std::size_t ordinate, std::size_t axis) const {
        if constexpr (kCubic)
            return part(ordinate, axis);
        else
            return weights_[ordinate][axis];
    }
    static HWY_INLINE VH multiply(VH a, VH b) {
        return hn::MulFixedPoint15(a, b);
    }

    // Of slice p, which lags p vectors behind `foremost`.
    HWY_INLINE void vertex(std::ptrdiff_t p, std::ptrdiff_t foremost) {
        const std::ptrdiff_t t = foremost - direction_ * p;
        const I16 i16;
        const U32 u32;
        const std::ptrdiff_t at = p * s_.vertices_stride + t * kN;
        const auto low = hn::Load(u32, s_.vertices[0] + at), high = hn::Load(u32, s_.vertices[1] + at);
        const auto half = hn::Set(u32, 0xffff);
        // The lower and the upper halves of the rows' words: opacity and x, y and z.
        const VH ox = hn::BitCast(i16, select_bits(half, low, hn::ShiftLeft<16>(high)));
        const hn::RebindToUnsigned<I16> u16;
        const VH opacity = hn::BitCast(i16, hn::ShiftRight<1>(hn::ShiftLeft<8>(hn::BitCast(u16, ox))));
        VH nx = hn::Zero(i16), ny = nx, nz = nx, sum = nx, mean = nx;
        const std::ptrdiff_t sums = p * s_.sum_stride + t * kRows;  // s_.sum may be null
        if constexpr (kSums) {
            const VH yz = hn::BitCast(i16, select_bits(half, hn::ShiftRight<16>(low), high));
            const VH upper = hn::Set(i16, static_cast<std::int16_t>(0xff00));
            nx = multiply(hn::And(ox, upper), scale_x_);
            ny = multiply(hn::ShiftLeft<8>(yz), scale_y_);
            nz = multiply(hn::And(yz, upper), scale_z_);
            if (!s_.first) sum = hn::Load(i16, s_.sum + sums);
        }
#pragma GCC unroll 6
        for (std::size_t o = 0; o < kOrdinates; ++o) {
            constexpr auto kCount = static_cast<std::ptrdiff_t>(kOrdinates);
            const auto ordinate = static_cast<std::ptrdiff_t>(o);
            std::int16_t* const border = s_.border + (foremost * kS + p) * kCount + ordinate;
            std::int16_t* const below = s_.below + (t * kCount + ordinate) * kRows;
            const VH dx = dark_[p][o], dy = order_.previous_row(dx, border - leaves_ * kS * kCount,
                                                                border - enters_ * kS * kCount);
            const VH dz = p > 0 ? dark_[p > 0 ? p - 1 : 0][o] : hn::Load(i16, below);
            // Equation 6 for u = 1 - V, the weights' sum being 1: roundings leave it in [0, 1]. And
            // 1 - V tau = u + (1 - tau) (1 - u).
            const VH u = hn::Add(hn::Add(dz, multiply(weight(o, 0), hn::Sub(dx, dz))),
                                 multiply(weight(o, 1), hn::Sub(dy, dz)));
            const VH v = hn::Sub(hn::Set(i16, kOne), u);
            dark_[p][o] = hn::Add(u, multiply(opacity, v));
            if (p == kS - 1) hn::Store(dark_[p][o], i16, below);
            if constexpr (kBytes) mean = hn::Add(mean, multiply(v, hn::Set(i16, kOne / kOrdinates)));
            if constexpr (kSums) {
                const VH cosine = hn::Add(hn::Add(multiply(part(o, 0), nx), multiply(part(o, 1), ny)),
                                          multiply(part(o, 2), nz));
                if constexpr (kWanted == Wanted::kVisibility) {
                    sum = hn::SaturatedAdd(sum, multiply(hn::Max(cosine, hn::Zero(i16)), u));
                } else {
                    const VH behind = hn::And(hn::Sub(hn::Zero(i16), cosine), through_);
                    sum = hn::SaturatedAdd(sum, multiply(hn::Max(cosine, behind), hn::Xor(u, lit_)));
                }
            }
        }
        if constexpr (kSums) hn::Store(sum, i16, s_.sum + sums);
        if constexpr (kBytes) {
            const auto bytes = hn::BitCast(u32, multiply(mean, hn::Set(i16, 255)));
            bytes_[0].push_byte(bytes);
            bytes_[1].push_byte(hn::ShiftRight<16>(bytes));
            if (p == 0 && s_.visibility[0])
                for (std::size_t i = 0; i < 2; ++i) hn::Store(bytes_[i].word, u32, s_.visibility[i] + t * kN);
        }
    }

    const OrdinateSweep s_;
    const HalvesOrder<kUpward> order_;
    const std::ptrdiff_t direction_, start_, enters_, leaves_;  // as GroupKernel's
    const VH through_, lit_;
    VH parts_[kSets][3];  // where cubic, ordinate o of three has them from -o on, cyclically
    VH weights_[kCubic ? 1 : kSets][3];
    VH scale_x_, scale_y_, scale_z_;  // of the normal's bytes, to the geometry term's weight
    VH dark_[kSlices][kOrdinates];
    SliceBytes bytes_[2];
};

template<bool kUpward, std::size_t kOrdinates>
void sweep_ordinates(const OrdinateSweep& sweep) {
    if (!sweep.cubic)
        OrdinateKernel<kUpward, kOrdinates, Wanted::kAnything, false>(sweep).run();
    else if (!sweep.sum)
        OrdinateKernel<kUpward, kOrdinates, Wanted::kOctants, true>(sweep).run();
    else if (sweep.visibility[0] || sweep.lit || sweep.through)
        OrdinateKernel<kUpward, kOrdinates, Wanted::kAnything, true>(sweep).run();
    else
        OrdinateKernel<kUpward, kOrdinates, Wanted::kVisibility, true>(sweep).run();
}

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
