// One trilinear read a receiver, a vector of receivers at a time.
#include "bench/kinds/occlusion_grid.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/kinds/occlusion_grid_read.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace dfield::kinds::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using VI = hn::Vec<hn::RebindToSigned<D>>;

// What a node holds, or a mean of nodes.
struct Cap {
    V x, y, z, size;
};

template<int kShift>
HWY_INLINE V byte_of(VI word) {
    const hn::RebindToSigned<D> di;
    return hn::ConvertTo(D(), hn::And(hn::ShiftRight<kShift>(word), hn::Set(di, 0xff)));
}

HWY_INLINE void add(VI word, V weight, Cap& sum) {
    sum.x = hn::MulAdd(weight, byte_of<0>(word), sum.x);
    sum.y = hn::MulAdd(weight, byte_of<8>(word), sum.y);
    sum.z = hn::MulAdd(weight, byte_of<16>(word), sum.z);
    sum.size = hn::MulAdd(weight, byte_of<24>(word), sum.size);
}

// A coordinate within the grid, as the node below it and what is left.
struct Place {
    VI node;
    V rest;
};
HWY_INLINE Place place(V coordinate) {
    const hn::RebindToSigned<D> di;
    const VI node = hn::ConvertTo(di, coordinate);
    return {node, hn::Sub(coordinate, hn::ConvertTo(D(), node))};
}

HWY_INLINE Cap read(const OcclusionGrid::View& grid, V x, V y, V z) {
    const D d;
    const hn::RebindToSigned<D> di;
    const Place px = place(x), py = place(y), pz = place(z);
    const V one = hn::Set(d, 1), zero = hn::Zero(d);
    const VI row = hn::Set(di, grid.size);
    const VI first = hn::Add(px.node, hn::Mul(row, hn::Add(py.node, hn::Mul(row, pz.node))));
    const auto* base = reinterpret_cast<const std::int32_t*>(grid.nodes);
    Cap sum{zero, zero, zero, zero};
    for (int corner = 0; corner < 8; ++corner) {
        const std::int32_t step = (corner & 1) + grid.size * ((corner >> 1 & 1) + grid.size * (corner >> 2));
        const V wx = corner & 1 ? px.rest : hn::Sub(one, px.rest);
        const V wy = corner & 2 ? py.rest : hn::Sub(one, py.rest);
        const V wz = corner & 4 ? pz.rest : hn::Sub(one, pz.rest);
        add(hn::GatherIndex(di, base, hn::Add(first, hn::Set(di, step))), hn::Mul(wx, hn::Mul(wy, wz)), sum);
    }
    return sum;
}

HWY_INLINE V cap_occlusion(const float* table, V cosine, V size) {
    const D d;
    const hn::RebindToSigned<D> di;
    const auto clamped = [&](V v, std::int32_t entries) HWY_ATTR {
        const V highest = hn::Set(d, static_cast<float>(entries) - 1.001f);
        return place(hn::Min(hn::Max(v, hn::Zero(d)), highest));
    };
    const V half = hn::Set(d, 0.5f * (OcclusionGrid::kCapCosines - 1));
    const Place c = clamped(hn::MulAdd(cosine, half, half), OcclusionGrid::kCapCosines);
    const Place s =
        clamped(hn::Mul(size, hn::Set(d, OcclusionGrid::kCapSizes - 1.0f)), OcclusionGrid::kCapSizes);
    const VI first = hn::Add(s.node, hn::Mul(c.node, hn::Set(di, OcclusionGrid::kCapSizes)));
    const auto along_size = [&](std::int32_t step) HWY_ATTR {
        const V a = hn::GatherIndex(d, table, hn::Add(first, hn::Set(di, step)));
        const V b = hn::GatherIndex(d, table, hn::Add(first, hn::Set(di, step + 1)));
        return hn::MulAdd(s.rest, hn::Sub(b, a), a);
    };
    const V a = along_size(0), b = along_size(OcclusionGrid::kCapSizes);
    return hn::MulAdd(c.rest, hn::Sub(b, a), a);
}

HWY_INLINE V length_squared(V x, V y, V z) {
    return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
}

// Positions and normals have a vector's worth of readable elements behind their ends, and so has `result`.
void visibility(const OcclusionGrid::View& grid, const float* positions, const float* normals,
                std::size_t count, float* result) {
    const D d;
    const V highest = hn::Set(d, static_cast<float>(grid.size) - 1.001f), zero = hn::Zero(d);
    const V bias = hn::Set(d, -128), one = hn::Set(d, 1);
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        V p[3], n[3], inside[3], from_middle[3], from_middle_inside[3];
        hn::LoadInterleaved3(d, positions + 3 * i, p[0], p[1], p[2]);
        hn::LoadInterleaved3(d, normals + 3 * i, n[0], n[1], n[2]);
        for (int axis = 0; axis < 3; ++axis) {
            const V origin = hn::Set(d, grid.origin[axis]), to_nodes = hn::Set(d, grid.to_nodes[axis]);
            const V middle = hn::Set(d, (grid.middle[axis] - grid.origin[axis]) * grid.to_nodes[axis]);
            const V node = hn::Mul(hn::Sub(p[axis], origin), to_nodes);
            inside[axis] = hn::Min(hn::Max(node, zero), highest);
            const V to_world = hn::Set(d, 1 / grid.to_nodes[axis]);
            from_middle[axis] = hn::Mul(hn::Sub(node, middle), to_world);
            from_middle_inside[axis] = hn::Mul(hn::Sub(inside[axis], middle), to_world);
        }
        const Cap cap = read(grid, inside[0], inside[1], inside[2]);
        const V x = hn::Add(cap.x, bias), y = hn::Add(cap.y, bias), z = hn::Add(cap.z, bias);
        const V length = hn::Sqrt(hn::Max(length_squared(x, y, z), hn::Set(d, 1e-6f)));
        const V cosine = hn::Div(hn::MulAdd(x, n[0], hn::MulAdd(y, n[1], hn::Mul(z, n[2]))), length);
        const V nearer = hn::Sqrt(hn::Div(
            length_squared(from_middle_inside[0], from_middle_inside[1], from_middle_inside[2]),
            hn::Max(length_squared(from_middle[0], from_middle[1], from_middle[2]), hn::Set(d, 1e-20f))));
        const V size = hn::Mul(hn::Mul(cap.size, hn::Set(d, 1.0f / 255)), hn::Min(nearer, one));
        hn::StoreU(hn::Sub(one, cap_occlusion(grid.table, cosine, size)), d, result + i);
    }
}

}  // namespace dfield::kinds::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dfield::kinds {

HWY_EXPORT(visibility);

std::vector<float> OcclusionGrid::visibility(const paper::Receivers& receivers) const {
    constexpr std::size_t kWidest = 64;  // lanes of any target
    std::vector<glm::vec3> positions = receivers.positions, normals = receivers.normals;
    positions.resize(positions.size() + kWidest);
    normals.resize(normals.size() + kWidest);
    std::vector<float> result(receivers.size() + kWidest);
    HWY_DYNAMIC_DISPATCH(visibility)
    (view(), &positions.front().x, &normals.front().x, receivers.size(), result.data());
    result.resize(receivers.size());
    return result;
}

}  // namespace dfield::kinds
#endif
