// Small vectors, roots and angles for as many rays as a register holds. Seen once a target.
#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#if defined(DFIELD_RAYS_VECTOR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_RAYS_VECTOR_INL
#undef DFIELD_RAYS_VECTOR_INL
#else
#define DFIELD_RAYS_VECTOR_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using I = hn::ScalableTag<std::int32_t>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using MF = hn::Mask<F>;

struct V3 {
    VF x, y, z;
};

// Of numbers within the range of integers; anything for others. Highway's own mends overflow, which takes as
// long as the rest of a lattice point.
HWY_INLINE VI truncated(VF v) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
    return VI{_mm512_cvttps_epi32(v.raw)};
#elif HWY_TARGET == HWY_AVX2
    return VI{_mm256_cvttps_epi32(v.raw)};
#elif HWY_TARGET == HWY_SSE4
    return VI{_mm_cvttps_epi32(v.raw)};
#else
    return hn::ConvertTo(I(), v);
#endif
}

HWY_INLINE VF set(float value) {
    return hn::Set(F(), value);
}
HWY_INLINE V3 set(const glm::vec3& v) {
    return {set(v.x), set(v.y), set(v.z)};
}
HWY_INLINE VF dot(const V3& a, const V3& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
// a + s b
HWY_INLINE V3 along(const V3& a, VF s, const V3& b) {
    return {hn::MulAdd(s, b.x, a.x), hn::MulAdd(s, b.y, a.y), hn::MulAdd(s, b.z, a.z)};
}
HWY_INLINE V3 operator-(const V3& a, const V3& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

// Of positive numbers, far from the limits of floats; a Newton step after the processor's 12 or 14 bits.
HWY_INLINE VF reciprocal(VF x) {
    const VF r = hn::ApproximateReciprocal(x);
    return hn::Mul(r, hn::NegMulAdd(x, r, set(2)));
}
HWY_INLINE VF inverse_root(VF x) {
    const VF safe = hn::Max(x, set(1e-36f));
    const VF r = hn::ApproximateReciprocalSqrt(safe);
    return hn::Mul(r, hn::NegMulAdd(hn::Mul(set(0.5f), safe), hn::Mul(r, r), set(1.5f)));
}

// The root itself, 0 for 0.
HWY_INLINE VF root(VF x) {
    const VF r = hn::ApproximateReciprocalSqrt(hn::Max(x, set(1e-36f)));
    const VF s = hn::Mul(x, r);
    return hn::MulAdd(s, hn::NegMulAdd(s, hn::Mul(set(0.5f), r), set(0.5f)), s);
}

// format/angle.hpp's.
HWY_INLINE VF quarter_turns_of_slope(VF x) {
    const VF y = hn::Mul(x, x);
    VF p = hn::MulAdd(y, set(-0.00746194768f), set(0.0335201446f));
    p = hn::MulAdd(y, p, set(-0.0741234672f));
    p = hn::MulAdd(y, p, set(0.123213593f));
    p = hn::MulAdd(y, p, set(-0.211754678f));
    p = hn::MulAdd(y, p, set(0.636605296f));
    return hn::Mul(x, p);
}

// In [0, 4]; 4 where rounding ends there.
HWY_INLINE VF quarter_turns(VF x, VF y) {
    const VF ax = hn::Abs(x), ay = hn::Abs(y);
    const VF larger = hn::Max(hn::Max(ax, ay), set(1e-30f));
    VF turns = quarter_turns_of_slope(hn::Mul(hn::Min(ax, ay), reciprocal(larger)));
    turns = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(set(1), turns), turns);
    turns = hn::IfThenElse(hn::Lt(x, set(0)), hn::Sub(set(2), turns), turns);
    return hn::IfThenElse(hn::Lt(y, set(0)), hn::Sub(set(4), turns), turns);
}

// The columns of a matrix, every number in all lanes.
struct M3 {
    V3 x, y, z;

    explicit HWY_INLINE M3(const glm::mat3& m) : x(set(m[0])), y(set(m[1])), z(set(m[2])) {}
    HWY_INLINE V3 operator()(VF a, VF b, VF c) const {
        return {hn::MulAdd(x.x, a, hn::MulAdd(y.x, b, hn::Mul(z.x, c))),
                hn::MulAdd(x.y, a, hn::MulAdd(y.y, b, hn::Mul(z.y, c))),
                hn::MulAdd(x.z, a, hn::MulAdd(y.z, b, hn::Mul(z.z, c)))};
    }
};

// chord_of_line, in a sphere of any radius. `valid` says where the line meets the sphere; the rest holds
// nonsense where not.
struct Chords {
    V3 middle, direction;
    VF inverse_square, t_middle, half;
    MF valid;

    HWY_INLINE Chords(const V3& origin, const V3& d, float radius = 1) : direction(d) {
        inverse_square = reciprocal(dot(d, d));
        t_middle = hn::Mul(hn::Neg(dot(origin, d)), inverse_square);
        middle = along(origin, t_middle, d);
        const VF rest = hn::Sub(set(radius * radius), dot(middle, middle));
        valid = hn::Gt(rest, set(0));
        half = root(hn::Mul(rest, inverse_square));
    }
    HWY_INLINE VF t_in() const { return hn::Sub(t_middle, half); }
    HWY_INLINE VF t_out() const { return hn::Add(t_middle, half); }
    HWY_INLINE V3 at_middle_plus(VF t) const { return along(middle, t, direction); }
};

// A mask's lanes as bits, the first lane lowest, and back.
HWY_INLINE std::uint32_t bits_of_mask(MF mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(F(), mask, bytes);
    std::uint32_t bits;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
}
HWY_INLINE MF mask_of_bits(std::uint32_t bits) {
    std::uint8_t bytes[8] = {};
    std::memcpy(bytes, &bits, sizeof bits);
    return hn::LoadMaskBits(F(), bytes);
}

// The lowest of `bits`, spread over the places that `mask` names.
HWY_INLINE std::uint64_t deposit(std::uint64_t bits, std::uint64_t mask) {
#if HWY_ARCH_X86_64 && HWY_TARGET <= HWY_AVX2 && !defined(HWY_DISABLE_BMI2_FMA)
    return _pdep_u64(bits, mask);
#else
    std::uint64_t result = 0;
    for (; mask != 0; mask &= mask - 1, bits >>= 1) result |= mask & -mask & -(bits & 1);
    return result;
#endif
}

// Packs the lanes of a mask at the start of a register.
class Packing {
  public:
#if HWY_TARGET == HWY_AVX2
    // Highway 1.0.3's own makes g++ copy its table to the stack at every use.
    explicit HWY_INLINE Packing(MF mask) : lanes_(lanes_of(mask)) {}
    HWY_INLINE VF operator()(VF v) const {
        return hn::TableLookupLanes(v, hn::IndicesFromVec(F(), lanes_));
    }
    HWY_INLINE VI operator()(VI v) const {
        return hn::TableLookupLanes(v, hn::IndicesFromVec(I(), lanes_));
    }

  private:
    // Which lanes a mask's bits name, ascending.
    struct Table {
        alignas(8) std::uint8_t lanes[256][8]{};

        constexpr Table() {
            for (int mask = 0; mask < 256; ++mask)
                for (int lane = 0, next = 0; lane < 8; ++lane)
                    if (mask >> lane & 1) lanes[mask][next++] = static_cast<std::uint8_t>(lane);
        }
    };
    static HWY_INLINE VI lanes_of(MF mask) {
        static constexpr Table kTable;
        std::uint8_t bits[8];
        hn::StoreMaskBits(F(), mask, bits);
        const hn::Rebind<std::uint8_t, I> bytes;
        return hn::PromoteTo(I(), hn::Load(bytes, kTable.lanes[bits[0]]));
    }
    VI lanes_;
#else
    explicit HWY_INLINE Packing(MF mask) : mask_(mask) {}
    HWY_INLINE VF operator()(VF v) const {
        return hn::Compress(v, mask_);
    }
    HWY_INLINE VI operator()(VI v) const {
        return hn::Compress(v, hn::RebindMask(I(), mask_));
    }

  private:
    MF mask_;
#endif
};

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
