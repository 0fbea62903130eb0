#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "screen/filter.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "screen/filter.hpp"
#include "screen/vector-inl.hpp"
#include "simd.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::screen::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET != HWY_SCALAR

template<bool kLight>
HWY_INLINE void filter_vector(const FilterJob& job, std::ptrdiff_t at, float* HWY_RESTRICT out) {
    const F f;
    const Layout& layout = job.frame->layout;
    const auto plane = static_cast<std::ptrdiff_t>(layout.size());
    const std::int32_t reach = job.reach();
    const V depth = hn::LoadU(f, job.frame->depth + at), zero = hn::Zero(f), one = hn::Set(f, 1.0f);
    const V limit = hn::Set(f, job.limit);
    V total = one, visibility = hn::LoadU(f, job.visibility + at);
    V red = zero, green = zero, blue = zero, weights = zero;
    if constexpr (kLight) {
        red = hn::LoadU(f, job.light + at);
        green = hn::LoadU(f, job.light + plane + at);
        blue = hn::LoadU(f, job.light + 2 * plane + at);
        weights = hn::LoadU(f, job.light + 3 * plane + at);
    }
    if (reach > 0) {
        const V slope_x = hn::LoadU(f, job.slopes + at), slope_y = hn::LoadU(f, job.slopes + plane + at);
        for (std::int32_t y = -reach; y <= reach; ++y) {
            const V down = hn::Mul(hn::Set(f, static_cast<float>(y)), slope_y);
            for (std::int32_t x = -reach; x <= reach; ++x) {
                if (x == 0 && y == 0) continue;
                const std::ptrdiff_t there = at + y * layout.stride + x;
                const V tangent =
                    hn::Add(depth, hn::Add(hn::Mul(hn::Set(f, static_cast<float>(x)), slope_x), down));
                const M near =
                    hn::Le(hn::Abs(hn::Sub(hn::LoadU(f, job.frame->depth + there), tangent)), limit);
                const V weight = hn::IfThenElseZero(near, hn::Set(f, job.weight(x) * job.weight(y)));
                // Far pixels may hold anything.
                const auto add = [&](V& sum, const float* from) HWY_ATTR {
                    sum = hn::MulAdd(weight, hn::IfThenElseZero(near, hn::LoadU(f, from + there)), sum);
                };
                total = hn::Add(total, weight);
                add(visibility, job.visibility);
                if constexpr (kLight) {
                    add(red, job.light);
                    add(green, job.light + plane);
                    add(blue, job.light + 2 * plane);
                    add(weights, job.light + 3 * plane);
                }
            }
        }
    }
    visibility = hn::Div(visibility, total);
    hn::StoreU(visibility, f, out);
    if constexpr (kLight) {
        const V share = hn::IfThenElseZero(hn::Gt(weights, zero),
                                           hn::Div(hn::Max(zero, hn::Sub(one, visibility)), weights));
        hn::StoreU(hn::Mul(red, share), f, out + kFilterColumns);
        hn::StoreU(hn::Mul(green, share), f, out + 2 * kFilterColumns);
        hn::StoreU(hn::Mul(blue, share), f, out + 3 * kFilterColumns);
    }
}

void filter(const FilterJob& job, std::int32_t row, std::int32_t first, float (*out)[kFilterColumns]) {
    const Layout& layout = job.frame->layout;
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(F()));
    const std::int32_t count = std::min(kFilterColumns, layout.width - first);
    // A last vector reaches into the border: no matter what it finds there, nobody reads it.
    for (std::int32_t i = 0; i < count; i += lanes) {
        const std::ptrdiff_t at = layout.index(first + i, row);
        (job.indirect ? filter_vector<true> : filter_vector<false>)(job, at, out[0] + i);
    }
}

void zip(const float* x, const float* y, const float* z, std::int32_t count, float* out) {
    const F f;
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(f));
    std::int32_t i = 0;
    for (; i + lanes <= count; i += lanes)
        hn::StoreInterleaved3(hn::LoadU(f, x + i), hn::LoadU(f, y + i), hn::LoadU(f, z + i), f, out + 3 * i);
    zip_reference(x + i, y + i, z + i, count - i, out + 3 * i);
}

#else
void filter(const FilterJob& job, std::int32_t row, std::int32_t first, float (*out)[kFilterColumns]) {
    filter_reference(job, row, first, out);
}
void zip(const float* x, const float* y, const float* z, std::int32_t count, float* out) {
    zip_reference(x, y, z, count, out);
}
#endif

}  // namespace dfield::runtime::screen::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime::screen {

HWY_EXPORT(filter);
HWY_EXPORT(zip);

FilterFunction* filter_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(filter), targets, &filter_reference);
}
ZipFunction* zip_function(std::int64_t targets) {
    return pick(HWY_DISPATCH_TABLE(zip), targets, &zip_reference);
}

}  // namespace dfield::runtime::screen
#endif
