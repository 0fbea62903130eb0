// The sums over a receiver's rays, sixteen (or as many as a register holds) at a time, and the plain form.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gather_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "gather.hpp"
#include "simd.hpp"

HWY_BEFORE_NAMESPACE();
namespace dfield::runtime::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using U = hn::ScalableTag<std::uint32_t>;
using VF = hn::Vec<F>;

// Calls use(first ray, weights c, those of open rays) for each vector of rays.
template<bool kCosine, class Use>
HWY_INLINE void for_rays(const GatherRays& rays, const glm::vec3& normal, const std::uint32_t* mask,
                         const Use& use) {
    const F f;
    const U u;
    const std::size_t lanes = hn::Lanes(f);
    const auto zero = hn::Zero(f);
    const auto nx = hn::Set(f, normal.x), ny = hn::Set(f, normal.y), nz = hn::Set(f, normal.z);
    const auto lane_bits = hn::Shl(hn::Set(u, 1), hn::Iota(u, 0));
    for (std::size_t word = 0; word < rays.words; ++word)
        for (std::size_t first = 0; first < 32; first += lanes) {
            const std::size_t at = 32 * word + first;
            auto c = hn::LoadU(f, rays.weight + at);
            if constexpr (kCosine) {
                const auto x = hn::LoadU(f, rays.x + at), y = hn::LoadU(f, rays.y + at),
                           z = hn::LoadU(f, rays.z + at);
                c = hn::Mul(c, hn::Max(zero, hn::MulAdd(nx, x, hn::MulAdd(ny, y, hn::Mul(nz, z)))));
            }
            const auto blocked = hn::TestBit(hn::Set(u, mask[word] >> first), lane_bits);
            use(at, c, hn::IfThenZeroElse(hn::RebindMask(f, blocked), c));
        }
}

template<bool kCosine>
HWY_INLINE void weigh_rays(const GatherRays& rays, const glm::vec3& normal, const std::uint32_t* mask,
                           GatherWeights& sums) {
    const F f;
    auto open = hn::Zero(f), all = hn::Zero(f);
    for_rays<kCosine>(rays, normal, mask, [&](std::size_t, VF c, VF c_open) HWY_ATTR {
        open = hn::Add(open, c_open);
        all = hn::Add(all, c);
    });
    sums = {hn::GetLane(hn::SumOfLanes(f, open)), hn::GetLane(hn::SumOfLanes(f, all))};
}

void weigh(const GatherRays& rays, const glm::vec3& normal, const std::uint32_t* mask, GatherWeights& sums) {
    return rays.cosine ? weigh_rays<true>(rays, normal, mask, sums)
                       : weigh_rays<false>(rays, normal, mask, sums);
}

template<bool kCosine>
HWY_INLINE void sum_moments(const GatherRays& rays, const glm::vec3& normal, const std::uint32_t* mask,
                            GatherMoments& sums) {
    const F f;
    auto s0 = hn::Zero(f), sx = s0, sy = s0, sz = s0, sxy = s0, syz = s0, szz = s0, sxz = s0, sxx_yy = s0;
    for_rays<kCosine>(rays, normal, mask, [&](std::size_t at, VF, VF c) HWY_ATTR {
        const auto x = hn::LoadU(f, rays.x + at), y = hn::LoadU(f, rays.y + at),
                   z = hn::LoadU(f, rays.z + at);
        const auto cx = hn::Mul(c, x), cy = hn::Mul(c, y), cz = hn::Mul(c, z);
        s0 = hn::Add(s0, c);
        sx = hn::Add(sx, cx);
        sy = hn::Add(sy, cy);
        sz = hn::Add(sz, cz);
        sxy = hn::MulAdd(cx, y, sxy);
        syz = hn::MulAdd(cy, z, syz);
        szz = hn::MulAdd(cz, z, szz);
        sxz = hn::MulAdd(cx, z, sxz);
        sxx_yy = hn::NegMulAdd(cy, y, hn::MulAdd(cx, x, sxx_yy));
    });
    const auto sum = [&](VF v) HWY_ATTR { return hn::GetLane(hn::SumOfLanes(f, v)); };
    sums = {sum(s0), sum(sx), sum(sy), sum(sz), sum(sxy), sum(syz), sum(szz), sum(sxz), sum(sxx_yy)};
}

void moments(const GatherRays& rays, const glm::vec3& normal, const std::uint32_t* mask,
             GatherMoments& sums) {
    return rays.cosine ? sum_moments<true>(rays, normal, mask, sums)
                       : sum_moments<false>(rays, normal, mask, sums);
}

}  // namespace dfield::runtime::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::runtime {
namespace {

HWY_EXPORT(weigh);
HWY_EXPORT(moments);

template<class Use>
void for_rays_reference(const GatherRays& rays, const glm::vec3& normal, const std::uint32_t* mask,
                        const Use& use) {
    for (std::size_t r = 0; r < 32 * rays.words; ++r) {
        const glm::vec3 w(rays.x[r], rays.y[r], rays.z[r]);
        const float c = rays.weight[r] * (rays.cosine ? std::max(0.0f, glm::dot(normal, w)) : 1.0f);
        use(w, c, (mask[r >> 5] >> (r & 31) & 1) == 0);
    }
}

void weigh_reference(const GatherRays& rays, const glm::vec3& normal, const std::uint32_t* mask,
                     GatherWeights& sums) {
    double open = 0, all = 0;
    for_rays_reference(rays, normal, mask, [&](const glm::vec3&, double c, bool is_open) {
        all += c;
        if (is_open) open += c;
    });
    sums = {static_cast<float>(open), static_cast<float>(all)};
}

void moments_reference(const GatherRays& rays, const glm::vec3& normal, const std::uint32_t* mask,
                       GatherMoments& sums) {
    sums = {};
    for_rays_reference(rays, normal, mask, [&](const glm::vec3& w, float c, bool is_open) {
        if (!is_open) return;
        sums.one += c;
        sums.x += c * w.x;
        sums.y += c * w.y;
        sums.z += c * w.z;
        sums.xy += c * w.x * w.y;
        sums.yz += c * w.y * w.z;
        sums.zz += c * w.z * w.z;
        sums.xz += c * w.x * w.z;
        sums.xx_yy += c * (w.x * w.x - w.y * w.y);
    });
}

}  // namespace

const GatherKernels kGatherReference{&weigh_reference, &moments_reference};

GatherKernels gather_kernels(std::int64_t targets) {
    return {pick(HWY_DISPATCH_TABLE(weigh), targets, kGatherReference.weigh),
            pick(HWY_DISPATCH_TABLE(moments), targets, kGatherReference.moments)};
}

}  // namespace dfield::runtime
#endif
