// Visibility of octants on its way out: sweeps leave, for each octant, a word a vertex with the bytes of the
// slab's four slices; callers get, for each voxel, a word with the bytes of four octants. Included once a
// target.
#if defined(DFIELD_VOLUME_OCTANT_WORDS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_VOLUME_OCTANT_WORDS_INL_HPP
#undef DFIELD_VOLUME_OCTANT_WORDS_INL_HPP
#else
#define DFIELD_VOLUME_OCTANT_WORDS_INL_HPP
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>

#include "volume/layout-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

using U32 = hn::RebindToUnsigned<F>;

HWY_INLINE Skew skew_of(std::size_t octant) {
    return kSweeps[octant].x == kSweeps[octant].y ? Skew::kFalling : Skew::kRising;
}

// Packs the slices' values, in [0, 1] after scaling by 255 / scale, as a kernel meets them: from the last
// slice to the first. A slice lags a vector behind the one before, and so does its byte.
struct SliceBytes {
    hn::Vec<U32> word = hn::Zero(U32());
    HWY_INLINE SliceBytes() {}
    HWY_INLINE void push(VF value, VF scale) {
        // Added to 2^23, a number's nearest integer is what its last bits say.
        const auto rounded = hn::BitCast(U32(), hn::MulAdd(value, scale, hn::Set(F(), 0x1p23f)));
        push_byte(rounded);
    }
    // The lowest bytes.
    HWY_INLINE void push_byte(hn::Vec<U32> byte) {
        word = select_bits(hn::Set(U32(), 0xff), byte, hn::ShiftLeft<8>(word));
    }
};

// Writes word(x), vectors of four bytes a voxel, past the cache: nobody reads them soon.
template<class Word>
HWY_INLINE void stream_words(std::size_t n, const Word& word, std::uint8_t* out) {
    const hn::Repartition<std::uint8_t, F> bytes;
    constexpr std::size_t kBytes = 4 * kLanes;
    const auto some = [&](std::size_t x, std::size_t count) HWY_ATTR {
        HWY_ALIGN std::uint8_t words[kBytes];
        hn::Store(hn::BitCast(bytes, word(x)), bytes, words);
        std::copy_n(words, 4 * count, out + 4 * x);
    };
    // The rows of a dense volume begin anywhere; vectors are streamed from the first aligned one on.
    const std::size_t misaligned = reinterpret_cast<std::uintptr_t>(out) % kBytes;
    std::size_t x = 0;
    if (misaligned % 4 == 0) {
        x = std::min(n, misaligned == 0 ? 0 : (kBytes - misaligned) / 4);
        if (x > 0) some(0, x);
        for (; x + kLanes <= n; x += kLanes) hn::Stream(hn::BitCast(bytes, word(x)), bytes, out + 4 * x);
    }
    for (; x < n; x += kLanes) some(x, std::min(kLanes, n - x));
}

// Four octants of a group.
struct OctantWords {
    std::array<std::size_t, 4> octants;         // all below 4, or all from 4 on
    std::array<const std::uint32_t*, 4> words;  // vector 0 of each
    std::array<std::size_t, kSlices> slices;    // their z; nz and beyond: none
    std::size_t group;
};

// `rows`: four sets of row buffers. `octants`: as DistanceJob::octants.
HWY_INLINE void store_octants(const Grid& grid, const Shape& shape, const OctantWords& from, float* rows,
                              std::uint8_t* octants) {
    const F f;
    const U32 u32;
    std::array<const float*, 4> set;    // by channel
    std::array<std::ptrdiff_t, 4> lag;  // in x, of a slice against the one before
    for (std::size_t i = 0; i < 4; ++i) {
        float* const to = rows + i * kLanes * shape.row_stride;
        const std::uint32_t* const words = from.words[i];
        unskew_rows(
            shape, skew_of(from.octants[i]),
            [&](std::ptrdiff_t t) HWY_ATTR {
                return hn::BitCast(f, hn::Load(u32, words + t * static_cast<std::ptrdiff_t>(kLanes)));
            },
            to, true);
        set[from.octants[i] % 4] = to;
        lag[from.octants[i] % 4] = kSweeps[from.octants[i]].x;
    }
    std::uint8_t* const volume = octants + (from.octants[0] < 4 ? 0 : 4 * grid.size());
    const std::size_t count = std::min(kLanes, grid.ny - from.group * kLanes);
    // All slices of a row while its words are in the first cache.
    for (std::size_t l = 0; l < count; ++l)
        for (std::size_t slice = 0; slice < kSlices && from.slices[slice] < grid.nz; ++slice) {
            std::array<const std::uint32_t*, 4> row;
            for (std::size_t c = 0; c < 4; ++c)
                row[c] = reinterpret_cast<const std::uint32_t*>(set[c] + l * shape.row_stride +
                                                                lag[c] * static_cast<std::ptrdiff_t>(slice));
            const auto merged = [&](std::size_t x) HWY_ATTR {
                auto word = hn::Zero(u32);
                for (std::size_t c = 0; c < 4; ++c) {
                    auto v = hn::LoadU(u32, row[c] + x);
                    v = c > slice ? hn::ShiftLeftSame(v, static_cast<int>(8 * (c - slice)))
                                  : hn::ShiftRightSame(v, static_cast<int>(8 * (slice - c)));
                    word = hn::OrAnd(word, v, hn::Set(u32, 0xffu << 8 * c));
                }
                return word;
            };
            stream_words(grid.nx, merged,
                         volume + 4 * grid.index(0, from.group * kLanes + l, from.slices[slice]));
        }
}

#endif
}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
