// The skewed layout. A slice's rows are taken N at a time (N lanes, a group); within a group, vector t holds
// (x, row l) with x = t - l ("falling") or x = t - (N - 1 - l) ("rising") in lane l. The neighbours x - 1 and
// y - 1 of all lanes of vector t then lie in vector t - 1, the latter one lane over, so a sweep along that
// diagonal needs no gathers. Included once a target.
#if defined(DFIELD_VOLUME_LAYOUT_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef DFIELD_VOLUME_LAYOUT_INL_HPP
#undef DFIELD_VOLUME_LAYOUT_INL_HPP
#else
#define DFIELD_VOLUME_LAYOUT_INL_HPP
#endif

#include <hwy/highway.h>

#include "volume/grid.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::volume::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, 16>;
using VF = hn::Vec<F>;
constexpr std::size_t kLanes = hn::MaxLanes(F());

// While they are swept, distances are in units of Grid::h(). The sign marks frozen vertices, the last bit of
// the mantissa those inside.
constexpr std::int32_t kInsideBit = 1;

// Slices that a kernel works on at once, one step apart, to hide the latency of its chain.
constexpr std::size_t kSlices = 4;

// Sizes of one slab (kSlices slices) in the skewed layout, in vectors, and of the row buffers, in floats.
struct Shape {
    // `rows` of them in a group, a multiple of kLanes; `group_count` groups; each with `spare_vectors` more
    // on either side, of which a slice's lag needs kSlices.
    Shape(const Grid& grid, std::size_t rows, std::size_t group_count, std::size_t spare_vectors)
        : nx(grid.nx),
          ny(grid.ny),
          groups(group_count),
          vectors(nx + rows - 1),
          blocks((vectors + 3) / 4),
          spare(spare_vectors),
          group_stride(spare + 4 * blocks + spare),
          row_stride(row_size(nx)),
          slice_stride(group_stride * groups) {
        // Slices are read in step: keep them apart in the cache's sets.
        while (slice_stride % 64 < 9 || slice_stride % 64 > 55 || slice_stride % 2 == 0) ++slice_stride;
    }
    explicit Shape(const Grid& grid) : Shape(grid, kLanes, (grid.ny + kLanes - 1) / kLanes, kSlices) {}
    static std::size_t row_size(std::size_t nx) {
        const std::size_t size = 2 * kPad + (nx + 15) / 16 * 16;
        return size / 16 % 2 == 0 ? size + 16 : size;
    }
    // Elements, of four bytes.
    std::size_t layer() const { return slice_stride * kLanes; }
    std::size_t slab_floats() const { return kSlices * layer(); }
    // Where vector 0 of a group begins.
    std::size_t at(std::size_t slice, std::size_t group) const {
        return (slice * slice_stride + group * group_stride + spare) * kLanes;
    }
    static constexpr std::size_t kPad = 32;  // before x = 0 and after x = nx - 1 in a row buffer

    std::size_t nx, ny, groups;
    std::size_t vectors;  // of a group
    std::size_t blocks;   // of four vectors, that cover them
    std::size_t spare;
    std::size_t group_stride;
    std::size_t row_stride;
    std::size_t slice_stride;
};

#if HWY_TARGET != HWY_SCALAR

// The bits of `yes` where the mask has ones, of `no` where it has zeros; one operation where there is one.
template<class V>
HWY_INLINE V select_bits(V mask, V yes, V no) {
#if HWY_TARGET <= HWY_AVX3
    return hn::IfVecThenElse(mask, yes, no);
#else
    return hn::Or(hn::And(mask, yes), hn::AndNot(mask, no));
#endif
}

// The 4 x 4 transposition within each 128-bit block.
HWY_INLINE void transpose(VF& a, VF& b, VF& c, VF& d) {
    const F f;
    const hn::Repartition<std::uint64_t, F> wide;
    const auto ab_low = hn::BitCast(wide, hn::InterleaveLower(f, a, b));
    const auto ab_high = hn::BitCast(wide, hn::InterleaveUpper(f, a, b));
    const auto cd_low = hn::BitCast(wide, hn::InterleaveLower(f, c, d));
    const auto cd_high = hn::BitCast(wide, hn::InterleaveUpper(f, c, d));
    a = hn::BitCast(f, hn::InterleaveLower(wide, ab_low, cd_low));
    b = hn::BitCast(f, hn::InterleaveUpper(wide, ab_low, cd_low));
    c = hn::BitCast(f, hn::InterleaveLower(wide, ab_high, cd_high));
    d = hn::BitCast(f, hn::InterleaveUpper(wide, ab_high, cd_high));
}

// Four floats of every fourth row, side by side.
template<class Tag>
HWY_INLINE hn::Vec<Tag> load_quads(Tag tag, const float* p, std::ptrdiff_t four_rows) {
    if constexpr (hn::MaxLanes(Tag()) == 4) {
        return hn::LoadU(tag, p);
    } else {
        const hn::Half<Tag> half;
        constexpr std::ptrdiff_t kQuads = hn::MaxLanes(Tag()) / 8;  // in a half
        return hn::Combine(tag, load_quads(half, p + kQuads * four_rows, four_rows),
                           load_quads(half, p, four_rows));
    }
}

template<class Tag>
HWY_INLINE void store_quads(Tag tag, hn::Vec<Tag> v, float* p, std::ptrdiff_t four_rows) {
    if constexpr (hn::MaxLanes(Tag()) == 4) {
        hn::StoreU(v, tag, p);
    } else {
        const hn::Half<Tag> half;
        constexpr std::ptrdiff_t kQuads = hn::MaxLanes(Tag()) / 8;
        store_quads(half, hn::LowerHalf(half, v), p, four_rows);
        store_quads(half, hn::UpperHalf(half, v), p + kQuads * four_rows, four_rows);
    }
}

enum class Skew { kFalling, kRising };

// Where row 0's element of vector 0 lies from its x = 0, and the step from a row to the next one's.
struct RowSteps {
    std::ptrdiff_t first, step;
    RowSteps(const Shape& shape, Skew skew)
        : first(skew == Skew::kFalling ? 0 : -static_cast<std::ptrdiff_t>(kLanes - 1)),
          step(static_cast<std::ptrdiff_t>(shape.row_stride) + (skew == Skew::kFalling ? -1 : 1)) {}
};

// From kLanes rows (x = 0 of the first at `rows`, padded on both sides) to a group's vectors.
HWY_INLINE void skew_rows(const Shape& shape, Skew skew, const float* HWY_RESTRICT rows,
                          float* HWY_RESTRICT vectors) {
    const F f;
    const RowSteps steps(shape, skew);
    const float* from = rows + steps.first;
    for (std::size_t block = 0; block < shape.blocks; ++block, from += 4, vectors += 4 * kLanes) {
        VF a = load_quads(f, from, 4 * steps.step);
        VF b = load_quads(f, from + steps.step, 4 * steps.step);
        VF c = load_quads(f, from + 2 * steps.step, 4 * steps.step);
        VF d = load_quads(f, from + 3 * steps.step, 4 * steps.step);
        transpose(a, b, c, d);
        hn::Store(a, f, vectors);
        hn::Store(b, f, vectors + kLanes);
        hn::Store(c, f, vectors + 2 * kLanes);
        hn::Store(d, f, vectors + 3 * kLanes);
    }
}

// Back to rows. vector(t) gives vector t. The rows' pads receive what the vectors' unused lanes hold. With
// `spare`, the spare vectors on either side too.
template<class Vector>
HWY_INLINE void unskew_rows(const Shape& shape, Skew skew, const Vector& vector, float* HWY_RESTRICT rows,
                            bool spare = false) {
    static_assert(kSlices == 4);
    const RowSteps steps(shape, skew);
    const std::ptrdiff_t first = spare ? -4 : 0, end = static_cast<std::ptrdiff_t>(4 * shape.blocks) - first;
    float* to = rows + steps.first + first;
    for (std::ptrdiff_t t = first; t < end; t += 4, to += 4) {
        VF a = vector(t), b = vector(t + 1), c = vector(t + 2), d = vector(t + 3);
        transpose(a, b, c, d);
        store_quads(F(), a, to, 4 * steps.step);
        store_quads(F(), b, to + steps.step, 4 * steps.step);
        store_quads(F(), c, to + 2 * steps.step, 4 * steps.step);
        store_quads(F(), d, to + 3 * steps.step, 4 * steps.step);
    }
}

#endif

}  // namespace dfield::runtime::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
