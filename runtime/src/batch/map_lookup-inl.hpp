// Bits of a 1-bit map for vectors of texel coordinates. Where a map fits into registers it is looked up by
// permutes; gathers are 2.7 times slower.
#if defined(DFIELD_MAP_LOOKUP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_MAP_LOOKUP_INL
#undef DFIELD_MAP_LOOKUP_INL
#else
#define DFIELD_MAP_LOOKUP_INL
#endif

#include <hwy/highway.h>

#include <array>
#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using V = hn::Vec<F>;

// Not all-constant: HWY_TARGET <= HWY_AVX3 are the AVX-512 targets.
#define DFIELD_AVX512 (HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3)

// One bit a lane, lane 0 lowest.
template<class D, class M>
HWY_INLINE std::uint32_t mask_bits(D d, M mask) {
#if DFIELD_AVX512
    (void)d;
    return static_cast<std::uint32_t>(mask.raw);
#elif HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4
    if constexpr (sizeof(hn::TFromD<D>) == 4) {  // through memory the load would wait for the narrower store
        const auto lanes = hn::BitCast(F(), hn::VecFromMask(d, mask));
        if constexpr (hn::MaxLanes(D()) == 8)
            return static_cast<std::uint32_t>(_mm256_movemask_ps(lanes.raw));
        else
            return static_cast<std::uint32_t>(_mm_movemask_ps(lanes.raw));
    }
#endif
#if !DFIELD_AVX512
    std::array<std::uint8_t, 8> bytes{};
    hn::StoreMaskBits(d, mask, bytes.data());
    std::uint32_t bits;
    std::memcpy(&bits, bytes.data(), sizeof bits);
    return bits;
#endif
}

// `value` where the lane's bit is 1, else 0.
HWY_INLINE V keep_bits(F d, std::uint32_t bits, V value) {
#if DFIELD_AVX512
    return hn::IfThenElseZero(hn::Mask<F>{static_cast<decltype(hn::Mask<F>::raw)>(bits)}, value);
#else
    const U u;
    const auto lane = hn::Shl(hn::Set(u, 1u), hn::Iota(u, 0u));
    const auto set = hn::Ne(hn::And(hn::Set(u, bits), lane), hn::Zero(u));
    return hn::IfThenElseZero(hn::RebindMask(d, set), value);
#endif
}

// The words of one map at hand for lookups; kSize texels a side.
template<int kSize>
class MapRegisters {
    static constexpr int kWords = kSize * kSize / 32;

  public:
    HWY_INLINE MapRegisters(F, const std::uint32_t* words) : words_(words) {
#if DFIELD_AVX512
        const U d;
        if constexpr (kWords == 8) {
            registers_[0] = hn::Vec<U>{
                _mm512_castsi256_si512(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(words)))};
        } else if constexpr (kWords <= 128) {
            for (int i = 0; i < kWords / 16; ++i) registers_[i] = hn::LoadU(d, words + 16 * i);
        }
#elif HWY_TARGET == HWY_AVX2
        const U d;
        if constexpr (kWords <= 32)
            for (int i = 0; i < kWords / 8; ++i) registers_[i] = hn::LoadU(d, words + 8 * i);
#endif
    }

    // One bit a lane: whether texel (u, v) exists and is set.
    HWY_INLINE std::uint32_t hits(F d, V u, V v) const {
        const I i;
        const U un;
#if DFIELD_AVX512
        if constexpr (kSize >= 32 && kWords <= 128) {
            constexpr int kFloor = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
            const __m512i column = _mm512_cvt_roundps_epi32(u.raw, kFloor),
                          row = _mm512_cvt_roundps_epi32(v.raw, kFloor);
            const __m512i size = _mm512_set1_epi32(kSize), one = _mm512_set1_epi32(1);
            __mmask16 inside = _mm512_cmplt_epu32_mask(row, size);
            __m512i index = row, shift = column;
            if constexpr (kSize == 64) {
                inside = _mm512_mask_cmplt_epu32_mask(inside, column, size);
                // Permutes and rotations look at the low bits of their counts only.
                index = _mm512_or_si512(_mm512_slli_epi32(row, 1), _mm512_srli_epi32(column, 5));
                shift = _mm512_and_si512(column, _mm512_set1_epi32(31));
            }  // else: columns outside shift everything out
            const __m512i bits = _mm512_srlv_epi32(word(hn::Vec<U>{index}, hn::Mask<U>{inside}).raw, shift);
            return _mm512_mask_test_epi32_mask(inside, bits, one);
        }
#endif
#if HWY_TARGET == HWY_AVX2
        if constexpr (kSize == 32) {
            // Adding 3 * 2^22 leaves the nearest integer in the low bits: of x - 1/2, the floor of x (of an
            // exact integer, it or the one below).
            const __m256 half = _mm256_set1_ps(0.5f), magic = _mm256_set1_ps(12582912.0f);
            const auto floor = [&](V x) HWY_ATTR {
                return _mm256_sub_epi32(_mm256_castps_si256(_mm256_add_ps(_mm256_sub_ps(x.raw, half), magic)),
                                        _mm256_castps_si256(magic));
            };
            const __m256i column = floor(u), row = floor(v);
            const auto permuted = [&](int q) HWY_ATTR {
                return _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(registers_[q].raw, row));
            };
            const __m256 bit3 = _mm256_castsi256_ps(_mm256_slli_epi32(row, 28)),
                         bit4 = _mm256_castsi256_ps(_mm256_slli_epi32(row, 27));
            const __m256 word = _mm256_blendv_ps(_mm256_blendv_ps(permuted(0), permuted(1), bit3),
                                                 _mm256_blendv_ps(permuted(2), permuted(3), bit3), bit4);
            // Columns outside shift everything out; rows outside are left out.
            const __m256i bits = _mm256_slli_epi32(_mm256_srlv_epi32(_mm256_castps_si256(word), column), 31);
            const __m256i inside = _mm256_cmpeq_epi32(_mm256_srli_epi32(row, 5), _mm256_setzero_si256());
            return static_cast<std::uint32_t>(
                _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_and_si256(bits, inside))));
        }
#endif
        // Truncation takes (-1, 0) to texel 0, which the signs tell apart.
        const auto column = hn::BitCast(un, hn::ConvertTo(i, u)), row = hn::BitCast(un, hn::ConvertTo(i, v));
        const auto size = hn::Set(un, static_cast<std::uint32_t>(kSize));
        const auto inside =
            hn::And(hn::And(hn::Lt(column, size), hn::Lt(row, size)),
                    hn::RebindMask(un, hn::And(hn::Ge(u, hn::Zero(d)), hn::Ge(v, hn::Zero(d)))));
        // Texel v * kSize + u is bit (texel % 32) of word texel / 32.
        hn::Vec<U> index, shift;
        if constexpr (kSize == 32) {
            index = row;
            shift = column;
        } else if constexpr (kSize == 16) {
            index = hn::ShiftRight<1>(row);
            shift = hn::Or(hn::ShiftLeft<4>(hn::And(row, hn::Set(un, 1u))), column);
        } else {
            index = hn::Or(hn::ShiftLeft < kSize == 64 ? 1 : 2 > (row), hn::ShiftRight<5>(column));
            shift = hn::And(column, hn::Set(un, 31u));
        }
        const auto bit =
            hn::And(hn::Shr(word(index, inside), hn::And(shift, hn::Set(un, 31u))), hn::Set(un, 1u));
        return mask_bits(un, hn::And(inside, hn::Ne(bit, hn::Zero(un))));
    }

  private:
    // words[index] where inside; anything elsewhere.
    template<class M>
    HWY_INLINE hn::Vec<U> word(hn::Vec<U> index, M inside) const {
        const U d;
#if DFIELD_AVX512
        if constexpr (kWords == 8) return hn::Vec<U>{_mm512_permutexvar_epi32(index.raw, registers_[0].raw)};
        if constexpr (kWords == 32) return pair(0, index);
        if constexpr (kWords == 128) {
            const auto high = hn::TestBit(index, hn::Set(d, 64u)),
                       middle = hn::TestBit(index, hn::Set(d, 32u));
            return hn::IfThenElse(high, hn::IfThenElse(middle, pair(6, index), pair(4, index)),
                                  hn::IfThenElse(middle, pair(2, index), pair(0, index)));
        }
#elif HWY_TARGET == HWY_AVX2
        const auto look_up = [&](int i) HWY_ATTR {
            return hn::TableLookupLanes(registers_[i], hn::IndicesFromVec(d, hn::And(index, hn::Set(d, 7u))));
        };
        if constexpr (kWords == 8) return look_up(0);
        if constexpr (kWords == 32) {
            const auto high = hn::TestBit(index, hn::Set(d, 16u)), low = hn::TestBit(index, hn::Set(d, 8u));
            return hn::IfThenElse(high, hn::IfThenElse(low, look_up(3), look_up(2)),
                                  hn::IfThenElse(low, look_up(1), look_up(0)));
        }
#endif
#if DFIELD_AVX512 || HWY_TARGET == HWY_AVX2
        const I i;
        return hn::BitCast(d, hn::GatherIndex(i, reinterpret_cast<const std::int32_t*>(words_),
                                              hn::BitCast(i, hn::IfThenElseZero(inside, index))));
#else
        HWY_ALIGN std::uint32_t lanes[16];
        hn::Store(hn::IfThenElseZero(inside, index), d, lanes);
        for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) lanes[lane] = words_[lanes[lane]];
        return hn::Load(d, lanes);
#endif
    }

#if DFIELD_AVX512
    // Highway 1.0 has no lookup in two tables.
    HWY_INLINE hn::Vec<U> pair(int i, hn::Vec<U> index) const {
        return hn::Vec<U>{_mm512_permutex2var_epi32(registers_[i].raw, index.raw, registers_[i + 1].raw)};
    }
    std::array<hn::Vec<U>, kWords == 8 ? 1 : kWords <= 128 ? kWords / 16 : 1> registers_;
#elif HWY_TARGET == HWY_AVX2
    std::array<hn::Vec<U>, kWords <= 32 ? kWords / 8 : 1> registers_;
#endif
    const std::uint32_t* words_;
};

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
